"""How well a drive tracks a motion with and without what it is told of the axis: by simulation of the model."""

from __future__ import annotations

from dataclasses import dataclass, replace

from bench.arrays import rms
from bench.export.feedforward import Feedforward
from bench.plant.axis_model import AxisModel
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.plant.references import References
from bench.plant.run import run
from bench.rig.rig import Rig


@dataclass(frozen=True)
class Tracking:
    """Errors of a drive along a motion, RMS: reference less motion.

    Attributes:
        position: rad (m).
        velocity: rad/s (m/s).
    """

    position: float
    velocity: float


def tracking(model: AxisModel, rig: Rig, references: References, feedforward: Feedforward | None = None) -> Tracking:
    """Errors of a rig's drive on an axis.

    Args:
        model: of the axis, with effects.
        rig: with `[drive]`.
        references: the motion, at the drive's ticks.
        told: what the drive feeds forward; None: what its rig file says.

    Raises:
        InputError: a rig without drive.
        SimulationError: the simulation diverged.
    """
    cascade = Cascade.from_rig(rig)
    motion = references
    if feedforward is not None:
        cascade, motion = replace(cascade, inertia_feedforward=feedforward.inertia), feedforward.along(references)
    plant = Plant.of(model, cascade)
    states = run([plant], [motion])
    return Tracking(rms(references.position - states.position[:, 0]), rms(references.velocity - states.velocity[:, 0]))
