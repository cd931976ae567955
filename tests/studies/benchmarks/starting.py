"""CPU time of whole processes, their start included, in turn with those of an earlier commit of this repository."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path

from bench.assets import asset
from bench.plant.simulate import simulate
from bench.rig.rig import load_rig
from bench.trace.write import write
from tests.hostile import ROOT
from tests.studies.benchmarks.table import Table

#: The commit before commands loaded less and figures were drawn once.
BEFORE = "faac8317"
#: Length of the recordings - s -, and the effect of one of them.
DURATION = 10.0
EFFECT = {"cogging_torque": {"amplitude": 0.03, "harmonic": 12.0, "phase": 0.0}}


def measured(duration: float = DURATION, rounds: int = 3, before: Path | None = None) -> list[Table]:
    """Each process as often; `before`: root of the earlier commit's files, which are taken from git otherwise."""
    with tempfile.TemporaryDirectory() as folder:
        roots = {BEFORE: before or _archived(Path(folder, "before")), "today": ROOT}
        rows = []
        for name, command in _commands(Path(folder), duration).items():
            taken: dict[str, list[float]] = {version: [] for version in roots}
            for turn in range(rounds + 1):  # the first, which compiles, is not counted
                for version, root in roots.items():
                    seconds = _seconds(command, root, Path(folder))
                    taken[version] += [seconds] if turn else []
            then, now = taken.values()
            ratio = statistics.median(b / a for a, b in zip(then, now, strict=True))
            rows.append((name, f"{statistics.median(then):.2f} s", f"{statistics.median(now):.2f} s", f"{ratio:.2f}"))
    says = (
        f"CPU time of a process from its start to its end, of {BEFORE} and today in turn; recordings of {duration:g} s "
        "at 1 kHz as CSV."
    )
    return [Table(says, ("process", BEFORE, "today", "ratio"), tuple(rows))]


def _commands(folder: Path, duration: float) -> Mapping[str, Sequence[str]]:
    """Arguments of Python by what they do."""
    rig = load_rig(asset("data", "rigs", "sh30701p.toml"))
    for name, effects in {"null": {}, "single": EFFECT}.items():
        trace = simulate(rig, effects=effects).trace
        write(trace.between(0.0, duration), folder / f"{name}.csv")

    def diagnosed(name: str, *more: str) -> Sequence[str]:
        return ("-m", "bench", "diagnose", f"{name}.csv", "--rig", "sh30701p", *more)

    return {
        "import bench; bench.identify": ("-c", "import bench; bench.identify"),
        "bench diagnose, nothing missing": diagnosed("null"),
        "bench diagnose, cogging torque": diagnosed("single"),
        "bench diagnose --out, nothing missing": diagnosed("null", "--out", "found"),
    }


def _archived(folder: Path) -> Path:
    archive = subprocess.run(["git", "archive", BEFORE], cwd=ROOT, capture_output=True, check=True).stdout
    with tarfile.open(fileobj=BytesIO(archive)) as files:
        files.extractall(folder, filter="data")
    return folder


def _seconds(command: Sequence[str], root: Path, folder: Path) -> float:
    """User and system time of a process - s."""
    own = {"PYTHONPATH": str(root), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    own["PYTHONPYCACHEPREFIX"] = str(folder / "compiled")  # where nothing may be written beside the sources, too
    kept = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    before = os.times()
    subprocess.run([sys.executable, *command], cwd=folder, env={**kept, **own}, capture_output=True, check=True)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system
