"""Every command, option and TOML line that a message advises, carried out: it succeeds, or meets another message.

Messages put what a user can type between backticks: a command (`bench inspect log.csv`; a verb alone, `bench
diagnose`, takes the arguments of the command that failed), an option for the same command (`--axis X`), or a line of
the rig with its table (`[trace] sample_period = "1 ms"`).
"""

from __future__ import annotations

import ast
import re
import shlex
import shutil
import tomllib
from dataclasses import dataclass
from difflib import get_close_matches
from html import unescape
from pathlib import Path

import pytest
import tomli_w

from bench.rig.rig import rig_file
from tests.command import bench
from tests.faults.advised import CASES, FILES, MADE
from tests.sources import ROOT, SOURCES, nodes

ADVICE = re.compile(r"`((?:bench |--|\[)[^`]*)`")
ANSWERS = re.compile(r'<dl class="answers".*?</dl>', re.DOTALL)
MEANT = re.compile(r"did you mean '([^']*)'\?")
TABLE = re.compile(r"\[([\w.]+)\]\s*(.*)", re.DOTALL)


@dataclass(frozen=True)
class Said:
    """What a command printed, and the answers of pages that it wrote: its status and its text, white space folded."""

    status: int
    text: str


def run(command: str) -> Said:
    before = {*Path().rglob("*.html")}
    done = bench(*shlex.split(command)[1:])
    pages = sorted({*Path().rglob("*.html")} - before)
    return Said(done.status, " ".join((done.err + done.out + "".join(map(answers, pages))).split()))


def answers(page: Path) -> str:
    """Of a page, as text, with the backticks of what it shows as code."""
    found = "".join(ANSWERS.findall(page.read_text(encoding="utf-8")))
    return unescape(re.sub(r"<[^>]*>", " ", re.sub(r"</?code>", "`", found)))


def with_option(command: str, option: str) -> str:
    """The command with an option, in place of what it has of that name."""
    name, *value = shlex.split(option)
    words = shlex.split(command)
    if name in words:
        place = words.index(name)
        words[place : place + 1 + len(value)] = []
    return shlex.join([*words, name, *value])


def with_line(command: str, line: str) -> str:
    """The command with a copy of its rig that has a line; without a rig, with one that has nothing else."""
    table, rest = TABLE.fullmatch(line).groups()
    added = tomllib.loads(f"[{table}]\n{rest}")
    words = shlex.split(command)
    place = words.index("--rig") + 1 if "--rig" in words else 2 if words[1] == "simulate" else None
    rig = tomllib.loads(rig_file(words[place]).read_text()) if place else {"name": "axis", "kind": "rotary"}
    Path("advised.toml").write_text(tomli_w.dumps(merge(rig, added)))
    if place is None:
        return f"{command} --rig advised.toml"
    return shlex.join([*words[:place], "advised.toml", *words[place + 1 :]])


def merge(into: dict, more: dict) -> dict:
    for key, value in more.items():
        into[key] = merge(into.get(key, {}), value) if isinstance(value, dict) else value
    return into


def follow(command: str, said: Said) -> list[tuple[str, Said]]:
    """Carry out all that a message advises: each with what it led to."""
    done = []
    for advice in dict.fromkeys(ADVICE.findall(said.text)):
        if re.fullmatch(r"bench \w+", advice):
            next_command = " ".join(["bench", advice.removeprefix("bench "), *command.split()[2:]])
        elif advice.startswith("bench "):
            next_command = advice
        elif advice.startswith("--"):
            next_command = with_option(command, advice)
        else:
            next_command = with_line(command, advice)
        done.append((next_command, run(next_command)))
    for meant in MEANT.findall(said.text):
        (mistyped,) = get_close_matches(meant, re.split(r"[ :=]", command), 1)
        next_command = command.replace(mistyped, meant)
        done.append((next_command, run(next_command)))
    return done


PRINTED: dict[str, str] = {}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """A folder with the files that commands need, those of the bench itself made by its own commands."""
    folder = tmp_path_factory.mktemp("files")
    for name, text in FILES.items():
        (folder / name).write_text(text, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for command in MADE:
            assert run(command).status == 0, run(command).text
    model = tomllib.loads((folder / "found" / "model.toml").read_text())
    joints = {"schema": "bench.effects/1", "joints": dict.fromkeys(("shoulder", "elbow"), model)}
    (folder / "joints.toml").write_text(tomli_w.dumps(joints))
    return folder


@pytest.mark.parametrize("command", CASES)
def test_what_a_message_advises_gets_further(command, files, tmp_path, monkeypatch, request):
    monkeypatch.chdir(tmp_path)
    if "--deadline" in command:  # which ends a process
        request.getfixturevalue("worker_processes")
    shutil.copytree(files, tmp_path, dirs_exist_ok=True)
    said = run(command)
    PRINTED[command] = said.text
    followed = follow(command, said)
    assert followed, f"{command} gives no advice: {said.text}"
    for next_command, led_to in followed:
        assert led_to.status != 70, f"{next_command}: {led_to.text}"
        assert led_to.status == 0 or led_to.text != said.text, f"{next_command} meets the same message: {said.text}"


def advising() -> dict[str, str]:
    """Strings of the bench with something to type between backticks: place, and text with {} for what varies."""
    found = {}
    for path in SOURCES:
        skipped = {id(part) for node in nodes(path) if not_printed(node) for part in ast.walk(node)}
        for node in nodes(path):
            if id(node) in skipped or not isinstance(node, ast.JoinedStr | ast.Constant):
                continue
            text = template(node)
            if ADVICE.search(text.replace("{}", "x")):
                found.setdefault(f"{path.relative_to(ROOT)}:{node.lineno}", text)
            skipped.update(id(part) for part in ast.walk(node))
    return found


def not_printed(node: ast.AST) -> bool:
    """Docstrings, and the help of options."""
    bare = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return bare or (isinstance(node, ast.keyword) and node.arg == "help")


def template(node: ast.JoinedStr | ast.Constant) -> str:
    if isinstance(node, ast.JoinedStr):
        return "".join(str(part.value) if isinstance(part, ast.Constant) else "{}" for part in node.values)
    return node.value if isinstance(node.value, str) else ""


def test_every_message_that_advises_is_among_them():
    """The tests above print each of them: a new message with advice needs a case that leads to it."""
    if len(PRINTED) < len(CASES):
        pytest.skip("needs the tests above, in this process")
    printed = "\n".join(PRINTED.values())
    unmet = {place: text for place, text in advising().items() if not re.search(pattern(text), printed, re.DOTALL)}
    assert not unmet, "\n".join(f"{place}: {text}" for place, text in unmet.items())


def pattern(text: str) -> str:
    return ".*?".join(re.escape(" ".join(part.split())) for part in text.split("{}"))
