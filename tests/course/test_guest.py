"""The course is a guest: nothing of the bench imports it but its command, and that when it runs."""

import ast

from tests.sources import ROOT, SOURCES, module_of, nodes
from tests.test_architecture import imports

COMMANDS = {"bench.cli.lab"}


def of_course(module):
    return module == "bench.course" or module.startswith("bench.course.")


def test_only_its_command_imports_it():
    naming = [path for path in SOURCES if "course" in path.read_text(encoding="utf-8")]  # parsing all takes seconds
    users = {module_of(path) for path in naming if any(map(of_course, imports(nodes(path))))}
    assert {user for user in users if not of_course(user)} == COMMANDS


def test_its_command_imports_it_when_it_runs():
    for command in COMMANDS:
        module = nodes(ROOT / f"{command.replace('.', '/')}.py")[0]
        first = [node.module for node in module.body if isinstance(node, ast.ImportFrom)]
        assert first
        assert not any(of_course(module) for module in first)


def test_it_takes_no_private_names():
    for path in SOURCES:
        if of_course(module_of(path)):
            for node in nodes(path):
                if isinstance(node, ast.ImportFrom):
                    names = [*(node.module or "").split("."), *(alias.name for alias in node.names)]
                    assert not [name for name in names if name.startswith("_") and not name.startswith("__")], path
