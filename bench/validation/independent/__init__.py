"""The independent truth: axes integrated without MuJoCo and without anything of bench.plant.

Friction sticks and slips exactly (`plant.move`), everything else is second order at steps of 20 us or less. A
test that identifies or diagnoses takes its truth from here, so that a model never confirms itself.
"""

from bench.validation.independent.effects import CATALOGUE, KINDS, Effect
from bench.validation.independent.references import Motion, random_motion
from bench.validation.independent.rig import Axis, random_rig, write_rig
from bench.validation.independent.sensors import Noise, Sensors, random_sensors
from bench.validation.independent.simulate import Recorded, simulate

__all__ = [
    "CATALOGUE",
    "KINDS",
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
