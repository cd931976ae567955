"""Motions in closed form to be shown, the model a little ahead of its ghost; and models of given values."""

import numpy as np

from bench.axis_kind import ROTARY
from bench.effects.present import Present
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.model_file import StoredModel, model_toml
from bench.view.side_by_side import SideBySide

AHEAD, SPEED = 0.02, 3.0
#: Of a model's file, which has one; none of the motion.
BALANCE = '[torque_balance]\nrecording = "closed form"\nfilter_width = 1e-3\ncoefficients = [1.5e-3, 8e-4, 0.06, 0.0]\n'


def shown(kind=ROTARY, ghost_is="measured", duration=2.0, period=1e-3, hole=None):
    """A constant speed, the model ahead; no sample lies in the hole, from one time to another."""
    time = period * np.arange(round(duration / period) + 1)
    if hole is not None:
        time = time[(time < hole[0]) | (time > hole[1])]
    speed = np.full(time.size, SPEED)
    return SideBySide(kind, ghost_is, "It turns.", time, SPEED * time, SPEED * time + AHEAD, speed, speed)


def model_file(path, values, **effects):
    """A model's file: inertia, viscous and Coulomb friction, and the parameters of effects by their names."""
    present = tuple(Present.of(name, parameters) for name, parameters in effects.items())
    text = model_toml(StoredModel("axis", AxisModel(AxisParameters(*values), present)))
    path.write_text(f"{text}\n{BALANCE}", encoding="utf-8")
    return path
