"""The independent truth: axes integrated without MuJoCo and without anything of bench.plant.

Friction sticks and slips exactly (`stick_slip`), everything else is second order at steps of 20 us or less (`plant`). A
test that identifies or diagnoses takes its truth from here, so that a model never confirms itself.
"""

from bench.validate.independent.effects import CATALOGUE, KINDS, OUTSIDE, Effect
from bench.validate.independent.references import Motion, random_motion
from bench.validate.independent.rig import Axis, random_rig, write_rig
from bench.validate.independent.sensors import Noise, Sensors, random_sensors
from bench.validate.independent.simulate import Recorded, simulate

__all__ = [
    "CATALOGUE",
    "KINDS",
    "OUTSIDE",
    "Axis",
    "Effect",
    "Motion",
    "Noise",
    "Recorded",
    "Sensors",
    "random_motion",
    "random_rig",
    "random_sensors",
    "simulate",
    "write_rig",
]
