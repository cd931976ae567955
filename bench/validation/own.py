"""One's own axis: its rig, its motion and its sensors, so that only noise is drawn."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.errors import InputError
from bench.fit.identify import identify
from bench.plant.axis_model import AxisParameters, winding_of
from bench.plant.drive import Cascade
from bench.plant.profiles import MotionLimits, plan
from bench.plant.sampled import Sampled, motion_of
from bench.rig.rig import Rig, Simulation, require
from bench.trace.noise import resolution, white_noise
from bench.trace.trace import Trace
from bench.validation.independent.references import Motion
from bench.validation.independent.rig import Axis
from bench.validation.independent.sensors import Noise, Sensors
from bench.validation.plan import PLANTS, Case, Plant

#: Signals that tell what moved an axis.
EFFORTS = {"current", "torque", "force"}


@dataclass(frozen=True)
class OwnAxis:
    """The same axis in every run; noise and the age of the current are drawn.

    Attributes:
        rig: of the axis.
        axis: its true values.
        motion, motion_name: that its drive is told to make.
        sensors: that record it.
        plants: that can move it.
    """

    rig: Rig
    axis: Axis
    motion: Motion
    motion_name: str
    sensors: Sensors
    plants: tuple[Plant, ...]

    def __call__(self, index: int, rng: np.random.Generator) -> Case:
        """A case of it, as of any population."""
        plant = self.plants[int(rng.integers(len(self.plants)))]
        sensors = replace(self.sensors, current_age=int(rng.integers(2)))
        return Case(index, plant, self.axis, self.rig, self.motion, self.motion_name, sensors)


def own_axis(rig: Rig, profile: str, recording: Trace | None) -> OwnAxis:
    """The axis of a rig along a motion of its own.

    What the rig does not say of the simulated axis and its sensors, in `[simulation]`, is taken from the recording.

    Args:
        rig: with `[drive]`; InputError where it or the recording lack something.
        profile: name of a motion (`bench.plant.profiles`), or what the recording is called.
        recording: of the motion; None to take the named one. UndeterminedError where it does not tell what it has to.
    """
    if rig.load is not None and rig.load.eccentric_mass is not None:
        raise InputError(f"{rig.source}: load.eccentric_mass", "found one", "allowed: none; the plants do not swing it")
    if rig.simulation is None and recording is not None and EFFORTS & set(recording.signals):
        rig = rig.model_copy(update={"simulation": as_recorded(rig, recording)})
    require(rig, "validate")
    parameters, cascade = AxisParameters.from_rig(rig), Cascade.from_rig(rig)
    if recording is None:
        references = plan(profile, MotionLimits.from_rig(rig, parameters, cascade.control_period))
        motion = Sampled(references.time, references.velocity)
    else:
        motion = motion_of(recording)
    constant, simulation, period = rig.motor.torque_per_ampere, rig.simulated, cascade.control_period
    assert constant is not None  # `require` has seen to it
    sensors = Sensors(
        sample_period=max(1, round(simulation.sample_period / period)) * period,
        encoder_resolution=simulation.encoder_resolution,
        velocity=Noise(white=simulation.velocity_noise, resolution=_step(recording, "velocity")),
        current=Noise(white=simulation.current_noise, resolution=_step(recording, "current")),
        position_recorded=recording is None or "position" in recording,
    )
    # the independent plant has a motor that does not saturate, and no load torque
    plain = simulation.friction == "mechanics" and not simulation.load_torque and not constant.curvature
    axis = _axis(rig, parameters, cascade, motion.top)
    return OwnAxis(rig, axis, Motion((motion,)), profile, sensors, PLANTS if plain else ("mujoco",))


def as_recorded(rig: Rig, recording: Trace) -> Simulation:
    """Inertia and friction of an axis as a recording tells them; UndeterminedError where it does not."""
    found = identify(recording, rig)
    inertia, viscous, coulomb = (found[rig.axis_kind.parameter(term)].value for term in (INERTIA, VISCOUS, COULOMB))
    values = {
        rig.axis_kind.inertia: inertia,
        "viscous_friction_coefficient": max(viscous, 0.0),
        "coulomb_friction": max(coulomb, 0.0),
        "sample_period": recording.sample_period,
        "encoder_resolution": _step(recording, "position"),
        "velocity_noise": white_noise(recording["velocity"]) if "velocity" in recording else 0.0,
        "current_noise": white_noise(recording["current"]) if "current" in recording else 0.0,
    }
    return Simulation().model_copy(update=values)


def _step(recording: Trace | None, name: str) -> float:
    return resolution(recording[name]) if recording is not None and name in recording else 0.0


def _axis(rig: Rig, parameters: AxisParameters, cascade: Cascade, top_speed: float) -> Axis:
    constant, drive, winding = rig.motor.torque_per_ampere, rig.drive, winding_of(rig)
    assert constant is not None and drive is not None  # `require` has seen to it
    axis = Axis(
        name=rig.name,
        inertia=parameters.inertia,
        viscous=parameters.viscous_friction_coefficient,
        coulomb=parameters.coulomb_friction,
        rotor_inertia=parameters.motor_inertia,
        torque_constant=constant.constant,
        peak_current=float(cascade.torque_limit) / constant.constant,
        position_gain=drive.position_gain,
        velocity_gain=drive.velocity_gain,
        integral_gain=drive.integral_gain,
        inertia_feedforward=drive.inertia_feedforward,
        control_period=cascade.control_period,
        top_speed=top_speed,
        linear=not rig.axis_kind.turns,
    )
    if winding is None:
        return replace(axis, back_emf_constant=0.0)
    known = {name: getattr(winding, name) for name in ("resistance", "inductance", "back_emf_constant")}
    return replace(axis, **known)
