"""Truth of a simulated trace, written beside it: what an identification of the trace should find."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bench.axis_kind import AxisKind
from bench.effects.present import Present
from bench.files import write_text
from bench.plant.model import AxisParameters, parameter_quantities
from bench.plant.sensors import Sensors
from bench.structured import json_text

SCHEMA = "bench.truth/1"


@dataclass(frozen=True)
class Truth:
    """What a trace was simulated from.

    Attributes:
        rig: name of the axis.
        parameters: of its equation of motion.
        friction: `mechanics`, or `drive` where the drive's software makes it.
        sensors: that recorded it.
        profile: name of the motion.
        seed: of the sensors' noise.
        effects: beyond the equation of motion.
    """

    rig: str
    parameters: AxisParameters
    friction: str
    sensors: Sensors
    profile: str
    seed: int
    effects: tuple[Present, ...] = ()

    def as_json(self) -> str:
        """Truth as text, quantities under the names that `bench identify --json` gives them."""
        kind = self.parameters.kind
        parameters = {
            q.name: (getattr(self.parameters, field), q.unit) for field, q in parameter_quantities(kind).items()
        }
        sensors = {
            "sample_period": (self.sensors.sample_period, "s"),
            "encoder_resolution": (self.sensors.encoder_resolution, kind.length_unit),
            "velocity_noise": (self.sensors.velocity_noise, kind.speed_unit),
            "current_noise": (self.sensors.current_noise, "A" if self.sensors.torque_constant else kind.effort_unit),
        }
        content = {
            "schema": SCHEMA,
            "rig": self.rig,
            "kind": kind.name,
            "profile": self.profile,
            "seed": self.seed,
            "friction": self.friction,
            "parameters": _with_units(parameters),
            "sensors": _with_units(sensors),
            "effects": [{"name": p.name, "parameters": _with_units(_parameters(p, kind))} for p in self.effects],
        }
        return json_text(content) + "\n"


def _parameters(present: Present, kind: AxisKind) -> dict[str, tuple[float, str]]:
    units = {quantity.name: kind.unit(quantity) for quantity in present.effect.quantities}
    return {key: (value, units[key]) for key, value in present.values}


def _with_units(values: dict[str, tuple[float, str]]) -> dict[str, dict[str, float | str]]:
    return {name: {"value": value, "unit": unit} for name, (value, unit) in values.items()}


def truth_path(trace: str | Path) -> Path:
    """Where the truth of a trace lies: `run.csv.gz` has `run.csv.gz.truth.json`."""
    return Path(f"{trace}.truth.json")


def write_truth(trace: str | Path, truth: Truth) -> Path:
    """Write the truth beside a trace, whole or not at all; returns its path.

    Raises:
        InputError: the folder cannot be written to.
    """
    path = truth_path(trace)
    write_text(path, truth.as_json())
    return path
