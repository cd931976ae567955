"""Cases on disk, as other people's are laid out: rig.toml, run1.csv.gz, run2.csv.gz, and truth.json beside them all."""

from __future__ import annotations

import gzip
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from scipy.ndimage import gaussian_filter1d

from bench.validation.independent.effects import KINDS, Effect, ElasticCoupling
from bench.validation.independent.references import random_motion
from bench.validation.independent.rig import Axis, random_rig, write_rig
from bench.validation.independent.sensors import Sensors, random_sensors
from bench.validation.independent.simulate import LONGEST_STEP, Recorded, simulate
from tests.outside import OUTSIDE

#: Decimals of a column: finer than any sensor here, so that a file does not round what the sensor did not.
DECIMALS = {"time": 4, "position": 5, "velocity": 4, "current": 3, "position_reference": 5, "velocity_reference": 4}


@dataclass(frozen=True)
class Hidden:
    """An axis with what is hidden in it, to be recorded twice.

    Attributes:
        group: null, single, pair, triple or outside.
        severity: as drawn; 0.02 for null, as the shared cases say it.
    """

    name: str
    axis: Axis
    effects: tuple[Effect, ...]
    sensors: Sensors
    group: str
    severity: float
    duration: float


def record(
    cases: Sequence[Hidden],
    seed: int = 0,
    *,
    numbers: Sequence[int] | None = None,
    longest_step: float = LONGEST_STEP,
) -> list[tuple[Recorded, Recorded]]:
    """Two recordings a case, of different motions; all simulated together.

    Motion and noise are drawn from `seed` and the case's number, which is its place if not given.
    """
    places = [2 * number + run for number in (range(len(cases)) if numbers is None else numbers) for run in range(2)]
    twice = [case for case in cases for _ in range(2)]
    motions = [
        random_motion(case.axis, np.random.default_rng([seed, place, 2]), case.duration * (0.8 if place % 2 else 1.0))
        for place, case in zip(places, twice, strict=True)
    ]
    recorded = simulate(
        [case.axis for case in twice],
        motions,
        [case.effects for case in twice],
        [case.sensors for case in twice],
        seed,
        numbers=places,
        longest_step=longest_step,
    )
    return list(zip(recorded[::2], recorded[1::2], strict=True))


def truth(case: Hidden, recorded: Recorded) -> dict[str, object]:
    """Entry of a case in truth.json."""
    axis = case.axis
    return {
        "effects": [effect.name for effect in case.effects],
        "group": case.group,
        "severity": round(case.severity, 3),
        "parameters": {effect.name: parameters(effect, axis) for effect in case.effects},
        "inertia": axis.inertia,
        "viscous_friction": axis.viscous,
        "coulomb_friction": axis.coulomb,
        "residual_ratio": round(residual_ratio(recorded), 2),
        "columns": ["time", *recorded.trace.signals],
    }


def parameters(effect: Effect, axis: Axis) -> dict[str, float]:
    """Parameters of an effect as truth.json names them."""
    values = {key: float(value) for key, value in asdict(effect).items()}
    if isinstance(effect, ElasticCoupling):
        reduced = axis.rotor_inertia * (axis.inertia - axis.rotor_inertia) / axis.inertia
        values = {"resonance_frequency": float(np.sqrt(effect.stiffness / reduced) / (2.0 * np.pi)), **values}
    return values


def residual_ratio(recorded: Recorded) -> float:
    """RMS of what J, K_w, K_0 leave of the torque, over that of what the sensors' noise alone makes of it."""
    trace, axis, true = recorded.trace, recorded.axis, recorded.true
    period = trace.sample_period

    def smooth(values: np.ndarray, order: int = 0) -> np.ndarray:
        return gaussian_filter1d(values, 2e-3 / period + 0.5, order=order) / period**order

    def columns(speed: np.ndarray) -> np.ndarray:
        return np.column_stack([smooth(speed, 1), smooth(speed), smooth(np.sign(true["velocity"]))])

    moving = np.abs(true["velocity"]) > 0.005 * axis.top_speed
    reach = int(10e-3 / period) + 1
    sure = np.convolve(~moving, np.ones(2 * reach + 1), "same") < 0.5
    regressors = columns(trace["velocity"])
    torque = smooth(axis.torque_constant * trace["current"])
    found = np.linalg.lstsq(regressors[sure], torque[sure], rcond=None)[0]
    gap = torque - regressors @ found
    hiss = axis.torque_constant * smooth(trace["current"] - true["current"])
    noise = hiss - columns(trace["velocity"] - true["measured_velocity"])[:, :2] @ [axis.inertia, axis.viscous]
    return float(np.sqrt(np.mean(gap[sure] ** 2) / np.mean(noise[sure] ** 2)))


def write_case(folder: str | Path, case: Hidden, runs: tuple[Recorded, Recorded]) -> dict[str, object]:
    """Write a case's own folder below `folder` and return its entry for truth.json."""
    home = Path(folder) / case.name
    home.mkdir(parents=True, exist_ok=True)
    write_rig(case.axis, home / "rig.toml")
    for name, run in zip(("run1", "run2"), runs, strict=True):
        write_csv(run, home / f"{name}.csv.gz")
    return truth(case, runs[0])


def write_csv(recorded: Recorded, path: str | Path) -> None:
    """Canonical CSV in ms, deg (mm), mA."""
    trace = recorded.trace
    angle, scale = ("mm", 1e3) if recorded.axis.linear else ("deg", float(np.degrees(1.0)))
    columns, header = [trace.time * 1e3], ["time [ms]"]
    for name, values in trace.signals.items():
        unit, factor = ("mA", 1e3) if name == "current" else (angle + "/s" * name.startswith("velocity"), scale)
        columns.append(values * factor)
        header.append(f"{name} [{unit}]")
    with gzip.open(path, "wt", encoding="utf-8", compresslevel=6) as file:
        formats = [f"%.{DECIMALS[name]}f" for name in ("time", *trace.signals)]
        np.savetxt(file, np.column_stack(columns), fmt=formats, delimiter=",", header=",".join(header), comments="")


GROUPS = {0: "null", 1: "single", 2: "pair", 3: "triple"}


def hidden(
    name: str,
    effects: tuple[str, ...],
    severity: tuple[float, float],
    rng: np.random.Generator,
    *,
    duration: float = 8.0,
    noise: float = 1.0,
    linear: bool = False,
) -> Hidden:
    """A case that hides the named effects, with a severity drawn from a range; everything else at random."""
    axis = random_rig(rng, name, linear=linear)
    strength = float(rng.uniform(*severity)) if effects else 0.02
    sensors = random_sensors(axis, rng, noise)
    drawn = tuple((KINDS | OUTSIDE)[effect].draw(axis, strength, rng, duration) for effect in effects)
    outside = any(effect in OUTSIDE for effect in effects)
    return Hidden(
        name, axis, drawn, sensors, "outside" if outside else GROUPS.get(len(effects), "crowd"), strength, duration
    )
