"""Motion and current as drive and recording have them: sensor faults are in both, lags only in the recording."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import Array
from bench.axis_kind import ROTARY, AxisKind
from bench.effects.effect import EncoderFault, Lag, Stage
from bench.effects.signals import AxisState
from bench.effects.torque import Torque
from bench.errors import InputError
from bench.plant.axis_model import AxisModel
from bench.plant.drive import References
from bench.plant.plant import States
from bench.rig.motor import TorqueConstant
from bench.rig.rig import Rig
from bench.trace.signals import unit_on
from bench.trace.trace import Trace


def reported(model: AxisModel, position: Array, velocity: Array, step: float) -> tuple[Array, Array]:
    """What sensors report of one axis' true motion, (n,) each at a constant step - s."""
    for effect, values in model.acting(EncoderFault):
        position, velocity = effect.measured(values, position, velocity)
    for lag, values in lags(model, "velocity"):
        velocity = lag.lagging(values, velocity, step)
    return position, velocity


def lags(model: AxisModel, signal: str) -> list[tuple[Lag, dict[str, float]]]:
    """Lags of a signal, `velocity`, `current` or `torque`, with their values."""
    return [(effect, values) for effect, values in model.acting(Lag) if effect.signal == signal]


def true_velocity(model: AxisModel, velocity: Array, step: float) -> Array:
    """Velocity that the encoder measured, from the reported one, (n,): lags undone."""
    for lag, values in reversed(lags(model, "velocity")):
        velocity = lag.leading(values, velocity, step)
    return velocity


def true_motion(model: AxisModel, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Motion from what the encoder measured of it, (n,) each."""
    for effect, values in reversed(model.acting(EncoderFault)):
        position, velocity = effect.actual(values, position, velocity)
    return position, velocity


def true_effort(model: AxisModel, at: AxisState) -> Array:
    """Effort of one axis that flowed in states (n,) at a constant step, whose effort is the recorded one."""
    effort = at.effort
    for lag, values in reversed(lags(model, "current")):
        effort = lag.leading(values, effort, at.step)
    return remaining(model, Stage.CURRENT_SENSOR, at._replace(effort=effort))


def remaining(model: AxisModel, stage: Stage, at: AxisState) -> Array:
    """Effort (n,) of one axis after what effects take of that of a state at a stage."""
    for effect, values in model.acting(Torque):
        if effect.stage == stage:
            at = at._replace(effort=at.effort - effect.torque(values, model.axis, at))
    return at.effort


def reported_states(model: AxisModel, states: States) -> States:
    """A motion as the axis' sensors report it."""
    step = float(states.time[1] - states.time[0])
    position, velocity = reported(model, states.position, states.velocity, step)
    torque = states.torque
    for lag, values in lags(model, "current"):
        torque = lag.lagging(values, torque, step)
    return replace(states, position=position, velocity=velocity, torque=torque)


@dataclass(frozen=True)
class Sensors:
    """Encoder, current measurement and recorder of a drive.

    Attributes:
        sample_period: of the recording, a multiple of the drive's control period - s.
        encoder_resolution: angle (length) of one count - rad (m); 0 is ideal.
        velocity_noise: standard deviation of the reported speed - rad/s (m/s), white.
        current_noise: standard deviation of the reported current - A (torque - N*m, N - without `torque_constant`).
        torque_constant: turns torque into the current reported; None reports torque (force).
        kind: of the axis.
    """

    sample_period: float
    encoder_resolution: float = 0.0
    velocity_noise: float = 0.0
    current_noise: float = 0.0
    torque_constant: TorqueConstant | None = None
    kind: AxisKind = ROTARY

    @classmethod
    def from_rig(cls, rig: Rig) -> Sensors:
        """The sensors of a rig's `[simulation]`; InputError where it has none."""
        stated = rig.simulated
        noise = stated.velocity_noise, stated.current_noise
        return cls(stated.sample_period, stated.encoder_resolution, *noise, rig.motor.torque_per_ampere, rig.axis_kind)

    def stride(self, period: float) -> int:
        """Ticks of a drive with this period - s - from a sample to the next; InputError if there is no whole number."""
        stride = max(1, round(self.sample_period / period))
        if abs(stride * period / self.sample_period - 1.0) > 1e-9:
            allowed = f"allowed: a multiple of the control period of {period:g} s"
            raise InputError("simulation.sample_period", f"found {self.sample_period:g} s", allowed)
        return stride

    def record(self, states: States, references: References, random: np.random.Generator, origin: str) -> Trace:
        """Trace of a motion along references, position, velocity and current of a row simultaneous.

        Position is rounded to counts. Velocity is the drive's own, true speed with noise. The drive keeps its current
        over each tick; the current of a row is interpolated between the middles of the ticks around it, by a cubic
        that keeps their shape (Fritsch, Carlson, SIAM J. Numer. Anal. 17, 1980, 238-246), so it never exceeds the peak.
        """
        from scipy.interpolate import PchipInterpolator  # 0.1 s, which only a simulated recording has to pay

        rows = slice(None, None, self.stride(references.period))
        time, position, velocity = states.time[rows], states.position[rows], states.velocity[rows]
        noise = random.standard_normal((2, len(time)))
        if self.encoder_resolution > 0.0:
            position = np.round(position / self.encoder_resolution) * self.encoder_resolution
        effort, held = self.kind.effort, states.torque
        if self.torque_constant is not None:
            effort, held = "current", self.torque_constant.current(held)
        middles = states.time + (states.time[1] - states.time[0]) / 2.0
        held = PchipInterpolator(middles, held)(np.maximum(time, middles[0]))
        signals = {
            "position": position,
            "velocity": velocity + self.velocity_noise * noise[0],
            effort: held + self.current_noise * noise[1],
            "position_reference": references.position[rows],
            "velocity_reference": references.velocity[rows],
        }
        units = {name: unit_on(self.kind, name) for name in signals}
        return Trace(time, signals, units, origin)
