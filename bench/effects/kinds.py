"""How effects act on a simulated axis. Three siblings, told apart by where they act:

- `Mechanism`: on the mechanics. Natively, as a part of the MuJoCo model (`add`), or where MuJoCo has no such part by
  what it does in every step: the level of dry friction, a resisting torque, the inertia, the motor's torque.
- `Electronics`: between the current that is demanded, the one that is reported and the torque that the motor makes.
- `Sensing`: between the motion and what the drive sees of it (`seen`), or what is recorded of that (`filtered`); and
  between the current and what the drive takes it for (`acted`), or what is recorded of that (`recorded`).

Hooks are neutral unless an effect overrides them. They take values and states as numbers or as arrays of axes, (k,).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.arrays import Array
from bench.effects.effect import Effect
from bench.effects.signals import Scope

if TYPE_CHECKING:  # 0.2 s, which nobody pays who does not simulate
    import mujoco

Number = float | Array
Values = Mapping[str, Number]


@dataclass(frozen=True)
class Winding:
    """Motor winding: k_T - N*m/A (N/A), R - ohm, L - H, K_e - V*s/rad (V*s/m)."""

    torque_constant: Number
    resistance: Number
    inductance: Number
    back_emf_constant: Number


@dataclass(frozen=True)
class Axis:
    """What effects may need to know of their axis; numbers, or arrays (k,).

    Attributes:
        inertia: J of everything that moves - kg*m**2 (kg).
        motor_inertia: what of it is on the motor's side of a coupling - kg*m**2 (kg).
        viscous: K_w - N*m*s/rad (N*s/m).
        coulomb: K_0 - N*m (N).
        peak_effort: motor torque at peak current - N*m (N).
        winding: None where the rig does not tell it.
    """

    inertia: Number
    motor_inertia: Number
    viscous: Number
    coulomb: Number
    peak_effort: Number
    winding: Winding | None = None


@dataclass(frozen=True)
class Moment:
    """State of axes at the middle of a step.

    Attributes:
        time: since the recording's start - s - one for all, or (k,).
        position: rad (m) - (k,).
        velocity: rad/s (m/s) - (k,).
        effort: of the motor - N*m (N) - (k,).
        began: the recording, since the start of the first of several that are joined - s - one for all, or (k,).
    """

    time: Number
    position: Number
    velocity: Number
    effort: Number
    began: Number = 0.0


class Mechanism(Effect):
    """An effect on the mechanics."""

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Make the effect a part of the model; `name` is free for what is added."""

    def native(self, values: Mapping[str, float], friction_scaled: bool) -> bool:
        """Whether MuJoCo alone makes it; `friction_scaled`: another effect scales or carries friction in every step."""
        return self.overrides("add")

    def resisting_torque(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Taken off the motor's torque - N*m (N)."""
        return 0.0

    def torque_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Multiplies the motor's torque."""
        return 1.0

    def load_torque(self, values: Values, at: Moment) -> Number:
        """Resisting torque by which a load is driven or drives, through what transmits it - N*m (N)."""
        return 0.0

    def added_inertia(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Added to the inertia - kg*m**2 (kg)."""
        return 0.0


class Friction(Mechanism):
    """A mechanism that changes dry friction."""

    def sought(self, scope: Scope) -> bool:
        """Not in one direction, where it is no other than torque: friction that varies with position, an unbalance."""
        return super().sought(scope) and not scope.one_way

    def friction_excess(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Added to the level of dry friction - N*m (N)."""
        return 0.0

    def friction_under_load(self, values: Values, axis: Axis, at: Moment, load: Number) -> Number:
        """Added to the level of dry friction beside torques of the load - N*m (N)."""
        return 0.0

    def friction_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Multiplies the level of dry friction, excess and difference included."""
        return 1.0

    def friction_difference(self, values: Values, axis: Axis) -> Number:
        """Level in positive less level in negative direction - N*m (N)."""
        return 0.0


class Electronics(Effect):
    """An effect of drive and motor winding. Efforts are currents times k_T - N*m (N)."""

    def flowing(
        self, values: Values, axis: Axis, velocity: Array, demand: Array, before: Array, step: float
    ) -> tuple[Array, Array]:
        """Effort that flows when `demand` is asked for: mean over the step, and at its end; `before` at its start."""
        return demand, demand

    def acting(self, values: Values, reported: Array, before: Array, step: float) -> tuple[Array, Array]:
        """Effort that acts while one is reported: at the middle of the step, and at its end; `before` at its start."""
        return reported, reported

    def acting_along(self, values: Mapping[str, float], reported: Array, step: float) -> Array:
        """`acting` along a whole recording, (n,) at a constant step - s."""
        return reported

    def delivered(self, values: Values, axis: Axis, effort: Array) -> Array:
        """Torque that an effort makes."""
        return effort


class Sensing(Effect):
    """An effect of the sensor."""

    @property
    def kind(self) -> str:
        """A fault of the measurement."""
        return "measurement"

    def seen(self, values: Values, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Position and velocity as the encoder sees them and the drive has them, from the true ones."""
        return position, velocity

    def unseen(self, values: Mapping[str, float], position: Array, velocity: Array) -> tuple[Array, Array]:
        """True position and velocity from those that the encoder saw, (n,)."""
        return position, velocity

    def filtered(self, values: Mapping[str, float], velocity: Array, step: float) -> Array:
        """Velocity that the recording holds, from the one that the drive has, (n,) at a constant step - s."""
        return velocity

    def unfiltered(self, values: Mapping[str, float], velocity: Array, step: float) -> Array:
        """Velocity that the drive has, from the one that the recording holds, (n,)."""
        return velocity

    def acted(self, values: Values, axis: Axis, effort: Array, time: Number) -> Array:
        """Effort that acts while the drive's sensor tells one - N*m (N) - at a time since the recording's start - s."""
        return effort

    def recorded(self, values: Mapping[str, float], effort: Array, step: float) -> Array:
        """Effort that the recording holds, from the one that the drive has, (n,) at a constant step - s."""
        return effort

    def unrecorded(self, values: Mapping[str, float], effort: Array, step: float) -> Array:
        """Effort that the drive has, from the one that the recording holds, (n,)."""
        return effort
