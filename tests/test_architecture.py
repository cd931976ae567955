"""Imports follow the way of the data, never back; files stay small; public things say what they are."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
SOURCES = sorted((ROOT / "bench").rglob("*.py"))

#: Later layers may import earlier ones, and their own.
LAYERS = (
    {"__init__", "errors", "units", "arrays", "axis_kind", "assets", "files"},
    {"trace"},
    {"rig"},
    {"effects"},
    {"plant"},
    {"identify"},
    {"friction_map"},
    {"diagnose"},
    {"validate"},
    {"lab"},
    {"report"},
    {"demo"},
    {"console"},
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


@pytest.mark.parametrize("path", SOURCES, ids=module_of)
def test_files_and_functions_stay_small(path):
    text = path.read_text(encoding="utf-8")
    assert len(text.splitlines()) < 300
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef):
            assert node.end_lineno - node.lineno < 50, f"{node.name} has {node.end_lineno - node.lineno + 1} lines"
