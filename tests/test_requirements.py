"""What the bench needs is declared: its imports, lower bounds that are tested, and a lock that keeps to them."""

import ast
import sys
import tomllib
from importlib.metadata import packages_distributions, requires

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from tests.hostile import ROOT
from tests.sources import SOURCES, nodes

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
#: Imported by the bench, and brought along by what it declares.
BROUGHT = {"markupsafe": "jinja2", "pydantic-core": "pydantic"}


def declared(*extras):
    """Requirements of the project and of some extras, by name; its own extras left out."""
    found = [Requirement(line) for line in [*PROJECT["dependencies"], *(x for name in extras for x in EXTRAS[name])]]
    return {canonicalize_name(each.name): each for each in found if each.name != PROJECT["name"]}


def pinned(name):
    lines = (ROOT / ".ci" / name).read_text(encoding="utf-8").splitlines()
    found = [Requirement(line) for line in lines if line and not line.startswith("#")]
    assert all(each.url is None for each in found)
    exact = {}
    for each in found:
        (specifier,) = each.specifier
        assert specifier.operator == "=="
        exact[canonicalize_name(each.name)] = specifier.version
    assert len(exact) == len(found)
    return exact


OPTIONAL = ("mcap", "tdms", "hdf5", "mdf", "video", "lab", "cluster")


def test_lower_bounds_are_the_oldest_versions_that_are_tested():
    bounds = {}
    for name, each in declared(*OPTIONAL, "test").items():
        (specifier,) = each.specifier
        assert specifier.operator == ">="
        bounds[name] = specifier.version
    # distributed comes as an extra of dask, of the same version
    bounds["distributed"] = bounds["dask"]
    assert pinned("oldest.txt") == bounds


def test_the_lock_keeps_to_every_bound_and_holds_no_project():
    locked = pinned("locked.txt")
    assert PROJECT["name"] not in locked
    for name, each in declared(*OPTIONAL, "notebooks", "test", "docs", "dev").items():
        assert each.specifier.contains(locked[name]), f"{name} {locked[name]}: {each}"


def imported(path):
    """Packages outside the standard library and the bench that a file imports, wherever in it."""
    names = [alias.name for node in nodes(path) if isinstance(node, ast.Import) for alias in node.names]
    names += [node.module or "" for node in nodes(path) if isinstance(node, ast.ImportFrom) and node.level == 0]
    return {name.split(".")[0] for name in names} - {"bench", *sys.stdlib_module_names}


def test_every_import_is_of_something_that_is_declared():
    providers = packages_distributions()
    known = {*declared(*OPTIONAL), *BROUGHT, "distributed"}
    packages = set().union(*(imported(path) for path in SOURCES))
    assert len(packages) > 10
    for package in packages:
        given = {canonicalize_name(name) for name in providers.get(package, [])}
        assert given & known, f"{package} is declared nowhere"


def test_what_is_brought_along_still_is():
    for name, bringer in BROUGHT.items():
        assert bringer in declared()
        assert name in {canonicalize_name(Requirement(line).name) for line in requires(bringer) or []}
