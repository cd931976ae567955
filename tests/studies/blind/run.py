"""Diagnose a case as a user would: from its files, and with nothing of the truth."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from pathlib import Path

from bench.diagnosis.diagnosis import Diagnosis, diagnose
from bench.errors import BenchError
from bench.rig.rig import load_rig
from bench.trace.read import read

Interval = tuple[float, float, float]


@dataclass(frozen=True)
class Outcome:
    """What the diagnosis said of a case.

    Attributes:
        named: effects in the order they were added, with value and 95 % interval of each quantity - SI.
        chi: gap over noise floor of the first recording, before and after.
        holdout: torque gap of the second recording, before and after, and the noise floor - N*m (N).
        inertia: kg*m**2 (kg).
        steps: effect added, and gap over noise floor then.
        likely: probability of every name that was considered.
        none: that none of the catalogue is it.
        sets: of names that hold the truth with 90 %; None: none of the catalogue.
        refused: why there is no diagnosis, empty if there is one.
    """

    verdict: str = ""
    named: dict[str, dict[str, Interval]] = field(default_factory=dict)
    chi: tuple[float, float] = (float("nan"), float("nan"))
    holdout: Interval | None = None
    inertia: float = float("nan")
    steps: tuple[tuple[str, float], ...] = ()
    likely: dict[str, float] = field(default_factory=dict)
    none: float = float("nan")
    sets: tuple[frozenset[str] | None, ...] = ()
    seconds: float = 0.0
    refused: str = ""


def diagnosis_of(folder: Path, excluded: frozenset[str]) -> Diagnosis:
    """Diagnosis from run1, run2 and rig.toml of a folder."""
    rig = load_rig(folder / "rig.toml")
    first, second = (read(folder / f"{run}.csv.gz", rig.trace.columns) for run in ("run1", "run2"))
    return diagnose(first, rig, second, excluded)


def outcome(folder: Path, excluded: frozenset[str] = frozenset()) -> Outcome:
    """Diagnose a folder's recordings; refusals are an outcome too."""
    start = time.perf_counter()
    try:
        found = diagnosis_of(folder, excluded)
    except BenchError as refusal:
        return Outcome(seconds=time.perf_counter() - start, refused=" ".join(str(refusal).split()))
    seconds = time.perf_counter() - start
    torque = found.torque
    inertia = [found.parameters[key] for key in ("moment_of_inertia", "moving_mass") if key in found.parameters]
    return Outcome(
        found.verdict,
        {effect.name: {key: (p.value, *p.ci95) for key, p in effect.parameters.items()} for effect in found.effects},
        tuple(gap / torque.noise_floor for gap in torque.identify) if torque.identify else (float("nan"),) * 2,
        (*torque.holdout, torque.noise_floor) if torque.holdout else None,
        inertia[0].value if inertia else float("nan"),
        tuple((step.effect, step.torque[0] / torque.noise_floor) for step in found.steps),
        found.probabilities.names,
        found.probabilities.none,
        tuple(found.probabilities.holding(0.9)),
        seconds,
    )
