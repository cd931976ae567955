"""Beside what an identification took before it had a gate, five cut-offs and hints: a commit of this repository."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tarfile
import tempfile
from io import BytesIO
from pathlib import Path

import numpy as np

from tests.fit.motions import recording
from tests.hostile import ROOT
from tests.studies.benchmarks.table import Table

#: The commit, and for it and for today where `identify` and a rig of the same axis are.
BEFORE = "853f307"
MODULES = {
    BEFORE: ("bench.identify.regression", "tests.identify.motions"),
    "today": ("bench.fit.identify", "tests.fit.motions"),
}
#: Identifies once for every line it reads, and answers with the CPU time - s -; ten times before that.
WORKER = """
import importlib, sys, time
import numpy as np
from bench.trace.trace import Trace
identify, rig = (getattr(importlib.import_module(m), n) for m, n in zip(sys.argv[2:], ("identify", "RIG")))
held = np.load(sys.argv[1])
for turn in range(-10, int(held["turns"])):
    if turn >= 0:
        sys.stdin.readline()
    signals = {name: held[name].copy() for name in ("velocity", "current")}
    trace = Trace(held["time"], signals, {"velocity": "rad/s", "current": "A"}, "closed form")
    began = time.process_time()
    identify(trace, rig)
    if turn >= 0:
        print(time.process_time() - began, flush=True)
"""


def measured(duration: float = 10.0, turns: int = 200) -> list[Table]:
    """A recording at 1 kHz - s -, identified in turn by a process of each version."""
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.run(["git", "archive", BEFORE], cwd=ROOT, capture_output=True, check=True).stdout
        with tarfile.open(fileobj=BytesIO(archive)) as files:
            files.extractall(Path(folder, "before"), filter="data")
        trace, path = recording(np.random.default_rng(0), duration=duration), Path(folder, "recording.npz")
        np.savez(path, time=trace.time, velocity=trace["velocity"], current=trace["current"], turns=turns)
        roots = {BEFORE: Path(folder, "before"), "today": ROOT}
        workers = {name: _worker(roots[name], path, MODULES[name]) for name in MODULES}
        seconds: dict[str, list[float]] = {name: [] for name in workers}
        for _ in range(turns):
            for name, worker in workers.items():
                seconds[name].append(_turn(worker))
        for worker in workers.values():
            worker.communicate()
    ratio = statistics.median(now / then for then, now in zip(*seconds.values(), strict=True))
    rows = [(name, f"{1e3 * statistics.median(taken):.3g} ms") for name, taken in seconds.items()]
    says = (
        f"CPU time of `identify` of {duration:g} s at 1 kHz in memory, in one process of each version, in turn. "
        f"{BEFORE} filters once, checks nothing and hints at nothing."
    )
    return [Table(says, ("version", "time"), (*rows, ("ratio", f"{ratio:.2f}")))]


def _worker(root: Path, path: Path, modules: tuple[str, str]) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": str(root), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [sys.executable, "-c", WORKER, str(path), *modules]
    return subprocess.Popen(
        command, cwd=root, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )


def _turn(worker: subprocess.Popen[str]) -> float:
    """CPU time of one identification - s."""
    assert worker.stdin is not None
    assert worker.stdout is not None
    worker.stdin.write("\n")
    worker.stdin.flush()
    return float(worker.stdout.readline())
