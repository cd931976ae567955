"""Every command on every page is one that there is, with options that it has; and every block of commands is run."""

import json
import os
import re
import shlex
import subprocess
import sys

import pytest
import typer

from bench.cli import COMMANDS, app
from tests.docs.pages import PAGES, ROOT, bench_commands, commands, spoken
from tests.docs.test_run import ELSEWHERE, HERE

#: Words in a page's text that stand for what a reader puts in.
STANDS_FOR = re.compile(r"[A-Z_]{2,}(\.\w+)?|\.\.\.|…")


#: What `python -m MODULE --help` says of each module, in one process, as they share what they import.
HELP = """
import contextlib, io, json, runpy, sys
helps = {}
for module in sys.argv[1:]:
    sys.argv = [module, "--help"]
    with contextlib.redirect_stdout(io.StringIO()) as printed, contextlib.suppress(SystemExit):
        runpy.run_module(module, run_name="__main__", alter_sys=True)
    helps[module] = printed.getvalue()
print(json.dumps(helps))
"""
MEASURING = re.compile(r"python -m (tests\.[\w.]*\w)")


@pytest.fixture(scope="module")
def helps():
    """Help of every measuring command that a page names."""
    modules = sorted({module for page in PAGES.values() for module in MEASURING.findall(page)})
    environment = {**os.environ, "COLUMNS": "200"}
    line = [sys.executable, "-c", HELP, *modules]
    done = subprocess.run(line, cwd=ROOT, env=environment, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def unknown(command, known):
    """Options in a command that are not in a text or among names."""
    return [f"{command}: {one}" for one in re.findall(r"(?<=\s)--[a-z][a-z-]*", command) if one not in known]


def test_commands_of_the_bench_are_there_with_their_options():
    known_commands = typer.main.get_command(app).commands
    wrong = []
    for page in PAGES.values():
        for line in bench_commands(page):
            words = shlex.split(line)
            assert words[1] in known_commands, line
            known_commands[words[1]].make_context(words[1], words[2:]).close()  # an error of usage is raised here
        for line in spoken(page):
            words = line.split()
            if words[0] != "bench" or len(words) == 1 or words[1].startswith("-") or STANDS_FOR.fullmatch(words[1]):
                continue
            assert words[1] in known_commands, line
            wrong += unknown(
                line, {option for one in known_commands[words[1]].params for option in one.opts} | {"--help"}
            )
    assert wrong == []


def test_measuring_commands_are_there_with_their_options(helps):
    lines = [line for page in PAGES.values() for line in [*commands(page), *spoken(page)]]
    named = [(line, module) for line in lines for module in MEASURING.findall(line)]
    assert [option for line, module in named for option in unknown(line, helps[module])] == []
    line, module = named[0]
    assert unknown(f"{line} --unheard-of", helps[module]) == [f"{line} --unheard-of: --unheard-of"]


def test_tests_that_pages_tell_to_run_are_there():
    lines = [line for page in PAGES.values() for line in [*commands(page), *spoken(page)]]
    for line in lines:
        if "pytest" not in line.split("tests")[0]:
            continue
        paths = re.findall(r"(?<=\s)tests/[\w/]+(?:\.py)?", line)
        for path in paths:
            assert (ROOT / path).exists(), line
        for chosen in re.findall(r"-k (\w+)", line):
            text = "".join((ROOT / path).read_text(encoding="utf-8") for path in paths)
            assert re.search(rf"def test_\w*{chosen}", text), f"{line}: no such test"


def test_every_block_of_commands_is_run():
    """In `HERE`, or by tests of the page's own, which have the folder and the recordings that the page supposes."""
    assert {name for name, page in PAGES.items() if bench_commands(page)} == {*HERE, *ELSEWHERE}
    for name, path in ELSEWHERE.items():
        assert f'PAGES["{name}"]' in (ROOT / "tests" / path).read_text(encoding="utf-8")


def test_the_readme_has_every_command_in_one_table():
    for name, command in COMMANDS.items():
        assert f"| `bench {name}` | {command.__doc__.strip()} |" in PAGES["README.md"]
