"""Imports follow the way of the data, never back; effects are asked and never named; files stay small."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from bench.effects.catalogue import catalogue

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted((ROOT / "bench").rglob("*.py"))
#: What makes the pages of the documentation.
PAGE_MAKERS = sorted((ROOT / "docs" / "_ext").glob("*.py"))

#: Later layers may import earlier ones, and their own.
LAYERS = (
    {"errors", "names", "bounds", "files", "structured", "assets", "allocation", "presented", "offered", "validated"},
    {"jobs"},
    {"units", "axis_kind", "arrays", "parameter"},
    {"comparison"},
    {"trace"},
    {"rig"},
    {"gate"},
    {"effects"},
    {"packed"},
    {"plant"},
    {"fit"},
    {"friction_map"},
    {"diagnosis"},
    {"baseline", "validation", "fleet", "export", "view", "joints"},
    {"report"},
    {"course"},  # a guest: nothing but its commands imports it
    {"demo"},
    {"__init__"},  # public names: `import bench`
    {"cli", "__main__"},
)


def layer_of(module: str) -> int:
    part = module.split(".")[1] if "." in module else "__init__"
    return next(level for level, names in enumerate(LAYERS) if part in names)


def imports(path: Path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "bench":
            yield node.module if node.module != "bench" else f"bench.{node.names[0].name}"
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.split(".")[0] == "bench")


def module_of(path: Path) -> str:
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


@pytest.mark.parametrize("path", SOURCES, ids=module_of)
def test_no_import_goes_back(path):
    own = layer_of(module_of(path))
    back = [name for name in imports(path) if name != "bench.__version__" and layer_of(name) > own]
    assert not back, f"{module_of(path)} imports {back} from further down the way of the data"


def files_imported(path: Path) -> set[str]:
    """Modules of the bench whose file a file imports, those for type checkers included."""
    modules = {module_of(source) for source in SOURCES}
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            every = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= every & modules or {node.module} & modules
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names} & modules
    return found - {"bench", module_of(path)}


def test_no_files_import_each_other_in_a_circle():
    waiting = {module_of(path): files_imported(path) for path in SOURCES}
    while free := {name for name, needed in waiting.items() if not needed & waiting.keys()}:
        waiting = {name: needed for name, needed in waiting.items() if name not in free}
    assert not waiting, "each of these imports one of them"


@pytest.mark.parametrize(
    "path", [path for path in SOURCES if layer_of(module_of(path)) < len(LAYERS) - 2], ids=module_of
)
def test_no_string_names_a_module(path):
    """Which would be an import that no test above sees: only what is above all folders has a table of them."""
    modules = {module_of(source) for source in SOURCES if source.stem != "__init__"}
    assert modules.isdisjoint(node.value for node in texts(ast.parse(path.read_text(encoding="utf-8"))))


def test_a_class_name_has_one_meaning():
    """The independent truth aside, which shares nothing with what it judges."""
    found: dict[str, list[str]] = {}
    for path in SOURCES:
        if "independent" not in path.parts:
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ClassDef):
                    found.setdefault(node.name, []).append(module_of(path))
    assert {name: modules for name, modules in found.items() if len(modules) > 1} == {}


def test_the_truth_owes_nothing_to_what_it_judges():
    folder = ROOT / "bench" / "validation" / "independent"
    found = {name for path in sorted(folder.rglob("*.py")) for name in imports(path)}
    others = {name for name in found if not name.startswith("bench.validation.independent")}
    assert others == {"bench.trace.trace"}, "a recording is a Trace; nothing else of the bench has a part in making one"


#: Names of the bench's own effects, each a word of its own in a text.
NAMED = re.compile(rf"(?<![a-z_])({'|'.join(catalogue())})(?![a-z_])")
#: Modules that are an effect, or lie in the folder of one.
OF_EFFECTS = {type(effect).__module__ for effect in catalogue().values()}


def texts(tree: ast.AST) -> Iterator[ast.Constant]:
    """All string constants but docstrings."""
    documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    first = [node.body[0] for node in ast.walk(tree) if isinstance(node, documented) and node.body]
    documenting = {id(node.value) for node in first if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in documenting:
            yield node


def known_by_name(tree: ast.AST) -> list[str]:
    """Where code knows one effect from another: by its name, by the module it is in, or by comparing names.

    Whether a name is in a set is no such knowledge: an effect declares the set, or the caller asked for it. Two names
    held against each other are: what is one is decided by `is`.
    """
    found = [f"{node.lineno}: {node.value!r}" for node in texts(tree) if NAMED.search(node.value)]
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module:
            whole = [node.module, *(f"{node.module}.{alias.name}" for alias in node.names)]
        elif isinstance(node, ast.Import):
            whole = [alias.name for alias in node.names]
        else:
            whole = []
        found += [f"{node.lineno}: {name}" for name in whole if any(f"{name}.".startswith(f"{e}.") for e in OF_EFFECTS)]
        if isinstance(node, ast.Compare) and any(isinstance(one, ast.Eq | ast.NotEq) for one in node.ops):
            sides = [ast.unparse(side) for side in (node.left, *node.comparators)]
            found += [f"{node.lineno}: {side}" for side in sides if side.endswith(("effect.name", "rival.name"))]
    return found


@pytest.mark.parametrize(
    "path", [path for path in (*SOURCES, *PAGE_MAKERS) if "effects" not in path.parts], ids=module_of
)
def test_no_effect_is_known_by_name(path):
    assert known_by_name(ast.parse(path.read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize(
    "code",
    [
        'catalogue()["torque_offset"]',
        'if term.effect.name == "backlash": pass',
        'lags = {"current_loop_lag", "velocity_filter_lag"}',
        'say(f"it is unbalance of {amplitude}")',
        "from bench.effects.backlash import EFFECT",
        "from bench.effects import torque_ripple",
        "from bench.effects.backlash import load_positions",
        "import bench.effects.cogging_torque",
        "same = present.effect.name == named.effect.name",
    ],
)
def test_knowing_an_effect_by_name_is_seen(code):
    assert known_by_name(ast.parse(code))


@pytest.mark.parametrize(
    "code",
    [
        'def f():\n    """As backlash does."""',
        "taken = other.name in effect.replaces",
        "catalogue()[name]",
        'unit = {"torque_offset_unit": 1}',
    ],
)
def test_asking_an_effect_is_not_knowing_its_name(code):
    assert not known_by_name(ast.parse(code))


@pytest.mark.parametrize("path", (*SOURCES, *PAGE_MAKERS), ids=module_of)
def test_functions_stay_small(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef):
            assert node.end_lineno - node.lineno < 50, f"{node.name} has {node.end_lineno - node.lineno + 1} lines"
