"""What every command answers on recordings at hand, written down, and two such answers held against each other.

    python -m tests.studies.outputs record before          # at one commit
    python -m tests.studies.outputs record after           # at another
    python -m tests.studies.outputs compare before after   # exit status 1 where they differ

A job is a list of commands that run one after the other in a folder of their own; each leaves its files, its exit
status and all that it prints. Numbers in JSON, TOML and CSV files are the same within a relative tolerance; provenance,
which names versions and paths, is left out.
"""

from __future__ import annotations

import argparse
import csv
import gzip
import json
import math
import os
import shutil
import sys
import tomllib
from collections.abc import Iterator
from fnmatch import fnmatch
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SHARED = ROOT.parent / "shared"
#: What differs between two runs of the same commit, or names the commit.
LEFT_OUT = frozenset({"provenance", "version", "seconds", "made"})
PROFILES = ("identification", "fast_reversals", "full_torque", "speed_staircase", "slow_reversals", "multisine")
HIDDEN = {
    "cogging": "cogging_torque:amplitude=0.05,harmonic=6",
    "stribeck": "stribeck_friction:static_friction=0.15,stribeck_velocity=2",
    "backlash": "backlash:gap=0.01",
    "elastic": "elastic_coupling:stiffness=60",
    "lag": "velocity_filter_lag:time_constant=0.002",
}

#: Loaded before the forks.
LIBRARIES = ("bench.cli", "matplotlib.pyplot", "mujoco", "numpy", "pyarrow.csv")

Job = list[list[str]]


def jobs(shared: Path) -> dict[str, Job]:
    """Commands by the name of their folder; `RIGS` and the like are paths already."""
    rigs, data = ROOT / "data" / "rigs", shared / "data"
    found: dict[str, Job] = {"effects": [["effects"]], "rigs": [["rigs"]], "demo": [["demo", "--out", "demo"]]}
    for profile in PROFILES:
        run = ["simulate", f"{rigs}/sh30701p.toml", "--out", "run.csv.gz", "--profile", profile, "--seed", "3"]
        found[f"simulate/{profile}"] = [run, _identify("run.csv.gz", rig=f"{rigs}/sh30701p.toml")]
    for name, effect in HIDDEN.items():
        found[f"hidden/{name}"] = _hidden(f"{rigs}/sh30701p.toml", effect)
    found |= _exports(data) | _axes(data, rigs) | _cases(shared / "cases") | _around(rigs, shared / "cases")
    return found


def _identify(*traces: str, rig: str, more: tuple[str, ...] = ()) -> list[str]:
    return ["identify", *traces, "--rig", rig, "--json", "identify.json", *more]


def _hidden(rig: str, effect: str) -> Job:
    made = [
        ["simulate", rig, "--out", f"run{k}.csv.gz", "--profile", profile, "--seed", str(k), "--effect", effect]
        for k, profile in enumerate(("identification", "speed_staircase"))
    ]
    found = ["diagnose", "run0.csv.gz", "--rig", rig, "--holdout", "run1.csv.gz", "--json", "-", "--out", "found"]
    model = "found/model.toml"
    return [
        *made,
        _identify("run0.csv.gz", "run1.csv.gz", rig=rig, more=("--out", "figures")),
        _identify("run0.csv.gz", rig=rig, more=("--refine",)),
        found,
        ["replay", model, "run1.csv.gz", "--rig", rig, "--out", "replay.csv", "--report", "replay.html"],
        ["export", model, "--snippet", "--out", "joint.xml"],
        ["export", model, "--ranges", "found/diagnosis.json", "--out", "ranges.json"],
        ["compensate", model, "--rig", rig, "--out", "tables"],
        ["view", model, "run1.csv.gz", "--rig", rig, "--out", "view.html", "--from", "0.5", "--to", "1.5"],
        ["check", "run0.csv.gz", "--rig", rig, "--baseline", "axis.toml", "--update"],
        [
            "check",
            "run1.csv.gz",
            "--rig",
            rig,
            "--baseline",
            "axis.toml",
            "--json",
            "check.json",
            "--junit",
            "check.xml",
        ],
        ["check", "--simulated", model, "--rig", rig, "--baseline", "axis.toml", "--json", "simulated.json"],
        ["report", "found", "figures"],
    ]


def _exports(data: Path) -> dict[str, Job]:
    found = {}
    for folder in sorted(path for path in (data / "exports").glob("*") if path.is_dir()):
        files = [str(path) for path in sorted(folder.iterdir()) if path.name != "rig.toml"]
        found[f"exports/{folder.name}"] = [
            command
            for name in files
            for command in (
                ["inspect", name, "--json", "inspect.json"],
                ["inspect", name, "--rig", f"{folder}/rig.toml"],
                _identify(name, rig=f"{folder}/rig.toml"),
            )
        ]
    for path in sorted((data / "formats").iterdir()):
        found[f"formats/{path.stem}"] = [["inspect", str(path), "--json", "inspect.json"]]
    return found


def _axes(data: Path, rigs: Path) -> dict[str, Job]:
    """Recordings of other people's axes: each inspected, identified and diagnosed."""
    axes = {
        "emps": (f"{rigs}/emps.toml", [data / "emps" / "DATA_EMPS.mat"]),
        "emps_pulses": (f"{rigs}/emps.toml", [data / "emps" / "DATA_EMPS_PULSES.mat"]),
        "laas": (f"{rigs}/laas.toml", [data / "laas_anticogging" / "speed_test1.txt"]),
        "laas_acc": (f"{rigs}/laas.toml", [data / "laas_anticogging" / "acc_current.txt"]),
        "xl330": (f"{rigs}/bam_xl330.toml", sorted((data / "bam_xl330").glob("*.json"))[11:12]),
    }
    for folder in sorted(path for path in (data / "real").glob("*") if path.is_dir()):
        for path in sorted(folder.glob("*.csv.gz")):
            axes[f"{folder.name}_{path.name.split('.')[0]}"] = (f"{folder}/rig.toml", [path])
        axes[f"{folder.name}_together"] = (f"{folder}/rig.toml", sorted(folder.glob("*.csv.gz"))[:2])
    found = {}
    for name, (rig, paths) in axes.items():
        files = [str(path) for path in paths]
        found[f"axes/{name}"] = [
            ["inspect", files[0], "--rig", rig, "--json", "inspect.json"],
            _identify(*files, rig=rig, more=("--offset", "--out", "figures")),
        ]
        if len(files) == 1:  # several together take minutes
            found[f"axes/{name}"].append(
                ["diagnose", *files, "--rig", rig, "--json", "diagnose.json", "--out", "found"]
            )
    screw = sorted((data / "tro2021_screw" / "driveNo1" / "steady_state").rglob("*.csv"))
    rig = f"{rigs}/tro2021.toml"
    found["axes/friction"] = [
        ["friction", *map(str, screw), "--rig", rig, "--json", "friction.json", "--report", "friction.html"]
    ]
    pendulum = data / "robots" / "dfki_double_pendulum"
    log, robot = str(pendulum / "A0_20220812-061705.csv.gz"), str(pendulum / "A0.xml")
    found["axes/robot"] = [
        ["inspect", log, "--json", "inspect.json"],
        ["identify", log, "--mjcf", robot, "--joint", "Joint1", "--json", "identify.json"],
    ]
    return found


def _cases(cases: Path) -> dict[str, Job]:
    return {
        f"cases/{case.name}": [
            _identify(f"{case}/run1.csv.gz", rig=f"{case}/rig.toml"),
            [
                *("diagnose", f"{case}/run1.csv.gz", "--rig", f"{case}/rig.toml", "--holdout", f"{case}/run2.csv.gz"),
                *("--json", "diagnose.json", "--out", "found"),
            ],
            ["replay", "found/model.toml", f"{case}/run2.csv.gz", "--rig", f"{case}/rig.toml", "--out", "replay.csv"],
        ]
        for case in sorted(path for path in cases.glob("case-*") if path.is_dir())
    }


def _around(rigs: Path, cases: Path) -> dict[str, Job]:
    """Commands on more than a recording."""
    rig = f"{rigs}/sh30701p.toml"
    two = sorted(cases.glob("case-*"))[:3]
    manifest = "file,rig,axis,time\n" + "\n".join(
        f"{case}/run{k}.csv.gz,{case}/rig.toml,{case.name},2026-01-0{k}T00:00:00" for case in two for k in (1, 2)
    )
    return {
        "lab": [
            ["lab", "--out", "lab"],
            ["limits", str(ROOT / "data/traces/MaxAcc.trace"), "--rig", f"{rigs}/lab.toml"],
        ],
        "class": [["lab", "--record", "class", "--students", "2"], ["lab", "--notebooks", "notebooks"]],
        "plan": [["plan", "--rig", rig, "--out", "motion.csv"]],
        "validate": [["validate", "--rigs", "4", "--seed", "5", "--json", "validate.json", "--out", "validation"]],
        "names": [
            ["validate", "--rigs", "3", "--effects", "1", "--diagnose", "--workers", "1", "--json", "names.json"]
        ],
        "fleet": [["@write", "fleet.csv", manifest], ["fleet", "fleet.csv", "--out", "fleet", "--json", "fleet.json"]],
        "wrong": [
            ["identify", "nothing.csv", "--rig", rig],
            ["identify", rig, "--rig", rig],
            ["diagnose", str(ROOT / "data/traces/MaxAcc.trace"), "--rig", "nothing.toml"],
            ["simulate", rig, "--out", "run.csv", "--effect", "coging_torque:amplitude=1"],
        ],
    }


def run(name: str, commands: Job, out: Path) -> None:
    """Runs the commands of a job in their folder; each in a fork, so that libraries are loaded once."""
    folder = out / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    os.chdir(folder)
    for place, command in enumerate(commands):
        if command[0] == "@write":
            Path(command[1]).write_text(command[2], encoding="utf-8")
            continue
        child = os.fork()
        if not child:
            _answer(command, folder / f"{place:02d}_{command[0]}.txt")
        _, status = os.waitpid(child, 0)
        with (folder / f"{place:02d}_{command[0]}.txt").open("a", encoding="utf-8") as said:
            said.write(f"\nexit status {os.waitstatus_to_exitcode(status)}\n")


def _answer(command: list[str], said: Path) -> None:
    """The command in this process, which ends with it."""
    target = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    os.dup2(target, 1)
    os.dup2(target, 2)
    sys.argv = ["bench", *command]
    from bench.__main__ import main

    try:
        main()
    except SystemExit as stop:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(stop.code if isinstance(stop.code, int) else bool(stop.code))
    sys.stdout.flush()
    os._exit(0)


def record(out: Path, shared: Path, only: str, count: int) -> None:
    """All jobs whose name matches, `count` side by side."""
    os.environ |= {"COLUMNS": "120", "OPENBLAS_NUM_THREADS": "1", "TERM": "dumb", "NO_COLOR": "1"}
    for library in LIBRARIES:
        import_module(library)

    chosen = {name: commands for name, commands in jobs(shared).items() if fnmatch(name, only)}
    running: set[int] = set()
    for place, (name, commands) in enumerate(chosen.items()):
        while len(running) >= count:
            running.discard(os.wait()[0])
        child = os.fork()
        if not child:
            run(name, commands, out)
            os._exit(0)
        running.add(child)
        print(f"{place + 1} of {len(chosen)}: {name}", flush=True)
    while running:
        running.discard(os.wait()[0])


def differences(before: object, after: object, tolerance: float, where: str = "") -> Iterator[str]:
    """Where two parsed documents differ, in words."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in [*before, *(key for key in after if key not in before)]:
            if key in LEFT_OUT:
                continue
            if key not in after or key not in before:
                yield f"{where}.{key}: only {'before' if key in before else 'after'}"
            else:
                yield from differences(before[key], after[key], tolerance, f"{where}.{key}")
    elif isinstance(before, list) and isinstance(after, list):
        if len(before) != len(after):
            yield f"{where}: {len(before)} items before, {len(after)} after"
        for k, (one, other) in enumerate(zip(before, after, strict=False)):
            yield from differences(one, other, tolerance, f"{where}[{k}]")
    elif _number(before) and _number(after):
        one, other = float(before), float(after)  # type: ignore[arg-type]
        both_nan = math.isnan(one) and math.isnan(other)
        if not both_nan and not math.isclose(one, other, rel_tol=tolerance, abs_tol=1e-300):
            yield (
                f"{where}: {one:.9g} before, {other:.9g} after ({other / one - 1:+.2g})"
                if one
                else f"{where}: 0, {other}"
            )
    elif before != after:
        yield f"{where}: {before!r} before, {after!r} after"


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def parsed(path: Path) -> object:
    """A file's content as a document that can be compared; None for pages and pictures, which are looked at."""
    if path.suffix == ".json":
        return json.loads(path.read_text(encoding="utf-8"))
    if path.suffix == ".toml":
        return tomllib.loads(path.read_text(encoding="utf-8"))
    if path.name.endswith((".csv", ".csv.gz")):
        with gzip.open(path, "rt") if path.suffix == ".gz" else path.open(encoding="utf-8") as file:
            return [[_cell(cell) for cell in row] for row in csv.reader(file)]
    if path.suffix in (".txt", ".xml", ".md", ".py", ".ipynb"):
        return path.read_text(encoding="utf-8").splitlines()
    return None


def _cell(text: str) -> object:
    try:
        return float(text)
    except ValueError:
        return text


def compare(before: Path, after: Path, tolerance: float, most: int) -> int:
    """Prints where two records differ; 1 if they do."""
    paths = {root: {path.relative_to(root) for path in root.rglob("*") if path.is_file()} for root in (before, after)}
    count = 0
    for path in sorted(paths[before] ^ paths[after]):
        print(f"{path}: only {'before' if path in paths[before] else 'after'}")
        count += 1
    same = paths[before] & paths[after]
    for path in sorted(same):
        found = list(differences(parsed(before / path), parsed(after / path), tolerance))
        count += bool(found)
        for line in found[:most]:
            print(f"{path}{line}")
        if len(found) > most:
            print(f"{path}: {len(found) - most} differences more")
    print(f"{count} of {len(same)} files differ")
    return bool(count)


def main() -> int:
    """Entry point."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    recording = verbs.add_parser("record", help="run every command and write down what it answers")
    recording.add_argument("out", type=Path)
    recording.add_argument("--shared", type=Path, default=SHARED, help="folder of the shared recordings")
    recording.add_argument("--only", default="*", help="names of jobs, e.g. 'cases/*'")
    recording.add_argument("--jobs", type=int, default=2, help="side by side")
    comparing = verbs.add_parser("compare", help="print where two records differ")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    comparing.add_argument("--tolerance", type=float, default=1e-9, help="relative, of numbers in files")
    comparing.add_argument("--most", type=int, default=8, help="differences to print of a file")
    options = parser.parse_args()
    if options.verb == "record":
        record(options.out.resolve(), options.shared.resolve(), options.only, options.jobs)
        return 0
    return compare(options.before, options.after, options.tolerance, options.most)


if __name__ == "__main__":
    raise SystemExit(main())
