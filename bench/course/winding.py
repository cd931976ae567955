"""The axis driven through its motor's winding: MuJoCo's dcmotor with resistance, inductance and temperature.

    U = R(T)*Iq + L*dIq/dt + Ke*omega, |U| <= U_max;    J*alpha = kT(Iq)*Iq - K_w*omega - K_0*sgn(omega)

dcmotor's torque is Ke*Iq; what the iron's saturation takes of it, (Ke - kT(Iq))*Iq, is applied beside it in each step.
The drive asks for the current that its velocity loop wants, at most peak current, and its current loop sets the
voltage U = R(T)*I_set + Ke*omega + L/T_c*(I_set - Iq).
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.arrays import Array
from bench.errors import SimulationError
from bench.plant.axis_model import AxisParameters, build_spec
from bench.plant.closed_loop import DIVERGED
from bench.rig.limits import HOT, Circuit
from bench.rig.motor import TorqueConstant

#: Name of the motor's actuator in mjcf/rotary_axis.xml.
DRIVE = "drive"
#: Step of the integration - s. MuJoCo's current errs to first order: the corner by 0.3 rpm (tests/course).
STEP = 25e-6
#: Time constant of the current loop - s.
CURRENT_LOOP = 0.4e-3


@dataclass(frozen=True)
class WindingModel:
    """What the current has to pass.

    Attributes:
        circuit: of the motor, at its mains voltage.
        torque_constant: kT(Iq).
        peak_current: limit of the drive - A.
        temperature: of the winding as the run starts, and of its surroundings - degC.
        inductive: whether the winding has its inductance, or current follows voltage at once.
    """

    circuit: Circuit
    torque_constant: TorqueConstant
    peak_current: float
    temperature: float
    inductive: bool

    @property
    def resistance(self) -> float:
        """As the run starts - ohm."""
        return self.circuit.resistance_at(self.temperature)

    @property
    def inductance(self) -> float:
        """L - H; zero without."""
        return self.circuit.inductance if self.inductive else 0.0


@dataclass(frozen=True)
class WindingRun:
    """One run, signals (steps,).

    Attributes:
        time: s.
        velocity: rad/s.
        current: Iq - A.
        voltage: U - V.
        torque: kT(Iq)*Iq - N*m.
        warming: of the winding from start to end - K.
    """

    time: Array
    velocity: Array
    current: Array
    voltage: Array
    torque: Array
    warming: float


def run_winding(winding: WindingModel, axis: AxisParameters, demand: Array, velocity_gain: float) -> WindingRun:
    """Let an axis follow a speed through its motor's winding.

    Args:
        winding: of the motor.
        axis: its inertia and friction.
        demand: (steps,) speed at every STEP - rad/s.
        velocity_gain: torque asked for per speed missing - N*m*s/rad.

    Raises:
        SimulationError: it diverged.
    """
    model = _model(winding, axis)
    data = mujoco.MjData(model)
    circuit, constant, limit = winding.circuit, winding.torque_constant, winding.peak_current
    ke, loop_gain = circuit.back_emf_constant, winding.inductance / CURRENT_LOOP
    current_gain = velocity_gain / constant.constant
    record = np.zeros((demand.size, 3))
    for k, wanted in enumerate(demand.tolist()):
        omega = data.qvel[0]
        target = min(max(current_gain * (wanted - omega), -limit), limit)
        resistance = circuit.resistance_at(winding.temperature + data.act[0])
        voltage = resistance * target + ke * omega + loop_gain * (target - data.act[-1])
        data.ctrl[0] = min(max(voltage, -circuit.voltage), circuit.voltage)
        mujoco.mj_forward(model, data)
        current = data.actuator_force[0] / ke
        record[k] = omega, current, data.ctrl[0]
        data.qfrc_applied[0] = constant.curvature * current**3 + (constant.constant - ke) * current
        mujoco.mj_step(model, data)
    if not np.isfinite(record).all():
        raise SimulationError(DIVERGED)
    velocity, current, voltage = record.T
    time = STEP * np.arange(demand.size, dtype=np.float64)
    return WindingRun(time, velocity, current, voltage, constant.torque(current), float(data.act[0]))


def _model(winding: WindingModel, axis: AxisParameters) -> mujoco.MjModel:
    """The axis with a dcmotor for its drive. Activations: warming - K, and with inductance the current - A."""
    circuit = winding.circuit
    spec = build_spec(axis, STEP)
    capacity = circuit.thermal_time_constant / circuit.thermal_resistance
    spec.actuator(DRIVE).set_to_dcmotor(
        motorconst=[circuit.back_emf_constant, circuit.back_emf_constant],
        resistance=circuit.resistance,
        # MuJoCo keeps L/R fixed whatever the temperature: it is that of the winding as it is
        inductance=[0.0, winding.inductance / winding.resistance],
        thermal=[circuit.thermal_resistance, capacity, 0.0, circuit.temperature_coefficient, HOT, winding.temperature],
        ctrlspec=int(mujoco.mjtCtrlInput.mjINPUT_VOLTAGE),
    )
    return spec.compile()
