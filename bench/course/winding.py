"""The motor's winding, simulated, and what moves the corner in the course's circuit, one cause after the other.

The corner is where the torque starts to decline. There dIq/dt = 0, so temperature moves it and inductance cannot; what
inductance does is to flatten the fall beyond it. The axis is driven through MuJoCo's dcmotor with resistance,
inductance and temperature:

    U = R(T)*Iq + L*dIq/dt + Ke*omega, |U| <= U_max;    J*alpha = kT(Iq)*Iq - K_w*omega - K_0*sgn(omega)

dcmotor's torque is Ke*Iq; what the iron's saturation takes of it, (Ke - kT(Iq))*Iq, is applied in addition in each
step. The drive asks for the current that its velocity loop wants, at most peak current, and its current loop sets the
voltage U = R(T)*I_set + Ke*omega + L/T_c*(I_set - Iq).
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.arrays import Array
from bench.course.axis import circuit, motor_value, torque_constant
from bench.course.friction import identify_friction
from bench.course.recordings import LabRecordings
from bench.effects.mjcf import DRIVE
from bench.errors import BenchError, SimulationError
from bench.plant.axis_model import AxisParameters, build_spec
from bench.plant.plant import DIVERGED
from bench.rig.limits import HOT, Circuit
from bench.rig.rig import Rig

#: Step of the integration - s. MuJoCo's current errs to first order: the corner by 0.3 rpm (tests/course).
STEP = 25e-6
#: Time constant of the current loop - s.
CURRENT_LOOP = 0.4e-3
#: The run-up lasts as many times J*omega_0/M_max: then torque is friction, within 1 % of its peak.
LENGTH = 3.0
#: Of the drive, torque asked for per missing speed - N*m*s/rad.
VELOCITY_GAIN = 0.9


@dataclass(frozen=True)
class WindingRun:
    """One run, signals (steps,).

    Attributes:
        time: s.
        velocity: rad/s.
        current: Iq - A.
        voltage: U - V.
        torque: kT(Iq)*Iq - N*m.
        warming: of the winding since the start - K.
        limit: U_max - V.
    """

    time: Array
    velocity: Array
    current: Array
    voltage: Array
    torque: Array
    warming: Array
    limit: float

    @property
    def corner(self) -> float:
        """Speed from which on full voltage no longer drives peak current, between two steps - rad/s."""
        started = int(np.argmax(self.current > 0.999 * self.current.max()))
        at = started + int(np.argmax(np.abs(self.voltage[started:]) >= self.limit * (1.0 - 1e-9)))
        (before, last), (slower, speed) = self.voltage[at - 2 : at].tolist(), self.velocity[at - 2 : at].tolist()
        return speed + (self.limit - last) * (speed - slower) / (last - before)


def run_winding(rig: Rig, axis: AxisParameters, demand: Array, temperature: float, inductive: bool) -> WindingRun:
    """Let an axis follow a speed through its motor's winding.

    Args:
        rig: of the motor, whose mains voltage is MAINS; InputError where it lacks a value.
        axis: that the motor turns.
        demand: speed asked for at every STEP - rad/s, (steps,); SimulationError where the run diverges.
        temperature: of the winding as the run starts, and of its surroundings - degC.
        inductive: whether the winding has its inductance; otherwise current follows voltage at once.
    """
    winding, constant, limit = circuit(rig), torque_constant(rig), motor_value(rig, "peak_current")
    inductance = winding.inductance if inductive else 0.0
    model = _model(winding, axis, temperature, inductance)
    data = mujoco.MjData(model)
    ke, loop_gain = winding.back_emf_constant, inductance / CURRENT_LOOP
    current_gain = VELOCITY_GAIN / constant.constant
    record = np.zeros((demand.size, 4))
    for k, wanted in enumerate(demand.tolist()):
        omega = data.qvel[0]
        target = min(max(current_gain * (wanted - omega), -limit), limit)
        resistance, before = winding.resistance_at(temperature + data.act[0]), data.act[-1]
        wanted = resistance * target + ke * omega + loop_gain * (target - before)
        voltage = data.ctrl[0] = min(max(wanted, -winding.voltage), winding.voltage)
        mujoco.mj_forward(model, data)
        current = data.actuator_force[0] / ke
        record[k] = omega, current, voltage, data.act[0]
        data.qfrc_applied[0] = constant.curvature * current**3 + (constant.constant - ke) * current
        mujoco.mj_step(model, data)
    if not np.isfinite(record).all():
        raise SimulationError(DIVERGED)
    velocity, current, voltage, warming = record.T
    time = STEP * np.arange(demand.size, dtype=np.float64)
    return WindingRun(time, velocity, current, voltage, constant.torque(current), warming, winding.voltage)


def _model(winding: Circuit, axis: AxisParameters, temperature: float, inductance: float) -> mujoco.MjModel:
    """The axis with a dcmotor for its drive. Activations: warming - K, and with inductance - H - the current - A."""
    spec = build_spec(axis, STEP)
    capacity = winding.thermal_time_constant / winding.thermal_resistance
    spec.actuator(DRIVE).set_to_dcmotor(
        motorconst=[winding.back_emf_constant, winding.back_emf_constant],
        resistance=winding.resistance,
        # MuJoCo keeps L/R fixed whatever the temperature: it is that of the winding as it is
        inductance=[0.0, inductance / winding.resistance_at(temperature)],
        thermal=[winding.thermal_resistance, capacity, 0.0, winding.temperature_coefficient, HOT, temperature],
        ctrlspec=int(mujoco.mjtCtrlInput.mjINPUT_VOLTAGE),
    )
    return spec.compile()


def full_speed(rig: Rig, axis: AxisParameters) -> Array:
    """The no-load speed asked for - rad/s, (steps,), as long as a run-up of an axis takes."""
    own, full = circuit(rig), float(torque_constant(rig).torque(np.asarray(motor_value(rig, "peak_current"))))
    top = own.voltage / own.back_emf_constant
    return np.full(round(LENGTH * axis.inertia * top / full / STEP), top)


def identified_axis(recordings: LabRecordings) -> AxisParameters:
    """The axis as task 9 finds it; the embedded example's where there is no such recording."""
    try:
        found = identify_friction(recordings.with_friction)
    except BenchError:
        return AxisParameters.from_rig(recordings.example)
    return AxisParameters(found.inertia, max(found.viscous, 0.0), max(found.coulomb, 0.0))
