"""Fuzzing by structure: good documents as trees, of which values, keys and branches are changed, moved and repeated.

    python -m tests.studies.fuzz.grammar rig model mjcf manifest store baseline report --seconds 600

Whatever comes out is TOML, XML, CSV or JSON as its reader parses it, so that it gets beyond the parser. An exception
that is no refusal ends it, as does a warning, an input that takes longer than its deadline, or one that takes too much
memory; that input lies in the working folder then, as `input`. Prints how many were tried, and how many were taken.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import os
import pickle
import random
import resource
import shutil
import time
import tomllib
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import psutil
import tomli_w

from bench.baseline.check import Allowed, compare
from bench.baseline.observe import Observed
from bench.baseline.state import read_baseline
from bench.errors import BenchError
from bench.export.mjcf import link_inertia, single_joint
from bench.files import write_text
from bench.fleet.evaluate import PlannedRecording
from bench.fleet.fleet import tabulate
from bench.fleet.manifest import read_manifest
from bench.fleet.store import Store
from bench.fleet.summary import summarise
from bench.plant.mjcf_file import read_mjcf
from bench.plant.model_file import load_model
from bench.plant.robot import Robot
from bench.report.check import check_document, check_json, described
from bench.report.fleet import fleet_document
from bench.report.html import html
from bench.report.publish import DATA, rebuild
from bench.rig.rig import lacking, load_rig
from tests.command import bench
from tests.hostile import RIG, columns, csv_of
from tests.studies.fuzz.plain import DEADLINE, MEMORY, _within
from tests.studies.fuzz.targets import MODELS, folder, rigs

#: Values at the edges of what is one, for whatever stands at a place.
NUMBERS = (0, -1, 1, 2, 3.5, 1e-320, 1e-30, 1e30, 1e200, 1e308, -1e308, float("nan"), float("inf"), 10**30, 1 << 62)
WORDS = ("", " ", "x" * 5000, "nan", "-inf", "1e999", "../x", "/dev/zero", "٠", "a\tb", "<b>", "&amp;", "\x7f", "–")
UNITS = ("", "kg*m**2", "N*m*s/rad", "s", "1/s", "m", "rad", "deg", "A", "V", "rpm", "N*m/A", "furlong", "%", "m**99")
#: Of a document - bytes: tomllib takes half a minute for ten megabytes on a machine that does much else.
LONGEST = 1 << 18
#: Of a tree; writing TOML of more takes longer than the bench takes to read it.
MOST = 4000
#: Of documents that share one deadline: setting it takes as long as a small document.
BATCH = 32
#: Of a list of numbers in a report - of thousands nearly every place would be a number of a chart.
SAMPLES = 6
OTHERS = (None, True, False, [], {}, [[]], [1.0, 2.0], {"x": 1})
ROBOT = """<mujoco model="arm"><compiler angle="degree"/><default><joint armature="0.1"/></default>
<asset><material name="grey" rgba="0.5 0.5 0.5 1"/></asset>
<worldbody><body name="upper" pos="0 0 0.3"><joint name="shoulder" type="hinge" axis="0 1 0" range="-90 90"/>
<geom type="capsule" size="0.04" fromto="0 0 0 0 0 0.3" mass="2" material="grey"/>
<body name="lower" pos="0 0 0.3"><joint name="elbow" axis="0 1 0" damping="0.1" frictionloss="0.2" stiffness="1"/>
<inertial pos="0 0 0.1" mass="1" diaginertia="0.01 0.01 0.001"/><geom type="box" size="0.1 0.1 0.1"/><site name="tip"/>
</body></body></worldbody>
<equality><joint joint1="elbow" polycoef="0 1 0 0 0" active="false"/></equality>
<actuator><motor name="m" joint="elbow" gear="50"/></actuator><sensor><jointpos joint="elbow"/></sensor></mujoco>"""


def places(tree: Any) -> list[tuple[Any, Any]]:
    """The places below a tree's root: the branch that each is in, and its key there.

    Of a tree too large to be tried, as of a branch that was put into itself, only some more than MOST.
    """
    found, left = [], [tree]
    while left and len(found) <= MOST:
        branch = left.pop()
        for key in branch if isinstance(branch, dict) else range(len(branch)):
            found.append((branch, key))
            if isinstance(branch[key], dict | list):
                left.append(branch[key])
    return found


def copied(tree: Any) -> Any:
    """A copy of a tree, in a tenth of the time of `copy.deepcopy`."""
    return pickle.loads(pickle.dumps(tree))


def changed(rng: random.Random, tree: Any, others: list[Any]) -> Any:
    """A tree with one to four of its places changed; `others` lend their branches."""
    tree = copied(tree)
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4))):
        known = places(tree)
        if not known:
            break
        above, key = rng.choice(known)
        act = rng.random()
        if act < 0.5:
            above[key] = _edge(rng, above[key])
        elif act < 0.62:
            del above[key]
        elif act < 0.74:
            branch, taken = rng.choice(places(rng.choice(others)))
            above[key] = copied(branch[taken])
        elif act < 0.84 and isinstance(above, dict):
            above[rng.choice((*above, *WORDS))] = above.pop(key)
        elif act < 0.94 and isinstance(above, list):
            above[key:key] = copied(above[key : key + 1] * rng.choice((1, 1, 2, 300)))
        else:
            above[key] = rng.choice((copied(tree), [above[key]], {"x": above[key]}))
    return tree


def _edge(rng: random.Random, value: Any) -> Any:
    """Another value for a place, mostly of its kind."""
    number = rng.choice((*NUMBERS, rng.uniform(-10, 10), 10 ** rng.uniform(-9, 9)))
    if rng.random() < 0.15:
        return copied(rng.choice(OTHERS))
    if isinstance(value, str):
        words = value.split(" ")
        words[rng.randrange(len(words))] = rng.choice((f"{number}", rng.choice(WORDS), rng.choice(UNITS)))
        return rng.choice((" ".join(words), f"{number} {rng.choice(UNITS)}", rng.choice(WORDS), value + value))
    if isinstance(value, list | dict) and rng.random() < 0.5:
        return type(value)()
    return number


def as_toml(tree: Any) -> bytes:
    """TOML, which has no null."""

    def known(one: Any) -> Any:
        if isinstance(one, dict):
            return {str(key): known(part) for key, part in one.items() if part is not None}
        return [known(part) for part in one if part is not None] if isinstance(one, list) else one

    return tomli_w.dumps(known(tree)).encode("utf-8", errors="replace")


def as_json(tree: Any) -> bytes:
    return json.dumps(tree).encode()


def of_xml(element: ElementTree.Element) -> dict[str, Any]:
    return {"tag": element.tag, "attributes": dict(element.attrib), "within": [of_xml(one) for one in element]}


def as_xml(tree: Any) -> bytes:
    """Elements of what still has their shape; numbers and lists as attributes have them."""

    def element(one: Any) -> ElementTree.Element | None:
        if not isinstance(one, dict) or not str(one.get("tag", "")).isidentifier():
            return None
        known, within = one.get("attributes"), one.get("within")
        made = ElementTree.Element(str(one["tag"]), _words(known))
        made.extend(part for part in map(element, within if isinstance(within, list) else ()) if part is not None)
        return made

    root = element(tree)
    return b"<mujoco/>" if root is None else ElementTree.tostring(root)


def _words(known: Any) -> dict[str, str]:
    return {str(k) or "x": _word(v) for k, v in known.items()} if isinstance(known, dict) else {}


def _word(value: Any) -> str:
    return " ".join(map(_word, value)) if isinstance(value, list) else str(value)


def as_csv(tree: Any) -> bytes:
    kept = io.StringIO()
    rows = [row if isinstance(row, list) else [row] for row in (tree if isinstance(tree, list) else [tree])]
    csv.writer(kept).writerows([["" if one is None else one for one in row] for row in rows])
    return kept.getvalue().encode("utf-8", errors="replace")


def written(name: str, data: bytes) -> Path:
    path = folder() / name
    path.write_bytes(data)
    return path


def rig(data: bytes) -> None:
    lacking(load_rig(written("rig.toml", data)))


def model(data: bytes) -> None:
    single_joint(load_model(written("model.toml", data)), "joint")


def mjcf(data: bytes) -> None:
    path = written("robot.xml", data)
    Robot.of(path, "elbow")
    link_inertia(read_mjcf(path)[0], "elbow")
    assert not Path("MUJOCO_LOG.TXT").exists()


def manifest(data: bytes) -> None:
    found = read_manifest(written("m.csv", data))
    assert len(found.located("file")) == len(found.located("rig")) == len(found)
    _looked_over(found, [{"status": "refused", "reason": "none"}] * len(found))


def store(data: bytes) -> None:
    """What somebody has put into a fleet's folder, with the sum that belongs to it."""
    kept = Store(folder() / "results")
    tree = json.loads(data)
    if isinstance(tree, dict):
        tree.pop("sha256", None)
        shutil.rmtree(kept.folder, ignore_errors=True)
        kept.put("0" * 64, tree)
    found = read_manifest(written("m.csv", b"file,rig,axis,time\n" + b"".join(b"a.csv,r,a,%d\n" % k for k in range(8))))
    _looked_over(found, [kept.get("0" * 64) or {"status": "failed", "reason": "lost"}] * len(found))


def _looked_over(found: Any, results: list[dict[str, Any]]) -> None:
    planned = [PlannedRecording("0" * 64, None, None, {"version": "1", "rig_sha256": "0", "options": {}})] * len(found)
    tabulate(found, planned, results)
    from bench.fleet.fleet import Fleet

    whole = Fleet(found, planned, results, summarise(found, planned, results), 0)
    html(fleet_document(whole, {"version": "1", "manifest_sha256": "0", "options": {}}))


def baseline(data: bytes) -> None:
    """What a check makes of a baseline, held against the good one as what is found now."""
    before = read_baseline(written("baseline.toml", data))
    before.require_source("recordings")
    now = read_baseline(folder() / "made" / "baseline.toml")
    found = compare(before, Observed(now), Allowed.of(None, before.kind), 0.01)
    html(check_document(found, "one"))
    assert check_json(found) and all(described(one, found) for one in found.comparisons)


def report(data: bytes) -> None:
    written(DATA, data)
    rebuild([folder()])


@dataclass(frozen=True)
class Grammar:
    """How a target's good documents become trees, and trees become its input."""

    target: Callable[[bytes], None]
    trees: Callable[[], list[Any]]
    text: Callable[[Any], bytes]


def _toml(texts: list[bytes]) -> list[Any]:
    return [tomllib.loads(text.decode()) for text in texts]


def _results(name: str) -> list[Any]:
    """Documents that commands write of a small recording."""
    place = folder() / "made"
    place.mkdir(exist_ok=True)
    (place / "rig.toml").write_text(RIG)
    (place / "run.csv").write_text(csv_of(*columns(1500)))
    write_text(place / "m.csv", "file,rig,time\nrun.csv,rig.toml,0\n")
    if name == "baseline":
        recorded = [place / f"run{k}.csv" for k in range(5)]
        for k, path in enumerate(recorded):
            path.write_text(csv_of(*columns(3000 + 200 * k)))
        made = ("--baseline", place / "baseline.toml", "--update")
        assert bench("check", *recorded, "--rig", place / "rig.toml", *made)[0] == 0
        return _toml([(place / "baseline.toml").read_bytes()])
    if name == "store":
        bench("fleet", place / "m.csv", "--out", place / "fleet", "--workers", "1")
        found = sorted((place / "fleet" / "results").rglob("*.json"))
    else:
        for command in ("identify", "diagnose", "inspect"):
            out = () if command == "inspect" else ("--rig", place / "rig.toml", "--out", place / command)
            bench(command, place / "run.csv", *out)
        found = sorted(place.glob(f"*/{DATA}"))
    return [_shortened(json.loads(path.read_text())) for path in found]


def _shortened(tree: Any) -> Any:
    """A document whose lists of numbers are their first few, charts and all."""
    if isinstance(tree, dict):
        return {key: _shortened(part) for key, part in tree.items()}
    if not isinstance(tree, list):
        return tree
    numbers = all(isinstance(part, int | float | None) for part in tree)
    return tree[:SAMPLES] if numbers else [_shortened(part) for part in tree]


MANIFEST = [["file", "rig", "axis", "time", "note"]]
MANIFEST += [["a.csv", "r.toml", "one", 1, "x"], ["b.csv", "emps", "", "", 2], ["s3://b/c.csv", "r.toml", "one", 3, ""]]
DATED = [
    ["file", "rig", "time"],
    ["a.csv", "r.toml", "2026-03-01T12:00:00"],
    ["b.csv", "r.toml", "2026-03-02T12:00:00"],
]
GRAMMARS = {
    "rig": Grammar(rig, lambda: _toml(rigs()), as_toml),
    "model": Grammar(model, lambda: _toml(MODELS), as_toml),
    "mjcf": Grammar(mjcf, lambda: [of_xml(ElementTree.fromstring(ROBOT))], as_xml),
    "manifest": Grammar(manifest, lambda: [MANIFEST, DATED], as_csv),
    "store": Grammar(store, lambda: _results("store"), as_json),
    "baseline": Grammar(baseline, lambda: _results("baseline"), as_toml),
    "report": Grammar(report, lambda: _results("report"), as_json),
}


def fuzz(name: str, seconds: float, runs: int, seed: int) -> tuple[int, int]:
    """How many documents were tried within a time, and how many of them were taken as good."""
    grammar, rng = GRAMMARS[name], random.Random(seed)
    trees = grammar.trees()
    for tree in trees:  # the good ones are taken, and what they import counts as no input's
        grammar.target(grammar.text(tree))
    most = psutil.Process().memory_info().vms + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))
    tried = taken = 0
    until = time.monotonic() + seconds
    with Path("input").open("wb", buffering=0) as kept:
        while time.monotonic() < until and tried < runs:
            with _within(DEADLINE):
                for _ in range(min(BATCH, runs - tried)):
                    tree = changed(rng, rng.choice(trees), trees)
                    if len(places(tree)) > MOST or len(data := grammar.text(tree)) > LONGEST:
                        continue
                    kept.seek(0)
                    kept.write(data)
                    kept.truncate()
                    tried += 1
                    try:
                        grammar.target(data)
                        taken += 1
                    except BenchError as error:
                        assert "\n" not in str(error), error
    return tried, taken


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.studies.fuzz.grammar")
    parser.add_argument("targets", nargs="+", choices=list(GRAMMARS))
    parser.add_argument("--seconds", type=float, default=60.0, help="of each target")
    parser.add_argument("--runs", type=int, default=1 << 40, help="of each target at most")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    os.environ["SERVOBENCH_WATCHED"] = "1"  # an MJCF is compiled here, not in a process of its own each
    warnings.simplefilter("error")  # a user would read it beside, or in the place of, the one line
    for name in asked.targets:
        tried, taken = fuzz(name, asked.seconds, asked.runs, asked.seed)
        print(f"{name}: {tried} tried, {taken} of them taken, nothing found", flush=True)


if __name__ == "__main__":
    main()
