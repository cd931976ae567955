"""What CONTRIBUTING.md tells is true: its examples, built outside the repository, are found and pass their tests."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
#: Blocks of code whose first line is a comment with the name of their file.
BLOCKS = dict(re.findall(r"^```\w+\n# (\S+\.(?:py|toml))\n(.*?)^```$", PAGE, flags=re.MULTILINE | re.DOTALL))
TESTS = [name for name in BLOCKS if name.startswith("tests/test_")]
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
    groups = tomllib.loads(BLOCKS["pyproject.toml"])["project"]["entry-points"]
    lines = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in those.items()) for group, those in groups.items()]
    (installed / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")
    return home


def run(home, *arguments):
    """A Python of its own that has the package beside the bench."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(home), str(ROOT)])}
    return subprocess.run(
        [sys.executable, *arguments], cwd=home, env=environment, capture_output=True, text=True, check=False
    )


def test_each_example_is_one_file_and_one_test():
    effects = sorted(Path(name).stem for name in BLOCKS if name.startswith("servobench_extras/"))
    assert effects == sorted(Path(name).stem.removeprefix("test_") for name in TESTS)
    assert len(effects) == 3


def test_the_examples_pass_their_tests(extras):
    done = run(extras, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error", "tests")
    assert f"{len(TESTS)} passed" in done.stdout, done.stdout + done.stderr


def test_the_examples_are_what_they_declare(extras):
    names = [Path(name).stem.removeprefix("test_") for name in TESTS]
    laws = [str(ROOT / "tests" / "effects" / f"test_{name}.py") for name in ("properties", "sensing", "reporting")]
    done = run(extras, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *laws, "-k", " or ".join(names))
    assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def test_the_examples_are_listed_beside_the_catalogue(extras):
    done = run(extras, "-m", "bench", "effects")
    for name in TESTS:
        assert Path(name).stem.removeprefix("test_") in done.stdout


def test_the_page_keeps_to_what_is_there():
    found = re.findall(r"`((?:bench|tests|docs)/[a-z_/]+(?:\.[a-z]+)?)`", PAGE)
    assert found
    for path in found:
        assert (ROOT / path).exists(), path
