"""Recordings that nothing is wrong with, by anyone's sensors: no check may fail on any of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bench.rig.rig import Rig, load_rig
from bench.trace.read import read
from bench.trace.trace import Trace
from bench.validation.independent.effects import any_effects
from bench.validation.independent.rig import write_rig
from tests.cases import hidden, record
from tests.diagnosis.public_axes import EMPS, LAAS, XL330, emps
from tests.recorded import STEP
from tests.shared import SHARED

#: Their own README says that their speed column has a wrong scale.
WRONG_SPEED = ("damiao_m4", "go1_1kg")

Recording = tuple[str, Trace, Rig]


def shared_cases() -> Iterator[Recording]:
    """First runs of the shared cases, each with or without an effect."""
    for folder in sorted((SHARED / "cases").glob("case-*")):
        rig = load_rig(folder / "rig.toml")
        yield folder.name, read(folder / "run1.csv.gz", rig.trace.columns), rig


def real(wrong: bool = False) -> Iterator[Recording]:
    """Real recordings of `data/real`: those whose speed is that of their position, or those where it is not."""
    for folder in sorted(path for path in (SHARED / "data/real").iterdir() if path.is_dir()):
        if (folder.name in WRONG_SPEED) == wrong:
            rig = load_rig(folder / "rig.toml")
            for path in sorted(folder.glob("*.csv.gz")):
                yield f"{folder.name}/{path.name}", read(path, rig.trace.columns), rig


def public() -> Iterator[Recording]:
    """EMPS, LAAS and XL330 as published."""
    yield from ((name, emps(name), EMPS) for name in ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat"))
    data = SHARED / "data"
    columns = LAAS.trace.columns
    yield "speed_test1.txt", read(data / "laas_anticogging/speed_test1.txt", columns), LAAS
    columns = {name: column for name, column in columns.items() if "reference" not in name}
    yield "acc_current.txt", read(data / "laas_anticogging/acc_current.txt", columns), LAAS
    yield from ((path.name, read(path), XL330) for path in sorted((data / "bam_xl330").glob("*.json")))


def independent(count: int, folder, duration: float = 4.0) -> Iterator[Recording]:
    """Axes drawn at random with none to three effects each, by the independent integrator."""
    rngs = [np.random.default_rng([77, k]) for k in range(count)]
    cases = [
        hidden(
            f"drawn {k}", any_effects(k % 4, rng, linear=k % 5 == 0), (0.5, 1.5), rng, duration=duration,
            linear=k % 5 == 0,
        )
        for k, rng in enumerate(rngs)
    ]  # fmt: skip
    for case, (run, _) in zip(cases, record(cases, seed=5, longest_step=STEP), strict=True):
        write_rig(case.axis, folder / "rig.toml")
        yield (
            f"{case.name} {' '.join(effect.name for effect in case.effects)}",
            run.trace,
            load_rig(folder / "rig.toml"),
        )
