"""From a case to its files: simulated exactly and kept for the next run, then sampled, damaged and written anew."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, as_completed
from pathlib import Path

import numpy as np

from bench.validation.independent.rig import write_rig
from bench.validation.independent.sensors import Sensors
from bench.validation.independent.simulate import simulate
from tests.cases import parameters
from tests.kept import INTEGRATOR
from tests.studies.nuisance.draw import Case
from tests.studies.nuisance.signals import FINE, Signals, noisy, write_csv

#: Cases simulated together at most: more cost no less each.
TOGETHER = 60
#: Electronics without a fault, as often as the drive itself samples.
IDEAL = Sensors(sample_period=FINE, encoder_resolution=0.0)


def home() -> Path:
    """Folder of exact recordings; another one as soon as the integrator is changed."""
    digest = hashlib.sha256(repr(FINE).encode())
    for path in INTEGRATOR:
        digest.update(path.read_bytes())
    return Path(tempfile.gettempdir()) / f"nuisance-{digest.hexdigest()[:10]}"


def exact_file(folder: Path, case: Case) -> Path:
    """Where a case's exact recording is kept: by axis, effect and motion, whatever damages it afterwards."""
    time = FINE * np.arange(0, int(case.motion.duration / FINE), 7)
    digest = hashlib.sha256(repr((case.axis, case.effect)).encode() + case.motion.at(time).tobytes())
    return folder / f"{digest.hexdigest()[:20]}.npz"


def recorded(folder: Path, cases: Sequence[Case], pool: Executor) -> Iterator[int]:
    """Simulate what is not kept yet; yields how many cases are done, as they are."""
    missing = [case for case in cases if not exact_file(folder, case).exists()]
    yield len(cases) - len(missing)
    missing.sort(key=lambda case: case.motion.duration)
    tasks = [pool.submit(_simulate, folder, missing[k : k + TOGETHER]) for k in range(0, len(missing), TOGETHER)]
    for task in as_completed(tasks):
        yield task.result()


def _simulate(folder: Path, cases: Sequence[Case]) -> int:
    folder.mkdir(parents=True, exist_ok=True)
    axes, motions = [case.axis for case in cases], [case.motion for case in cases]
    runs = simulate(axes, motions, [case.effects for case in cases], [IDEAL] * len(cases))
    for case, run in zip(cases, runs, strict=True):
        path = exact_file(folder, case)
        part = path.with_suffix(f".{os.getpid()}.npz")
        np.savez(part, allow_pickle=False, time=run.trace.time, **run.trace.signals)
        part.replace(path)
    return len(cases)


def damaged(folder: Path, case: Case) -> Signals:
    """What the recorder writes of a case."""
    with np.load(exact_file(folder, case)) as kept:
        columns = {name: kept[name] for name in kept.files}
    fine = Signals(columns.pop("time"), columns)
    if not case.references:
        fine = fine.without("position_reference", "velocity_reference")
    noise, damage = (np.random.default_rng(seed) for seed in np.random.SeedSequence(case.seed).spawn(2))
    seen = case.kind.exact(fine, case.strength, case.axis, damage)
    taken = noisy(case.kind.sampled(seen, case.strength, damage), case.axis, noise)
    return case.kind.in_file(taken, case.strength, case.axis, damage)


def write_case(folder: Path, case: Case) -> Path:
    """Files of a case as a user has them, and its truth beside them; their folder."""
    place = folder / "cases" / case.name
    place.mkdir(parents=True, exist_ok=True)
    write_csv(damaged(folder, case), place / "run.csv.gz")
    rig = place / "rig.toml"
    write_rig(case.kind.known(case.axis, case.strength), rig)
    rig.write_text(case.kind.rig_text(rig.read_text("utf-8"), case.axis, case.strength), encoding="utf-8")
    truth = {"inertia": case.axis.inertia, "viscous": case.axis.viscous, "coulomb": case.axis.coulomb}
    truth |= {effect.name: parameters(effect, case.axis) for effect in case.effects}
    (place / "truth.json").write_text(json.dumps(truth, indent=1), encoding="utf-8")
    return place
