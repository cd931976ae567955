"""The shared cases, simulated from their references and truth, against their recordings: other people's integrator."""

import csv
import gzip
import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

from bench.validation.independent.effects import (
    DirectionDependentFriction,
    ElasticCoupling,
    FrictionWarmup,
    LoadDependentFriction,
    LoadTorqueEvent,
    PreslidingFriction,
    QuadraticDrag,
    StribeckFriction,
    TorqueConstantSaturation,
    TorqueOffset,
    TorsionSpring,
    VelocityFilterLag,
    VoltageLimit,
)
from bench.validation.independent.rig import Axis
from bench.validation.independent.sensors import Sensors
from bench.validation.independent.simulate import simulate

SHARED = Path(__file__).parents[3] / "shared" / "cases"
SECONDS = 6.0

#: Effects whose parameters truth.json gives completely (no phase), with what it leaves out.
REPRODUCIBLE = {
    "stribeck_friction": StribeckFriction,
    "presliding_friction": PreslidingFriction,
    "quadratic_drag": QuadraticDrag,
    "load_dependent_friction": LoadDependentFriction,
    "direction_dependent_friction": lambda **p: DirectionDependentFriction(**p, viscous_share=0.64),
    "friction_warmup": lambda **p: FrictionWarmup(**p, viscous_share=1.0),
    "torque_offset": TorqueOffset,
    "torsion_spring": TorsionSpring,
    "load_torque_event": LoadTorqueEvent,
    "torque_constant_saturation": TorqueConstantSaturation,
    "voltage_limit": VoltageLimit,
    "velocity_filter_lag": VelocityFilterLag,
    "elastic_coupling": lambda resonance_frequency, stiffness: ElasticCoupling(stiffness, 0.005),
}

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not SHARED.exists(), reason="the shared cases are not here"),
]


class RecordedReference:
    """Motion as a recording holds it: speed reference between samples, its integral and its slope."""

    def __init__(self, time, velocity):
        self._time, self._velocity, self.duration = time, velocity, float(time[-1])
        self._position = np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2 * np.diff(time))])
        self._acceleration = np.gradient(velocity, time)

    def at(self, time):
        known = (self._position, self._velocity, self._acceleration)
        return np.stack([np.interp(time, self._time, values) for values in known])


def _axis(name, truth):
    rig = tomllib.loads((SHARED / name / "rig.toml").read_text())
    scale = {"kg*cm**2": 1e-4, "mH": 1e-3, "us": 1e-6}
    values = {key: text.split() for table in ("motor", "drive") for key, text in rig[table].items()}
    known = {key: float(value) * scale.get(unit, 1.0) for key, (value, unit) in values.items()}
    friction = {"viscous": truth["viscous_friction"], "coulomb": truth["coulomb_friction"]}
    return Axis(name=name, inertia=truth["inertia"], **friction, **known)


def _recording(name):
    with gzip.open(SHARED / name / "run1.csv.gz", "rt") as file:
        rows = list(csv.reader(file))
    columns = dict(zip((column.split(" [")[0] for column in rows[0]), np.array(rows[1:], dtype=float).T, strict=True))
    part = columns["time"] <= SECONDS * 1e3
    time, velocity = columns["time"][part] * 1e-3, np.radians(columns["velocity"][part])
    return time, velocity, columns["current"][part] * 1e-3, np.radians(columns["velocity_reference"][part])


def test_recordings_are_reproduced_within_half_a_percent_of_speed(capsys):
    truths = json.loads((SHARED / "truth.json").read_text())
    chosen = {
        name: truth
        for name, truth in truths.items()
        if truth["group"] == "null" or (truth["group"] == "single" and truth["effects"][0] in REPRODUCIBLE)
    }
    recordings = {name: _recording(name) for name in chosen}
    axes = [_axis(name, truth) for name, truth in chosen.items()]
    motions = [RecordedReference(time, reference) for time, _, _, reference in recordings.values()]
    effects = [
        [REPRODUCIBLE[key](**values) for key, values in truth["parameters"].items()] for truth in chosen.values()
    ]
    recorded = simulate(axes, motions, effects, [Sensors()] * len(axes))
    assert len(chosen) >= 10
    for (name, (_, velocity, current, _)), ours, truth in zip(
        recordings.items(), recorded, chosen.values(), strict=True
    ):
        count = min(velocity.size, len(ours.trace))
        speed_gap, current_gap = (
            float(np.sqrt(np.mean((theirs[:count] - ours.trace[signal][:count]) ** 2)) / np.abs(theirs).max())
            for theirs, signal in ((velocity, "velocity"), (current, "current"))
        )
        with capsys.disabled():
            print(f"\n{name} {truth['effects']}: speed within {speed_gap:.2%}, current within {current_gap:.2%} (RMS)")
        assert speed_gap < 5e-3, name
        assert current_gap < 2e-2, name
