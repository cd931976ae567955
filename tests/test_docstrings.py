"""What docstrings say that functions take, classes have and functions raise is what they do."""

import ast
import inspect
import pkgutil
import re
from collections.abc import Iterable
from importlib import import_module

import bench.effects
from tests.sources import SOURCES, module_of, nodes

#: Head of a section, and an entry of one: names before a colon, four blanks deeper than the section's head.
ENTRY = re.compile(r"^ {4}((?:\*{0,2}\w+)(?:, \*{0,2}\w+)*)(?: \([^)]*\))?:(?: |$)")


def section(docstring: str, head: str) -> list[str]:
    """Names that a section of a docstring lists."""
    _, found, rest = docstring.partition(f"\n{head}:\n")
    body = re.split(r"^(?=\S)", rest, maxsplit=1, flags=re.MULTILINE)[0] if found else ""
    entries = filter(None, map(ENTRY.match, body.splitlines()))
    return [name.strip("* ") for entry in entries for name in entry[1].split(",")]


def taken(function: ast.FunctionDef) -> set[str]:
    """Names of a function's arguments."""
    return {node.arg for node in ast.walk(function.args) if isinstance(node, ast.arg)}


def had(kind: ast.ClassDef) -> set[str]:
    """Names of a class' attributes, as its own body and its methods set them, and of what makes it."""
    fields = {node.name for node in kind.body if isinstance(node, ast.FunctionDef)}
    for node in kind.body:
        if isinstance(node, ast.AnnAssign | ast.Assign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            fields |= {one.id for one in targets if isinstance(one, ast.Name)}
        elif isinstance(node, ast.FunctionDef) and node.name == "__init__":
            fields |= taken(node)
    for node in ast.walk(kind):
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store) and ast.unparse(node.value) == "self":
            fields.add(node.attr)
    return fields


def wrong(every: Iterable[ast.AST]) -> list[str]:
    """Names in docstrings that are not there."""
    found = []
    for node in every:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            text, is_class = ast.get_docstring(node) or "", isinstance(node, ast.ClassDef)
            inherits = is_class and bool(node.bases)
            listed = section(text, "Args") + ([] if inherits else section(text, "Attributes"))
            there = had(node) if is_class else taken(node)
            found += [f"{node.lineno}: {node.name} has no {name}" for name in listed if name not in there]
    return found


def test_a_docstring_names_only_what_is_there():
    assert {module_of(path): found for path in SOURCES if (found := wrong(nodes(path)))} == {}


def test_a_docstring_that_names_what_is_not_there_is_found():
    function = 'def f(a, b):\n    """F.\n\n    Args:\n        a, c: of it.\n        b: its.\n    """\n'
    kind = 'class K:\n    """K.\n\n    Attributes:\n        a: its.\n        b: its.\n    """\n\n    a: int\n'
    assert wrong(ast.walk(ast.parse(function + kind))) == ["1: f has no c", "8: K has no b"]


def not_told(kind: type) -> list[str]:
    """Public methods and properties of a class without a docstring, of its own or inherited."""
    hooks = [
        name
        for name, value in vars(kind).items()
        if not name.startswith("_") and isinstance(value, property | classmethod | type(inspect.isclass))
    ]
    return [f"{kind.__name__}.{name}" for name in hooks if not inspect.getdoc(getattr(kind, name))]


def test_a_hook_of_an_effect_is_told_where_it_is_declared():
    modules = [f"bench.effects.{one.name}" for one in pkgutil.iter_modules(bench.effects.__path__)]
    kinds = {kind for module in modules for _, kind in inspect.getmembers(import_module(module), inspect.isclass)}
    own = [kind for kind in kinds if kind.__module__ in modules and not getattr(kind, "_is_protocol", False)]
    assert len(own) > 20
    assert [name for kind in own for name in not_told(kind)] == []


class Declared:
    def hook(self):
        """It is told here."""


class Overriding(Declared):
    def hook(self): ...
    def more(self): ...


def test_a_hook_without_a_docstring_is_found():
    assert not_told(Overriding) == ["Overriding.more"]
