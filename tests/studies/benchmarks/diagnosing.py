"""CPU time of a diagnosis in process: of public axes, where much is left, and of simulated ones."""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.assets import asset
from bench.diagnosis.diagnosis import diagnose
from bench.rig.rig import load_rig
from bench.trace.read import read
from tests.public import DATA
from tests.shared import SHARED
from tests.studies.benchmarks.table import Table

#: Recording, holdout or "", and rig; several of an axis or of a kind are one row.
Files = tuple[Path, Path | str, Path]


def public() -> dict[str, list[Files]]:
    """Public axes beside the project."""
    damiao = DATA / "real/damiao_m1"
    return {
        "EMPS": [(DATA / "emps/DATA_EMPS.mat", "", asset("data", "rigs", "emps.toml"))],
        "LAAS": [(DATA / "laas_anticogging/speed_test1.txt", "", asset("data", "rigs", "laas.toml"))],
        "Damiao 1": [(path, "", damiao / "rig.toml") for path in sorted(damiao.glob("r?.csv.gz"))],
        "BAM XL330": [(DATA / "bam_xl330/2026-01-15_10h28m32.json", "", asset("data", "rigs", "bam_xl330.toml"))],
    }


def simulated() -> dict[str, list[Files]]:
    """The shared cases, by what is hidden in them."""
    truth = json.loads((SHARED / "cases" / "truth.json").read_text(encoding="utf-8"))
    found: dict[str, list[Files]] = {}
    for name, case in sorted(truth.items()):
        folder = SHARED / "cases" / name
        files = folder / "run1.csv.gz", folder / "run2.csv.gz", folder / "rig.toml"
        found.setdefault(f"simulated, {case['group']}", []).append(files)
    return found


def measured(recordings: Mapping[str, Sequence[Files]] | None = None, rounds: int = 1) -> list[Table]:
    """Time of each; all of the shared ones if none are given."""
    chosen = {**public(), **simulated()} if recordings is None else recordings
    rows = [_row(name, [_seconds(files, rounds) for files in several]) for name, several in chosen.items()]
    says = (
        "CPU time of `bench.diagnose` in process, all threads together, on one machine that did other work at the same "
        "time; simulated ones with a holdout, as `../shared/cases` has them. Of several recordings the mean and "
        "the longest."
    )
    return [Table(says, ("axis", "recordings", "mean", "longest"), tuple(rows))]


def _row(name: str, seconds: Sequence[float]) -> tuple[str, ...]:
    return name, str(len(seconds)), f"{statistics.mean(seconds):.2f} s", f"{max(seconds):.2f} s"


def _seconds(files: Files, rounds: int) -> float:
    """Median CPU time - s."""
    recording, other, path = files
    rig = load_rig(path)
    trace, holdout = read(recording, rig.trace), read(other, rig.trace) if other else None
    taken = []
    for _ in range(rounds):
        began = time.process_time()
        diagnose(trace, rig, holdout)
        taken.append(time.process_time() - began)
    return statistics.median(taken)
