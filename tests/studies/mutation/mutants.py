"""Places where a source file decides, and what may be changed there."""

from __future__ import annotations

import ast
import random
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
#: Folders of `bench` whose files decide; the others write down what was decided.
DECIDING = (
    *("trace", "units", "rig", "gate", "effects", "plant", "fit", "comparison", "friction_map", "diagnosis"),
    *("baseline", "fleet", "export", "course"),
)
#: The factor on a number: an interval 20 % narrower is the smallest change that matters.
FACTOR = 0.8
#: An operator, and the one that takes its place.
ARITHMETIC = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult}
COMPARISONS = {
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
#: Parts of an expression that are left as they are: an index that is another is an error at once.
SKIPPED = ("annotation", "returns", "decorator_list", "slice")
CALLS = {"max": "min", "min": "max", "any": "all", "all": "any", "maximum": "minimum", "minimum": "maximum"}
CALLS |= {"fmin": "fmax", "fmax": "fmin", "argmin": "argmax", "argmax": "argmin", "floor": "ceil", "ceil": "floor"}


@dataclass(frozen=True)
class Mutant:
    """One change of one file.

    Attributes:
        path: of the file, from the root.
        line, column, end_line, end_column: of what is changed, as `ast` counts: columns in bytes of UTF-8.
        before, after: the text there, and what takes its place.
        function: outermost function or method that it is in, as `path:line`; empty at the top level.
        names: what is assigned there at the top level, of a module or a class.
    """

    path: str
    line: int
    column: int
    end_line: int
    end_column: int
    before: str
    after: str
    function: str
    names: tuple[str, ...]

    @property
    def functions(self) -> set[str]:
        """Functions that it may change: its own, or all that mention what is assigned."""
        return {self.function} if self.function else mentioning(self.names)

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {' '.join(self.before.split())} -> {' '.join(self.after.split())}"

    def applied(self, text: str) -> str:
        """The file's text with the change."""
        lines = text.encode().splitlines(keepends=True)
        head = b"".join(lines[: self.line - 1]) + lines[self.line - 1][: self.column]
        tail = lines[self.end_line - 1][self.end_column :] + b"".join(lines[self.end_line :])
        return (head + self.after.encode() + tail).decode()


def drawn(count: int, seed: int, folders: tuple[str, ...] = DECIDING) -> list[Mutant]:
    """Mutants drawn with equal chance from all places of the folders, no two of one line."""
    paths = [path for name in folders for path in sorted((ROOT / "bench" / name).rglob("*.py"))]
    every = [mutant for path in paths for mutant in mutants_of(path)]
    random.Random(seed).shuffle(every)
    of_lines: dict[tuple[str, int], Mutant] = {}
    for mutant in every:
        of_lines.setdefault((mutant.path, mutant.line), mutant)
    return list(of_lines.values())[:count]


def mutants_of(path: Path) -> list[Mutant]:
    """All mutants of a file."""
    text = path.read_text(encoding="utf-8")
    name = str(path.relative_to(ROOT))
    found = []
    for node, line, names in _deciding(ast.parse(text), name):
        for after in _changed(node):
            before = ast.get_source_segment(text, node) or ""  # which splits the text into lines each time
            place = (node.lineno, node.col_offset, node.end_lineno or node.lineno, node.end_col_offset or 0)
            found.append(Mutant(name, *place, before, f"({after})", f"{name}:{line}" if line else "", names))
    return found


@cache
def _mentions() -> dict[str, tuple[set[str], set[str]]]:
    """Of each name the functions of the bench that mention it, and what is assigned from it at the top level."""
    found: dict[str, tuple[set[str], set[str]]] = defaultdict(lambda: (set(), set()))
    for path in sorted((ROOT / "bench").rglob("*.py")):
        name, tree = str(path.relative_to(ROOT)), ast.parse(path.read_text(encoding="utf-8"))
        imported = {
            alias.asname or alias.name: f"{(node.module or '').replace('.', '/')}.py:{alias.name}"
            for node in ast.walk(tree)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        for node, line, names in _deciding(tree, name, SKIPPED[:-1]):
            plain = isinstance(node, ast.Name)
            mentioned = imported.get(node.id, f"{name}:{node.id}") if plain else f".{getattr(node, 'attr', '')}"
            functions, assigned = found[mentioned]
            functions |= {f"{name}:{line}"} if line else set()
            assigned |= set() if line else {*names}
    return found


def mentioning(names: tuple[str, ...]) -> set[str]:
    """Functions that mention one of these names, or what is assigned from it."""
    functions: set[str] = set()
    known, open_ = set(names), [*names]
    while open_:
        own, assigned = _mentions()[open_.pop()]
        functions |= own
        open_ += assigned - known
        known |= assigned
    return functions


def _deciding(
    node: ast.AST,
    path: str,
    skipped: tuple[str, ...] = SKIPPED,
    line: int = 0,
    names: tuple[str, ...] = (),
    attribute: bool = False,
) -> Iterator[tuple[ast.expr, int, tuple[str, ...]]]:
    """Expressions that decide, without annotations, messages and what only type checkers read.

    With the first line of the outermost function they are in, zero at the top level, and the names assigned there:
    `path:NAME` of a module, `.name` of a class.
    """
    attribute |= isinstance(node, ast.ClassDef)
    if isinstance(node, ast.FunctionDef) and not line:
        line = min([node.lineno, *(each.lineno for each in node.decorator_list)])
    if isinstance(node, ast.Assign | ast.AnnAssign) and not line:
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        assigned = [each.id for one in targets for each in ast.walk(one) if isinstance(each, ast.Name)]
        names = tuple(f".{each}" if attribute else f"{path}:{each}" for each in assigned)
    if isinstance(node, ast.expr):
        yield node, line, names
    for field, value in ast.iter_fields(node):
        if field in skipped or isinstance(node, ast.Raise | ast.JoinedStr):
            continue
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST):
                yield from _deciding(child, path, skipped, line, names, attribute)


def _changed(node: ast.expr) -> Iterator[str]:
    """Texts that may take the place of an expression."""
    if isinstance(node, ast.BinOp) and type(node.op) in ARITHMETIC and not _textual(node):
        yield ast.unparse(ast.BinOp(node.left, ARITHMETIC[type(node.op)](), node.right))
    elif isinstance(node, ast.Compare) and len(node.ops) == 1:
        yield ast.unparse(ast.Compare(node.left, [COMPARISONS[type(node.ops[0])]()], node.comparators))
    elif isinstance(node, ast.BoolOp):
        yield ast.unparse(ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values))
        yield ast.unparse(ast.BoolOp(node.op, node.values[:-1]) if len(node.values) > 2 else node.values[0])
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
        yield ast.unparse(node.operand)
    elif isinstance(node, ast.IfExp):
        yield ast.unparse(ast.IfExp(node.test, node.orelse, node.body))
    elif isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value:
        yield repr(FACTOR * node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int) and not isinstance(node.value, bool):
        yield repr(node.value + 1)
    elif isinstance(node, ast.Call):
        called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        if called in CALLS:
            whole = ast.unparse(node.func)
            yield f"{whole.removesuffix(called)}{CALLS[called]}{ast.unparse(node).removeprefix(whole)}"


def _textual(node: ast.BinOp) -> bool:
    """Whether it joins texts."""
    sides = (node.left, node.right)
    return any(isinstance(side, ast.JoinedStr) or isinstance(getattr(side, "value", None), str) for side in sides)
