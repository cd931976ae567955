"""Imports follow the way of the data, never back; effects are asked and never named; files stay small."""

import ast
import re
from collections.abc import Iterable, Iterator

import pytest

from bench.effects.catalogue import catalogue
from tests.sources import PAGE_MAKERS, ROOT, SOURCES, module_of, nodes

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
    {"baseline", "validation", "fleet", "export", "view", "joints", "servos"},
    {"report"},
    {"course"},  # a guest: nothing but its commands imports it
    {"demo"},
    {"__init__"},  # public names: `import bench`
    {"cli", "__main__"},
)


def layer_of(module: str) -> int:
    part = module.split(".")[1] if "." in module else "__init__"
    return next(level for level, names in enumerate(LAYERS) if part in names)


def imports(found: Iterable[ast.AST]) -> Iterator[str]:
    """Modules of the bench that nodes of a file import."""
    for node in found:
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "bench":
            yield node.module if node.module != "bench" else f"bench.{node.names[0].name}"
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.split(".")[0] == "bench")


def backward(module: str, found: Iterable[ast.AST]) -> list[str]:
    """Imports of a module from a later layer."""
    own = layer_of(module)
    return [name for name in imports(found) if name != "bench.__version__" and layer_of(name) > own]


def test_no_import_goes_back():
    assert {module_of(path): back for path in SOURCES if (back := backward(module_of(path), nodes(path)))} == {}


@pytest.mark.parametrize(
    ("module", "code", "back"),
    [
        ("bench.fit.identify", "from bench.diagnosis.search import search", ["bench.diagnosis.search"]),
        ("bench.trace.trace", "def f():\n    import bench.report.html", ["bench.report.html"]),
        ("bench.diagnosis.search", "from bench.fit.identify import identify\nfrom bench import __version__", []),
    ],
)
def test_an_import_from_a_later_layer_is_found(module, code, back):
    assert backward(module, ast.walk(ast.parse(code))) == back


def files_imported(found: Iterable[ast.AST], modules: set[str]) -> set[str]:
    """Modules of the bench whose file a file imports, those for type checkers included."""
    files = set()
    for node in found:
        if isinstance(node, ast.ImportFrom) and node.module:
            every = {f"{node.module}.{alias.name}" for alias in node.names}
            files |= every & modules or {node.module} & modules
        elif isinstance(node, ast.Import):
            files |= {alias.name for alias in node.names} & modules
    return files - {"bench"}


def in_a_circle(needs: dict[str, set[str]]) -> dict[str, set[str]]:
    """Modules of which each imports another of them."""
    waiting = {module: needed - {module} for module, needed in needs.items()}
    while free := {name for name, needed in waiting.items() if not needed & waiting.keys()}:
        waiting = {name: needed for name, needed in waiting.items() if name not in free}
    return waiting


def test_no_files_import_each_other_in_a_circle():
    modules = {module_of(path) for path in SOURCES}
    needs = {module_of(path): files_imported(nodes(path), modules) for path in SOURCES}
    assert sum(map(len, needs.values())) > len(SOURCES)
    assert in_a_circle(needs) == {}


def test_a_circle_of_imports_is_found():
    names = {"bench.a", "bench.b", "bench.c"}
    code = {
        "bench.a": "from bench import b",
        "bench.b": "def f():\n    from bench.a import g",
        "bench.c": "import bench.a",
    }
    needs = {name: files_imported(ast.walk(ast.parse(text)), names) for name, text in code.items()}
    assert in_a_circle(needs).keys() == names, "c waits for the circle of a and b"
    assert in_a_circle({**needs, "bench.b": set()}) == {}


def module_names(found: Iterable[ast.AST], modules: set[str]) -> list[str]:
    return [f"{node.lineno}: {node.value}" for node in texts(found) if node.value in modules]


def test_no_string_names_a_module():
    """Which would be an import that no test above sees: only what is above all folders has a table of them."""
    modules = {module_of(path) for path in SOURCES if path.stem != "__init__"}
    below = [path for path in SOURCES if layer_of(module_of(path)) < len(LAYERS) - 2]
    assert {module_of(path): named for path in below if (named := module_names(nodes(path), modules))} == {}
    assert module_names(ast.walk(ast.parse('import_module("bench.fit.identify")')), modules)


def classes_of(found: Iterable[ast.AST]) -> list[str]:
    return [node.name for node in found if isinstance(node, ast.ClassDef)]


def test_a_class_name_has_one_meaning():
    """The independent truth aside, which shares nothing with what it judges."""
    found: dict[str, list[str]] = {}
    for path in SOURCES:
        if "independent" not in path.parts:
            for name in classes_of(nodes(path)):
                found.setdefault(name, []).append(module_of(path))
    assert len(found) > 100
    assert {name: modules for name, modules in found.items() if len(modules) > 1} == {}


def test_the_truth_owes_nothing_to_what_it_judges():
    truth = [path for path in SOURCES if path.is_relative_to(ROOT / "bench" / "validation" / "independent")]
    others = {name for path in truth for name in imports(nodes(path))}
    others = {name for name in others if not name.startswith("bench.validation.independent")}
    assert others == {"bench.trace.trace"}, "a recording is a Trace; nothing else of the bench has a part in making one"


#: Names of the bench's own effects, each a word of its own in a text.
NAMED = re.compile(rf"(?<![a-z_])({'|'.join(catalogue())})(?![a-z_])")
#: Modules that are an effect, or lie in the folder of one.
OF_EFFECTS = {type(effect).__module__ for effect in catalogue().values()}


def texts(found: Iterable[ast.AST]) -> Iterator[ast.Constant]:
    """All string constants but docstrings."""
    found = list(found)
    documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    first = [node.body[0] for node in found if isinstance(node, documented) and node.body]
    documenting = {id(node.value) for node in first if isinstance(node, ast.Expr)}
    for node in found:
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in documenting:
            yield node


def known_by_name(nodes_of_a_file: Iterable[ast.AST]) -> list[str]:
    """Where code knows one effect from another: by its name, by the module it is in, or by comparing names.

    Whether a name is in a set is no such knowledge: an effect declares the set, or the caller asked for it. Two names
    held against each other are: what is one is decided by `is`.
    """
    every = list(nodes_of_a_file)
    found = [f"{node.lineno}: {node.value!r}" for node in texts(every) if NAMED.search(node.value)]
    for node in every:
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


def test_no_effect_is_known_by_name():
    others = [path for path in (*SOURCES, *PAGE_MAKERS) if "effects" not in path.parts]
    assert {module_of(path): found for path in others if (found := known_by_name(nodes(path)))} == {}


KNOWING = """
catalogue()["torque_offset"]
if term.effect.name == "backlash": pass
lags = {"current_loop_lag", "velocity_filter_lag"}
say(f"it is unbalance of {amplitude}")
from bench.effects.backlash import EFFECT
from bench.effects import torque_ripple
from bench.effects.backlash import load_positions
import bench.effects.cogging_torque
same = present.effect.name == named.effect.name
""".strip().splitlines()
NOT_KNOWING = [
    'def f():\n    """As backlash does."""',
    "taken = other.name in effect.replaces",
    "catalogue()[name]",
    'unit = {"torque_offset_unit": 1}',
]


def test_knowing_an_effect_by_name_is_found_and_asking_it_is_not():
    assert [code for code in KNOWING if not known_by_name(ast.walk(ast.parse(code)))] == []
    assert [code for code in NOT_KNOWING if known_by_name(ast.walk(ast.parse(code)))] == []


def too_long(found: Iterable[ast.AST]) -> list[str]:
    lengths = [(node.name, node.end_lineno - node.lineno + 1) for node in found if isinstance(node, ast.FunctionDef)]
    return [f"{name} has {length} lines" for name, length in lengths if length > 50]


def test_functions_stay_small():
    assert {module_of(path): long for path in (*SOURCES, *PAGE_MAKERS) if (long := too_long(nodes(path)))} == {}
    assert too_long(ast.walk(ast.parse("def f():" + 49 * "\n    pass"))) == []
    assert too_long(ast.walk(ast.parse("class C:\n  def f():" + 50 * "\n    pass"))) == ["f has 51 lines"]
