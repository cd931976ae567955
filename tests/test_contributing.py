"""What CONTRIBUTING.md tells is true: its examples, built outside the repository, are found and pass their tests."""

import os
import re
import subprocess
import sys
import tomllib
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

from bench.errors import InputError
from bench.trace.read import readers

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
#: Blocks of code whose first line is a comment with the name of their file.
BLOCKS = dict(re.findall(r"^```\w+\n# (\S+\.py)\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL))
TESTS = [name for name in BLOCKS if name.startswith("tests/test_")]
#: Entry points by group, of all the page's blocks for `pyproject.toml`.
TOML = "\n".join(re.findall(r"^```toml\n# pyproject\.toml.*?\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL))
GROUPS = tomllib.loads(TOML)["project"]["entry-points"]
EFFECTS, READERS, COMMANDS = (sorted(GROUPS[f"servobench.{kind}"]) for kind in ("effects", "readers", "commands"))
METADATA = "Metadata-Version: 2.1\nName: servobench-extras\nVersion: 1.0\n"


@pytest.fixture(scope="module")
def extras(tmp_path_factory):
    """The examples' package as an installer lays it out, and its tests."""
    home = tmp_path_factory.mktemp("extras")
    installed = home / "servobench_extras-1.0.dist-info"
    for folder in (installed, home / "servobench_extras", home / "tests"):
        folder.mkdir()
    (home / "servobench_extras" / "__init__.py").touch()
    for name, text in BLOCKS.items():
        (home / name).write_text(text, encoding="utf-8")
    (installed / "METADATA").write_text(METADATA, encoding="utf-8")
    lines = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in those.items()) for group, those in GROUPS.items()]
    (installed / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")
    return home


def run(home, *arguments):
    """A Python of its own that has the package beside the bench."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(home), str(ROOT)])}
    return subprocess.run(
        [sys.executable, *arguments], cwd=home, env=environment, capture_output=True, text=True, check=False
    )


def test_each_example_is_one_file_and_one_test():
    examples = sorted(Path(name).stem for name in BLOCKS if name.startswith("servobench_extras/"))
    assert (
        examples
        == sorted(Path(name).stem.removeprefix("test_") for name in TESTS)
        == sorted([*EFFECTS, *READERS, *COMMANDS])
    )
    assert (len(EFFECTS), len(READERS), len(COMMANDS)) == (3, 1, 1)


def test_the_examples_pass_their_tests(extras):
    done = run(extras, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error", "tests")
    assert f"{sum(BLOCKS[name].count('def test_') for name in TESTS)} passed" in done.stdout, done.stdout + done.stderr


def test_the_examples_are_what_they_declare(extras):
    laws = [str(ROOT / "tests" / "effects" / f"test_{name}.py") for name in ("properties", "sensing", "reporting")]
    done = run(extras, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *laws, "-k", " or ".join(EFFECTS))
    assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def test_the_examples_are_listed_beside_the_catalogue(extras):
    done = run(extras, "-m", "bench", "effects")
    for name in EFFECTS:
        assert name in done.stdout


def test_a_reader_is_among_the_formats_that_a_refusal_lists(extras):
    (extras / "what.bin").write_bytes(bytes(range(256)))
    done = run(extras, "-m", "bench", "inspect", "what.bin")
    assert done.returncode == 2
    assert "drive's memory, CSV table" in done.stderr


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("builtins:sum", r"found <built-in function sum>; allowed: a reader with format, endings, recognises and read"),
        (
            "nowhere:READER",
            r"cannot be imported \(ModuleNotFoundError: .*nowhere.*\); update that package, or remove it: pip",
        ),
    ],
)
def test_what_is_no_reader_is_refused(monkeypatch, value, said):
    monkeypatch.setattr("bench.offered.entry_points", lambda group: [EntryPoint("other", value, group)])
    with pytest.raises(InputError, match=rf"servobench.readers: {value} of \w+: {said}"):
        readers.__wrapped__()


def test_the_page_keeps_to_what_is_there():
    found = re.findall(r"`((?:bench|tests|docs)/[a-z_/]+(?:\.[a-z]+)?)`", PAGE)
    assert found
    for path in found:
        assert (ROOT / path).exists(), path


def test_a_fault_of_another_package_is_said_to_be_its(extras):
    """A reader that raises what nobody foresaw is not taken for the bench."""
    whole = (extras / "servobench_extras" / "drive_dump.py").read_text(encoding="utf-8")
    spoiled = whole.replace("return source.content.startswith(MAGIC)", "raise TypeError('nobody foresaw this')")
    (extras / "servobench_extras" / "drive_dump.py").write_text(spoiled, encoding="utf-8")
    (extras / "what.bin").write_bytes(bytes(range(256)))
    done = run(extras, "-m", "bench", "inspect", "what.bin")
    (extras / "servobench_extras" / "drive_dump.py").write_text(whole, encoding="utf-8")
    assert spoiled != whole
    assert done.returncode == 70
    assert "a fault of servobench-extras, not of your input (TypeError: nobody foresaw this" in done.stderr
