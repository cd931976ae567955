"""What docstrings say that functions take, classes have and functions raise is what they do."""

import ast
import inspect
import pkgutil
import re
from importlib import import_module
from pathlib import Path

import pytest

import bench.effects

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted((ROOT / "bench").rglob("*.py"))
#: Head of a section, and an entry of one: names before a colon, four blanks deeper than the section's head.
ENTRY = re.compile(r"^ {4}((?:\*{0,2}\w+)(?:, \*{0,2}\w+)*)(?: \([^)]*\))?:(?: |$)")


def section(docstring: str, head: str) -> list[str]:
    """Names that a section of a docstring lists."""
    lines = docstring.splitlines()
    if f"{head}:" not in lines:
        return []
    names = []
    for line in lines[lines.index(f"{head}:") + 1 :]:
        if line and not line.startswith(" "):
            break
        if found := ENTRY.match(line):
            names += [name.strip("* ") for name in found[1].split(",")]
    return names


def taken(function: ast.FunctionDef) -> set[str]:
    """Names of a function's arguments."""
    given = function.args
    every = [*given.posonlyargs, *given.args, *given.kwonlyargs, given.vararg, given.kwarg]
    return {one.arg for one in every if one is not None}


def had(kind: ast.ClassDef) -> set[str]:
    """Names of a class' attributes, as its own body has them."""
    fields = {
        node.target.id for node in kind.body if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name)
    }
    fields |= {
        one.id
        for node in kind.body
        if isinstance(node, ast.Assign)
        for one in node.targets
        if isinstance(one, ast.Name)
    }
    fields |= {node.name for node in kind.body if isinstance(node, ast.FunctionDef)}
    for node in ast.walk(kind):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store) and ast.unparse(node.value) == "self":
            fields.add(node.attr)
    return fields


def wrong(path: Path) -> list[str]:
    """Names in docstrings that are not there."""
    found = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            text = ast.get_docstring(node) or ""
            if isinstance(node, ast.FunctionDef):
                there = taken(node)
            else:
                made = [one for one in node.body if isinstance(one, ast.FunctionDef) and one.name == "__init__"]
                there = had(node) | {name for one in made for name in taken(one)}
            inherits = isinstance(node, ast.ClassDef) and bool(node.bases)
            listed = section(text, "Args") + ([] if inherits else section(text, "Attributes"))
            found += [f"{node.lineno}: {node.name} has no {name}" for name in listed if name not in there]
    return found


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_a_docstring_names_only_what_is_there(path):
    assert wrong(path) == []


def test_a_docstring_that_names_what_is_not_there_is_seen(tmp_path):
    path = tmp_path / "module.py"
    path.write_text('def f(a, b):\n    """F.\n\n    Args:\n        a, c: of it.\n        b: its.\n    """\n')
    assert wrong(path) == ["1: f has no c"]


@pytest.mark.parametrize("module", [one.name for one in pkgutil.iter_modules(bench.effects.__path__)])
def test_a_hook_of_an_effect_is_told_where_it_is_declared(module):
    kinds = inspect.getmembers(import_module(f"bench.effects.{module}"), inspect.isclass)
    own = [kind for _, kind in kinds if kind.__module__.endswith(module) and not getattr(kind, "_is_protocol", False)]
    hooks = [
        (kind, name)
        for kind in own
        for name, value in vars(kind).items()
        if not name.startswith("_") and isinstance(value, property | classmethod | type(inspect.isclass))
    ]
    assert [(kind.__name__, name) for kind, name in hooks if not inspect.getdoc(getattr(kind, name))] == []
