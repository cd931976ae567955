"""How effects act on a simulated axis. Three kinds, by where they act:

- `Mechanism`: on the mechanics, natively as part of the MuJoCo model (`add`); where MuJoCo has no such part, in every
  step on dry friction, a resisting torque, the inertia, or the motor's torque.
- `Electronics`: between the demanded current, the reported current and the motor's torque.
- `Sensing`: between the motion, what the drive measures of it (`seen`) and what is recorded (`filtered`); and between
  the current, what the drive measures of it (`acted`) and what is recorded (`recorded`).

Hooks are neutral unless an effect overrides them. They take values and states as numbers, or as arrays of k axes (k,).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.arrays import Array
from bench.effects.effect import Effect
from bench.effects.signals import Scope

if TYPE_CHECKING:  # 0.2 s, needed only to simulate
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
    """The axis, as far as effects need it; numbers, or arrays (k,).

    Attributes:
        inertia: total inertia J - kg*m**2 (kg).
        motor_inertia: its part on the motor's side of a coupling - kg*m**2 (kg).
        viscous: K_w - N*m*s/rad (N*s/m).
        coulomb: K_0 - N*m (N).
        peak_effort: motor torque at peak current - N*m (N).
        winding: None if the rig does not give it.
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
        time: since the recording's start - s -; a number, or (k,).
        position: rad (m) - (k,).
        velocity: rad/s (m/s) - (k,).
        effort: of the motor - N*m (N) - (k,).
        began: start of the recording, counted from that of the first where several are joined - s -; a number, or (k,).
    """

    time: Number
    position: Number
    velocity: Number
    effort: Number
    began: Number = 0.0


class Mechanism(Effect):
    """An effect on the mechanics."""

    def add(self, spec: mujoco.MjSpec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Add the effect to the model; `name` is free to name the new elements."""

    def native(self, values: Mapping[str, float], friction_scaled: bool) -> bool:
        """Whether MuJoCo simulates it by itself; `friction_scaled`: another effect changes friction in every step."""
        return self.overrides("add")

    def resisting_torque(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Torque against the motor's - N*m (N)."""
        return 0.0

    def torque_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Factor on the motor's torque - dimensionless."""
        return 1.0

    def load_torque(self, values: Values, at: Moment) -> Number:
        """Resisting torque of the load, as the transmission carries it - N*m (N)."""
        return 0.0

    def added_inertia(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Additional inertia - kg*m**2 (kg)."""
        return 0.0


class Friction(Mechanism):
    """A mechanism that changes dry friction."""

    def sought(self, scope: Scope) -> bool:
        """Not in motion of one direction, where such friction looks like a torque, e.g. like an unbalance."""
        return super().sought(scope) and not scope.one_way

    def friction_excess(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Additional dry friction - N*m (N)."""
        return 0.0

    def friction_under_load(self, values: Values, axis: Axis, at: Moment, load: Number) -> Number:
        """Additional dry friction caused by a torque of the load - N*m (N)."""
        return 0.0

    def friction_factor(self, values: Values, axis: Axis, at: Moment) -> Number:
        """Factor on dry friction, excess and difference included - dimensionless."""
        return 1.0

    def friction_difference(self, values: Values, axis: Axis) -> Number:
        """Dry friction in positive direction less that in negative direction - N*m (N)."""
        return 0.0


class Electronics(Effect):
    """An effect of drive or motor winding. Efforts are currents times k_T - N*m (N)."""

    def flowing(
        self, values: Values, axis: Axis, velocity: Array, demand: Array, before: Array, step: float
    ) -> tuple[Array, Array]:
        """Effort that flows at a demand: mean over the step, and at its end; `before` is that at its start."""
        return demand, demand

    def acting(self, values: Values, reported: Array, before: Array, step: float) -> tuple[Array, Array]:
        """Effort that acts: at the middle of the step, and at its end; `before` is that at its start."""
        return reported, reported

    def acting_along(self, values: Mapping[str, float], reported: Array, step: float) -> Array:
        """`acting` along a whole recording, (n,) at a constant step - s."""
        return reported

    def delivered(self, values: Values, axis: Axis, effort: Array) -> Array:
        """Torque of an effort - N*m (N)."""
        return effort


class Sensing(Effect):
    """An effect of the sensor."""

    @property
    def kind(self) -> str:
        """A fault of the measurement."""
        return "measurement"

    def seen(self, values: Values, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Position and velocity as the encoder measures them, from the true ones - rad (m), rad/s (m/s)."""
        return position, velocity

    def unseen(self, values: Mapping[str, float], position: Array, velocity: Array) -> tuple[Array, Array]:
        """True position and velocity from those that the encoder measured, (n,) each."""
        return position, velocity

    def filtered(self, values: Mapping[str, float], velocity: Array, step: float) -> Array:
        """Recorded velocity from that in the drive, (n,) at a constant step - s."""
        return velocity

    def unfiltered(self, values: Mapping[str, float], velocity: Array, step: float) -> Array:
        """Velocity in the drive from the recorded one, (n,)."""
        return velocity

    def acted(self, values: Values, axis: Axis, effort: Array, time: Number) -> Array:
        """Effort that acts while the sensor measures `effort` - N*m (N) - at a time since the recording's start - s."""
        return effort

    def recorded(self, values: Mapping[str, float], effort: Array, step: float) -> Array:
        """Recorded effort from that in the drive, (n,) at a constant step - s."""
        return effort

    def unrecorded(self, values: Mapping[str, float], effort: Array, step: float) -> Array:
        """Effort in the drive from the recorded one, (n,)."""
        return effort
