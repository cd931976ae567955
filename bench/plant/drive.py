"""The drive: a cascade of a position P controller and a velocity PI controller with inertia feed-forward.

    torque = K_v*e_v + K_i*integral(e_v dt) + J_ff*acceleration_reference,        |torque| <= torque_limit
    e_v = velocity_reference + K_p*(position_reference - position) - velocity

It exists twice and both agree (tests/plant/test_drive.py prints by how much): `CascadeDrive`, ticked in Python, is
its integrator while the torque is limited; `add_pid` is the same law as MuJoCo's own actuator, which does not hold, and
serves wherever the limit is not reached.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import mujoco
import numpy as np

from bench.arrays import Array
from bench.effects.effect import EncoderFault
from bench.effects.mjcf import DRIVE
from bench.errors import InputError
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.rig.rig import Rig
from bench.structured import csv_text

#: Sensor that has to be in a model that runs natively.
TORQUE = "torque"


@dataclass(frozen=True)
class Cascade:
    """Gains and limit of a cascade.

    Attributes:
        position_gain: K_p - 1/s.
        velocity_gain: K_v - N*m*s/rad (N*s/m on a linear axis).
        integral_gain: K_i - N*m/rad (N/m).
        inertia_feedforward: J_ff - kg*m**2 (kg).
        torque_limit: torque at peak current - N*m (N); infinite without one.
        control_period: of the loop - s.
    """

    position_gain: float
    velocity_gain: float
    integral_gain: float
    inertia_feedforward: float
    torque_limit: float
    control_period: float

    @classmethod
    def from_rig(cls, rig: Rig) -> Cascade:
        """The drive of a rig; InputError where it has none."""
        if rig.drive is None:
            raise InputError(f"{rig.source}: drive", "missing", "the closed loop needs a table [drive]")
        return cls(torque_limit=peak_torque(rig), **dict(rig.drive))


def peak_torque(rig: Rig) -> float:
    """Torque at the motor's peak current - N*m (N on a linear axis); infinite where the rig states none."""
    constant, current = rig.motor.torque_per_ampere, rig.motor.peak_current
    if constant is None or current is None:
        return rig.motor.peak_torque or np.inf
    return float(constant.torque(np.asarray(current)))


class CascadeDrive:
    """The cascade ticked in software, once along its references, on which it starts at rest.

    Args:
        axis: the model whose encoder the drive sees; without one it sees the true motion.
        emulated: an axis whose friction the software makes.
    """

    def __init__(
        self,
        cascade: Cascade,
        references: References,
        axis: AxisModel | None = None,
        emulated: AxisParameters | None = None,
    ) -> None:
        period, self._position_gain = cascade.control_period, cascade.position_gain
        # The velocity error is integrated by the trapezoidal rule: half of this tick's error, all of those before.
        self._gain = cascade.velocity_gain + cascade.integral_gain * (period / 2.0)
        self._integral_step = cascade.integral_gain * period
        self._upper = cascade.torque_limit
        self._lower = -self._upper
        self._speed_demand = (references.velocity + self._position_gain * references.position).tolist()
        self._feedforward = references.feedforward(cascade.inertia_feedforward).tolist()
        self._integral = 0.0
        self._friction = None if emulated is None else _EmulatedFriction(emulated, period, references.start[1])
        self._encoders = [] if axis is None else axis.acting(EncoderFault)

    def tick(self, k: int, position: float, velocity: float) -> tuple[float, float]:
        """Torque from tick k to the next - N*m (N) - of the true motion at it: set-point, and the motor's.

        They differ by the emulated friction. The set-point is what the drive reports as current: the torque that moves
        the axis against its friction, whether that sits in the mechanics or in the software.
        """
        for effect, values in self._encoders:
            position, velocity = effect.measured(values, position, velocity)
        error = self._speed_demand[k] - self._position_gain * position - velocity
        wanted = self._gain * error + self._integral + self._feedforward[k]
        setpoint = motor = max(min(wanted, self._upper), self._lower)
        if self._friction is not None:
            asked = setpoint - self._friction.torque(setpoint, velocity)
            self._friction.applied = motor = max(min(asked, self._upper), self._lower)
            setpoint = setpoint + (motor - asked)
        self._integral = self._integral + self._integral_step * error * (setpoint == wanted)
        return setpoint, motor


class _EmulatedFriction:
    """Friction torque by software: full friction while moving; at standstill whatever holds the axis, up to K_0.

    A tick of length T begins at speed w and accelerates by alpha = (M_net - friction)/J, M_net being set-point less
    load. Viscous friction is that of the speed in its middle, w + alpha*T/2, as the torque is held over the tick. Dry
    friction is what stops the axis within the tick, M_net + J*w/T - K_w*w/2, as far as K_0 allows; beyond that it
    slips. The load is given by the last tick's change of speed: M_load = M_motor - J*(w - w_last)/T.
    """

    def __init__(self, axis: AxisParameters, period: float, velocity: float) -> None:
        viscous, inertia = axis.viscous_friction_coefficient, axis.inertia
        self._coulomb = axis.coulomb_friction
        self._momentum_rate = inertia / period
        self._stopping = inertia / period - viscous / 2.0
        # friction = dry + K_w*(w + alpha*T/2), solved for friction
        self._share = inertia / (inertia + viscous * period / 2.0)
        self._viscous = self._share * viscous
        self._last = self._momentum_rate * velocity
        self.applied = 0.0

    def torque(self, setpoint: float, velocity: float) -> float:
        """Friction torque - N*m (N) - to be taken off the set-point."""
        now = self._momentum_rate * velocity
        net = setpoint - self.applied + (now - self._last)
        self._last = now
        dry = max(min(net + self._stopping * velocity, self._coulomb), -self._coulomb)
        return net + self._share * (dry - net) + self._viscous * velocity


def sense_torque(spec: mujoco.MjSpec) -> None:
    """Let a model report the torque of its drive."""
    kind, actuator = mujoco.mjtSensor.mjSENS_ACTUATORFRC, mujoco.mjtObj.mjOBJ_ACTUATOR
    spec.add_sensor(name=TORQUE, type=kind, objtype=actuator, objname=DRIVE)


def add_pid(spec: mujoco.MjSpec, cascade: Cascade) -> None:
    """Turn the actuator `drive` into the cascade of one axis, for a model whose timestep is the control period.

    With e_v integrated, K_i*integral(e_v) = K_i*(r - q) + K_i*K_p*integral(r - q), so MuJoCo's gains are
    kp = K_v*K_p + K_i, ki = K_i*K_p, kv = K_v. MuJoCo's position leads by half a step (`bench.plant.axis_model`), which
    takes kp*T/2 off kv; `pid_inputs` sends the position reference ahead alike.
    """
    actuator = spec.actuator(DRIVE)
    kp = cascade.velocity_gain * cascade.position_gain + cascade.integral_gain
    kv = cascade.velocity_gain - kp * cascade.control_period / 2.0
    ki = cascade.integral_gain * cascade.position_gain
    inputs = mujoco.mjtCtrlInput.mjINPUT_POS | mujoco.mjtCtrlInput.mjINPUT_VEL | mujoco.mjtCtrlInput.mjINPUT_FF
    actuator.set_to_pid(kp=kp, kv=kv, ki=ki if ki > 0.0 else -1.0, ctrlspec=int(inputs))
    if np.isfinite(cascade.torque_limit):
        actuator.forcerange = [-cascade.torque_limit, cascade.torque_limit]
        actuator.forcelimited = mujoco.mjtLimited.mjLIMITED_TRUE
    sense_torque(spec)


def pid_inputs(cascade: Cascade, references: References) -> Array:
    """Inputs pos, vel, ff of the actuator of `add_pid`, for one axis, without other known torque: (ticks, 4)."""
    lead = cascade.control_period / 2.0 * references.velocity
    feedforward = references.feedforward(cascade.inertia_feedforward)
    beside = np.zeros_like(feedforward)
    return np.stack([references.position + lead, references.velocity, feedforward, beside], axis=-1)


@dataclass(frozen=True)
class References:
    """A motion at the drive's ticks (ticks,).

    Attributes:
        time: of the ticks, from zero - s.
        position, velocity, acceleration: rad, rad/s, rad/s**2 (m, m/s, m/s**2 on a linear axis).
        torque: that is added to the drive's set-point, in addition to its own feed-forward - N*m (N); None without any.
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    torque: Array | None = None

    def feedforward(self, inertia: float) -> Array:
        """Torque that is fed forward - N*m (N) - by a drive that takes its inertia to be one - kg*m**2 (kg)."""
        accelerating = inertia * self.acceleration
        return accelerating if self.torque is None else accelerating + self.torque

    @property
    def start(self) -> tuple[float, float]:
        """Position and velocity at the first tick - rad (m), rad/s (m/s)."""
        return float(self.position[0]), float(self.velocity[0])

    @property
    def period(self) -> float:
        """Time between ticks - s."""
        return float(self.time[1] - self.time[0])

    def until(self, duration: float) -> References:
        """Its beginning of such a length - s; InputError where it is shorter than that."""
        if not self.period <= duration <= self.time[-1]:
            raise InputError(
                "duration", f"found {duration:g} s", f"allowed: {self.period:g} s to {self.time[-1]:g} s, as the motion"
            )
        count = int(np.searchsorted(self.time, duration, side="right"))
        torque = None if self.torque is None else self.torque[:count]
        position, velocity, acceleration = self.position[:count], self.velocity[:count], self.acceleration[:count]
        return References(self.time[:count], position, velocity, acceleration, torque)

    def then(self, other: References) -> References:
        """This motion, then another one that starts a tick later from where this one ends, both at rest there."""
        time = np.concatenate([self.time, self.time[-1] + self.period + other.time])
        position = np.concatenate([self.position, self.position[-1] - other.position[0] + other.position])
        velocity = np.concatenate([self.velocity, other.velocity])
        return References(time, position, velocity, np.concatenate([self.acceleration, other.acceleration]))

    def repeated(self, times: int) -> References:
        """This motion so many times, each from where the one before ends."""
        return reduce(References.then, [self] * times)

    def csv(self, period: float, position: tuple[str, float], velocity: tuple[str, float]) -> str:
        """Table for a controller: time, position, velocity, acceleration.

        Args:
            period: between rows - s.
            position, velocity: unit of each, and SI per one of it.
        """
        rows = slice(None, None, max(1, round(period / self.period)))
        (length, per_length), (speed, per_speed) = position, velocity
        moved = self.position / per_length, self.velocity / per_speed, self.acceleration / per_speed
        head = "time [s]", f"position [{length}]", f"velocity [{speed}]", f"acceleration [{speed}/s]"
        return csv_text(head, np.stack([signal[rows] for signal in (self.time, *moved)], axis=-1).tolist())
