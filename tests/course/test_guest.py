"""The course is a guest: nothing of the bench imports it but its command, and that when it runs."""

import ast

from tests.sources import ROOT, SOURCES, module_of, nodes
from tests.test_architecture import imports


def of_course(module):
    return module == "bench.course" or module.startswith("bench.course.")


def test_only_its_command_imports_it_when_it_runs():
    naming = [path for path in SOURCES if "course" in path.read_text(encoding="utf-8")]  # parsing all takes seconds
    users = {module_of(path) for path in naming if any(map(of_course, imports(nodes(path))))}
    assert {user for user in users if not of_course(user)} == {"bench.cli.lab"}
    first = [node for node in nodes(ROOT / "bench/cli/lab.py")[0].body if isinstance(node, ast.ImportFrom)]
    assert first and not [node for node in first if of_course(node.module)]


def test_it_takes_no_private_names():
    own = [node for path in SOURCES if of_course(module_of(path)) for node in nodes(path)]
    taken = [node for node in own if isinstance(node, ast.ImportFrom)]
    names = [part for one in taken for part in (*(one.module or "").split("."), *(alias.name for alias in one.names))]
    assert taken and not [name for name in names if name.startswith("_") and not name.startswith("__")]
