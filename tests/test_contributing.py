"""CONTRIBUTING.md is true: the example packages, installed next to the bench, are found and pass their tests."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from bench.errors import InputError
from bench.trace.read import readers

ROOT = Path(__file__).resolve().parents[1]
PAGE = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
PACKAGES = {
    path.parent.name: path.parent for path in sorted((ROOT / "docs/examples/packages").glob("*/pyproject.toml"))
}
PROJECTS = {
    name: tomllib.loads((path / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for name, path in PACKAGES.items()
}
OFFERED = {
    name: sorted(entry for group in project["entry-points"].values() for entry in group)
    for name, project in PROJECTS.items()
}


@pytest.fixture(scope="module")
def extras(tmp_path_factory):
    """The packages as an installer lays them out, and their tests."""
    home = tmp_path_factory.mktemp("extras")
    for name, path in PACKAGES.items():
        project = PROJECTS[name]
        shutil.copytree(path / f"servobench_{name}", home / f"servobench_{name}")
        shutil.copytree(path / "tests", home / "tests" / name)
        installed = home / f"servobench_{name}-{project['version']}.dist-info"
        installed.mkdir()
        metadata = f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
        (installed / "METADATA").write_text(metadata, encoding="utf-8")
        groups = project["entry-points"].items()
        lines = [f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in those.items()) for group, those in groups]
        (installed / "entry_points.txt").write_text("\n".join(lines), encoding="utf-8")
    return home


def run(home, *arguments):
    """A Python of its own that has the packages in addition to the bench."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(home), str(ROOT)])}
    return subprocess.run(
        [sys.executable, *arguments], cwd=home, env=environment, capture_output=True, text=True, check=False
    )


def test_each_example_is_one_file_and_one_test_and_the_page_links_it():
    assert {name: len(those) for name, those in OFFERED.items()} == {"command": 1, "effects": 3, "reader": 1}
    for name, path in PACKAGES.items():
        written = sorted(file.stem for file in (path / f"servobench_{name}").glob("*.py") if file.stem != "__init__")
        tested = sorted(file.stem.removeprefix("test_") for file in (path / "tests").glob("test_*.py"))
        assert written == tested == OFFERED[name]
        assert f"](docs/examples/packages/{name}" in PAGE


def test_the_examples_pass_their_tests(extras):
    done = run(extras, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error", "tests")
    count = sum(file.read_text(encoding="utf-8").count("def test_") for file in extras.glob("tests/*/test_*.py"))
    assert f"{count} passed" in done.stdout, done.stdout + done.stderr


def test_the_examples_are_what_they_declare(extras):
    laws = [str(ROOT / "tests" / "effects" / f"test_{name}.py") for name in ("properties", "sensing", "reporting")]
    chosen = " or ".join(OFFERED["effects"])
    done = run(extras, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *laws, "-k", chosen)
    assert done.returncode == 0, done.stdout + done.stderr
    assert " passed" in done.stdout


def test_the_examples_are_listed_with_the_catalogue_and_among_the_formats_that_a_refusal_lists(extras):
    done = run(extras, "-m", "bench", "effects")
    assert not [name for name in OFFERED["effects"] if name not in done.stdout]
    (extras / "what.bin").write_bytes(bytes(range(256)))
    done = run(extras, "-m", "bench", "inspect", "what.bin")
    assert (done.returncode, "drive's memory, CSV table" in done.stderr) == (2, True)


IMPORTED = r"cannot be imported \(ModuleNotFoundError: .*nowhere.*\); update that package, or remove it: pip"
READER = r"found <built-in function sum>; allowed: a reader with format, endings, recognises and read"


@pytest.mark.parametrize(("value", "said"), [("builtins:sum", READER), ("nowhere:READER", IMPORTED)])
def test_what_is_no_reader_is_refused(tmp_path, monkeypatch, value, said):
    installed = tmp_path / "other-1.0.dist-info"
    installed.mkdir()
    (installed / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (installed / "entry_points.txt").write_text(f"[servobench.readers]\nother = {value}\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(InputError, match=rf"servobench.readers: {value} of other: {said}"):
        readers.__wrapped__()


def test_the_page_refers_to_what_exists():
    found = re.findall(r"`((?:bench|tests|docs)/[a-z_/]+(?:\.[a-z]+)?)`", PAGE)
    assert found and not [path for path in found if not (ROOT / path).exists()]


def test_a_fault_of_another_package_is_attributed_to_it(extras):
    """A reader that raises an unexpected exception is not taken for the bench."""
    path = extras / "servobench_reader" / "drive_dump.py"
    whole = path.read_text(encoding="utf-8")
    spoiled = whole.replace("return source.content.startswith(MAGIC)", "raise TypeError('nobody foresaw this')")
    path.write_text(spoiled, encoding="utf-8")
    (extras / "what.bin").write_bytes(bytes(range(256)))
    done = run(extras, "-m", "bench", "inspect", "what.bin")
    path.write_text(whole, encoding="utf-8")
    assert spoiled != whole
    assert done.returncode == 70
    assert "a fault of servobench-reader, not of your input (TypeError: nobody foresaw this" in done.stderr
