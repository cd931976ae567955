"""How effects act on a simulated axis, by where: in its MJCF, on its mechanics, in drive and motor, in the sensors.

Methods take values and states as numbers, or as arrays of k axes (k,).
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, TypeAlias

import numpy as np

from bench.arrays import Array
from bench.effects.effect import Columns, Effect, lagged, unlagged
from bench.effects.signals import Axis, Moment, Number, Scope, Signals, Values
from bench.rig.rig import Rig
from bench.trace.trace import Trace

if TYPE_CHECKING:  # 0.2 s, needed only to simulate
    import mujoco

# Of the mechanics.


class Mechanism(Effect):
    """It acts on the mechanics."""


class Native(Mechanism):
    """MuJoCo simulates it by itself, as part of the model."""

    @abstractmethod
    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Add the effect to the model; `name` is free to name the new elements."""

    def native(self, values: Mapping[str, float], friction_scaled: bool) -> bool:
        """Whether it does with these values; `friction_scaled`: another effect changes friction in every step."""
        return True


class ResistingTorque(Mechanism):
    """It resists in every step."""

    @abstractmethod
    def resisting_torque(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Torque against the motor's - N*m (N)."""


class LoadTorque(Columns, Mechanism):
    """A torque of the load, which the transmission carries."""

    @abstractmethod
    def load_torque(self, values: Values, at: Moment) -> Number:
        """Resisting torque of the load - N*m (N)."""


class ConstantTorque(LoadTorque):
    """A torque that never varies, its strength: in motion of one direction it looks like dry friction."""


class Spring(LoadTorque):
    """A torque that pulls back to a position; its first strength is the stiffness - N*m/rad (N/m), then a constant."""


class ScalesTorque(Mechanism):
    """It takes a share of the motor's torque."""

    @abstractmethod
    def torque_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Factor on the motor's torque - dimensionless."""


class VaryingInertia(Mechanism):
    """Inertia that is not constant."""

    @abstractmethod
    def added_inertia(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Additional inertia - kg*m**2 (kg)."""


class Friction(Mechanism):
    """It changes dry friction."""

    def sought(self, scope: Scope) -> bool:
        """Not in motion of one direction, where such friction looks like a torque, e.g. like an unbalance."""
        return super().sought(scope) and not scope.one_way


class FrictionLevel(Friction, Columns):
    """It changes the level of dry friction, which others may scale.

    Attributes:
        dry: which of its columns are dry friction.
    """

    dry: ClassVar[slice] = slice(None)

    def level(self, signals: Signals, shape: Sequence[float], strengths: Sequence[float]) -> Array:
        """Signed dry friction in addition to Coulomb friction, at these strengths - the strengths' unit - (n,)."""
        columns = self.columns(signals, shape)[self.dry]
        parts = [strength * values for strength, ((values, _),) in zip(strengths[self.dry], columns, strict=True)]
        return np.sum(parts, axis=0)


@dataclass(frozen=True)
class FrictionLaw:
    """Dry friction in the words that other simulators have, which is added to Coulomb friction.

        K = rise*exp(-(|omega|/velocity)**exponent) + |motor*M_motor - external*M_external|

    Source: M. Duclusaud et al., Extended Friction Models for the Physics Simulation of Servo Actuators, 2024 (M2, M5).

    Attributes:
        rise: towards standstill - N*m (N).
        velocity: at which it has fallen to 1/e - rad/s (m/s).
        exponent: dimensionless.
        motor, external: shares of the motor's torque, and of what acts on the joint from outside - dimensionless.
    """

    rise: float = 0.0
    velocity: float = math.inf
    exponent: float = 2.0
    motor: float = 0.0
    external: float = 0.0


class RaisesFriction(FrictionLevel):
    """Dry friction in addition to Coulomb friction."""

    @abstractmethod
    def friction_excess(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Additional dry friction - N*m (N)."""

    def law(self, values: Mapping[str, float], axis: Axis) -> FrictionLaw | None:
        """The same in the words of other simulators; None where they have none."""
        return None


class FollowsLoad(RaisesFriction):
    """Dry friction caused by the torque of the load, which `Signals.load` and `Moment.load` hold."""


class ScalesFriction(FrictionLevel):
    """It multiplies the level of dry friction, what other effects add to it included."""

    @abstractmethod
    def friction_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Factor on dry friction, excess and difference included - dimensionless."""


class DirectedFriction(FrictionLevel):
    """Dry friction differs between the directions."""

    @abstractmethod
    def friction_difference(self, values: Values, axis: Axis) -> Number:
        """Dry friction in positive direction less that in negative direction - N*m (N)."""


class CarriesFriction(Friction, Columns):
    """It replaces dry friction as a whole, including what other effects add and scale."""


# Of drive and motor. Efforts are currents times k_T - N*m (N).


class Electronics(Effect):
    """It acts between the demanded current, the reported current and the motor's torque."""


class DriveLimit(Electronics):
    """A limit of the drive: visible where the drive runs the model, and hardly where the recording tracks it."""

    @abstractmethod
    def flowing(
        self, values: Values, axis: Axis, velocity: Number, demand: Number, before: Number, step: float
    ) -> tuple[Number, Number]:
        """Effort that flows at a demand: mean over the step, and at its end; `before` is that at its start."""

    @abstractmethod
    def shown_in(self, trace: Trace, rig: Rig, values: Mapping[str, float]) -> Trace:
        """The part of a recording in which it is visible."""


class TorqueLag(Electronics):
    """Torque acts later than the current that is reported."""

    @abstractmethod
    def acting(self, values: Values, reported: Number, before: Number, step: float) -> tuple[Number, Number]:
        """Effort that acts: at the middle of the step, and at its end; `before` is that at its start."""

    @abstractmethod
    def acting_along(self, values: Mapping[str, float], reported: Array, step: float) -> Array:
        """`acting` along a whole recording, (n,) at a constant step - s."""


class TorqueLoss(Electronics):
    """The motor makes another torque of its current than k_T says."""

    @abstractmethod
    def delivered(self, values: Values, axis: Axis, effort: Number) -> Number:
        """Torque of an effort - N*m (N)."""


# Of the sensors.


class Sensing(Effect):
    """A fault of the measurement."""


class MisreadMotion(Sensing):
    """The encoder errs, and the drive believes it."""

    @abstractmethod
    def seen(self, values: Values, position: Number, velocity: Number) -> tuple[Number, Number]:
        """Position and velocity as the encoder measures them, from the true ones - rad (m), rad/s (m/s)."""

    @abstractmethod
    def unseen(self, values: Mapping[str, float], position: Array, velocity: Array) -> tuple[Array, Array]:
        """True position and velocity from those that the encoder measured, (n,) each."""


class MisreadEffort(Sensing):
    """The sensor of the current errs, and the drive believes it."""

    @abstractmethod
    def acted(self, values: Values, axis: Axis, effort: Number, time: Number) -> Number:
        """Effort that acts while the sensor measures `effort` - N*m (N) - at a time since the recording's start - s."""


class FilteredSignal(Sensing):
    """A signal is filtered between the drive, which has it without the filter, and the recording.

    Attributes:
        signal: its name in a recording: `velocity`, or `current` of which all efforts are made.
    """

    signal: ClassVar[str]

    def recorded(self, values: Mapping[str, float], samples: Array, step: float) -> Array:
        """What is recorded of the samples in the drive, (n,) at a constant step - s; by default behind a lag."""
        return lagged(samples, values["time_constant"], step)

    def unrecorded(self, values: Mapping[str, float], samples: Array, step: float) -> Array:
        """Samples in the drive from the recorded ones, (n,): what holds a model to a recording needs no more."""
        return unlagged(samples, values["time_constant"], step)

    def corrected(self, trace: Trace, values: Mapping[str, float]) -> Trace:
        """The recording with its signal as the drive has it."""
        samples = trace[self.signal].copy()
        for part in trace.segments:
            samples[part] = self.unrecorded(values, samples[part], trace.sample_period)
        return trace.with_signals({self.signal: samples}, {})


#: The model that effects are added to, as MuJoCo lets it be edited.
Spec: TypeAlias = "mujoco.MjSpec"
AXIS, MOTOR, LOAD, DRIVE, LOAD_TORQUE = "axis", "motor", "load", "drive", "load torque"
#: The actuator whose bristles are the axis' friction, where it has some.
BRISTLES = "bristles"

#: A passive DC motor brakes by K**2/R times speed; its constant is chosen so small that this vanishes in rounding.
PASSIVE_MOTOR_CONSTANT = 1e-12


def add_resisting_torque(spec: Spec, torque: float) -> None:
    """Add a constant torque against positive motion - N*m (N)."""
    spec.actuator(LOAD_TORQUE).biasprm[0] -= torque


def passive_motor(
    spec: Spec,
    name: str,
    cogging: tuple[float, float, float] = (0.0, 0.0, 0.0),
    lugre: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0),
) -> None:
    """A DC motor without input on the axis, of which only cogging or bristle friction is left.

    Args:
        spec: to be added to.
        name: of the actuator.
        cogging: amplitude - N*m (N) -, harmonic - 1 (1/m) - and phase - rad - of a driving torque A*sin(n*q + phi).
        lugre: stiffness, damping and levels of bristles, as MuJoCo has them.
    """
    import mujoco

    actuator = spec.add_actuator(name=name, target=AXIS, trntype=mujoco.mjtTrn.mjTRN_JOINT)
    actuator.set_to_dcmotor(
        motorconst=[PASSIVE_MOTOR_CONSTANT, PASSIVE_MOTOR_CONSTANT],
        resistance=1.0,
        cogging=list(cogging),
        lugre=list(lugre),
        ctrlspec=int(mujoco.mjtCtrlInput.mjINPUT_NONE),
    )


def add_coupling_joint(spec: Spec, name: str) -> mujoco.MjsJoint:
    """A joint between motor and load along the axis; its position is load less motor - rad (m)."""
    axis = spec.joint(AXIS)
    return spec.body(LOAD).add_joint(name=name, type=axis.type, axis=axis.axis)
