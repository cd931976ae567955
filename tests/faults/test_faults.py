"""Inputs that once gave a wrong number, a wrong name or a dead end, and what is right: one folder each.

`NAME/twin.py` has `write(folder)`, which writes a small synthetic input with known truth. `NAME/expect.toml` states
what is right:

    what = "one sentence: the input, and the rule"
    real = true                       # run on ../shared/faults/NAME, too, where it exists; the default
    long = true                       # that recording takes long: it is a slow test; the default is false
    [[run]]                           # commands, in order, in one folder
    command = "identify log.csv --rig rig.toml --json out.json"
    status = 0                        # exit status, 0 where it is absent; a list: any of these
    says = ["torque in A"]            # each is part of what is printed (white space folded)
    never = ["record faster"]         # none of these is
    json = "out.json"                 # the file that the values below are read from
    [[run.value]]
    path = "parameters.moment_of_inertia"    # keys and indices joined by dots
    true = 0.031                      # {"value", "ci95"}: the interval contains it; a number: within `within`
    within = 0.05                     # the value differs from `true` by at most this share
    on = "twin"                       # or "real": where this value is known; default both
    [[run.value]]
    path = "verdict"
    any = ["explained"]               # equal to one of these; `absent = true`: the key is missing or null
    [[run.value]]
    path = "effects"
    names = ["backlash"]              # the names in a list of effects, in any order

A run may also have `on`, like a value.
"""

from __future__ import annotations

import importlib
import json
import shlex
import shutil
import tomllib
from pathlib import Path

import pytest

from tests.command import bench
from tests.shared import SHARED

HERE = Path(__file__).parent
REAL = SHARED / "faults"
FAULTS = {path.parent.name: tomllib.loads(path.read_text(encoding="utf-8")) for path in HERE.glob("*/expect.toml")}
MISSING = object()


def folded(text):
    return " ".join(text.split())


def found_at(document, path):
    for key in path.split("."):
        try:
            document = document[int(key) if isinstance(document, list) else key]
        except (KeyError, IndexError, TypeError, ValueError):
            return MISSING
    return document


def assert_value(document, value, where):
    found = found_at(document, value["path"])
    said = f"{where}: {value['path']} is {found if found is not MISSING else 'missing'}"
    if value.get("absent"):
        assert found is MISSING or found is None, said
        return
    assert found is not MISSING, said
    if "any" in value:
        assert found in value["any"], said
    if "names" in value:
        assert sorted(effect["name"] for effect in found) == sorted(value["names"]), said
    if "true" in value:
        number = found["value"] if isinstance(found, dict) else found
        if isinstance(found, dict) and found.get("ci95"):
            low, high = found["ci95"]
            assert low <= value["true"] <= high, said
        if "within" in value:
            assert abs(number - value["true"]) <= value["within"] * abs(value["true"]), said
        assert "within" in value or isinstance(found, dict), f"{where}: say `within` for {value['path']}"


def run_all(fault, kind, monkeypatch, folder):
    monkeypatch.chdir(folder)
    for run in fault["run"]:
        if run.get("on", kind) != kind:
            continue
        done = bench(*shlex.split(run["command"]))
        where = f"bench {run['command']} ({kind})"
        printed = folded(done.out + done.err)
        allowed = run.get("status", 0)
        assert done.status in (allowed if isinstance(allowed, list) else [allowed]), (
            f"{where}: {done.status}: {printed[:2000]}"
        )
        for words in run.get("says", []):
            assert folded(words) in printed, f"{where}: does not print {words!r}: {printed[:2000]}"
        for words in run.get("never", []):
            assert folded(words) not in printed, f"{where}: prints {words!r}: {printed[:2000]}"
        for value in run.get("value", []):
            if value.get("on", kind) == kind:
                assert_value(json.loads(Path(run["json"]).read_text(encoding="utf-8")), value, where)


@pytest.mark.parametrize("name", sorted(FAULTS))
def test_a_synthetic_twin_is_right(name, tmp_path, monkeypatch):
    importlib.import_module(f"tests.faults.{name}.twin").write(tmp_path)
    run_all(FAULTS[name], "twin", monkeypatch, tmp_path)


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] if fault.get("long") else [])
        for name, fault in sorted(FAULTS.items())
        if fault.get("real", True)
    ],
)
def test_the_recording_itself_is_right(name, tmp_path, monkeypatch):
    if not (REAL / name).is_dir():
        pytest.skip(f"needs the recordings in ../shared/faults/{name}")
    shutil.copytree(REAL / name, tmp_path, dirs_exist_ok=True, copy_function=shutil.copyfile)
    run_all(FAULTS[name], "real", monkeypatch, tmp_path)
