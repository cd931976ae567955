"""The simulated winding against an independent integrator, and the split of task 11 against closed forms."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.course.axis import lab_rig, torque_constant
from bench.course.methods import RPM
from bench.course.winding import CURRENT_LOOP, STEP, VELOCITY_GAIN, run_winding
from bench.plant.axis_model import AxisParameters
from bench.rig.limits import COLD, HOT, Circuit
from tests.course.drawn import extrapolated_corner


@pytest.fixture
def circuit():
    rig = lab_rig()
    return Circuit.from_motor(rig.motor, rig.motor.peak_curves[0], rig.source)


def test_circuit_from_the_datasheets_curve(circuit):
    top, corner, voltage = 5000.0 / RPM, 2100.0 / RPM, np.sqrt(3.0) * 230.0
    assert circuit.back_emf_constant * top == pytest.approx(voltage)
    assert circuit.back_emf_constant * corner + circuit.resistance * 5.7 == pytest.approx(voltage)
    assert circuit.resistance_at(COLD) == pytest.approx(0.7 * circuit.resistance)
    assert circuit.inductance / circuit.resistance_at(COLD) == pytest.approx(3e-3)
    # energy: back-EMF and torque constant of the unsaturated motor are one; the datasheet's four numbers confirm it
    assert circuit.back_emf_constant == pytest.approx(torque_constant(lab_rig()).constant, rel=0.05)


def independent(c, k, axis, demand, duration, temperature, limit=5.7):
    """The same equations by an integrator with adaptive steps; current, speed, warming."""
    inductance = c.inductance

    def rates(t, state):
        current, speed, warm = state
        target = np.clip(VELOCITY_GAIN / k.constant * (demand - speed), -limit, limit)
        resistance = c.resistance * (1.0 + c.temperature_coefficient * (temperature + warm - HOT))
        voltage = resistance * target + c.back_emf_constant * speed + inductance / CURRENT_LOOP * (target - current)
        voltage = np.clip(voltage, -c.voltage, c.voltage)
        torque = (k.constant + k.curvature * current**2) * current
        friction = axis.viscous_friction_coefficient * speed + axis.coulomb_friction * np.tanh(speed / 1e-3)
        heat = resistance * current**2 - warm / c.thermal_resistance
        # as MuJoCo has it, L/R stays that of the start: L follows R by the warming, at most a percent
        slowed = inductance * resistance / c.resistance_at(temperature)
        return [
            (voltage - resistance * current - c.back_emf_constant * speed) / slowed,
            (torque - friction) / axis.inertia,
            heat * c.thermal_resistance / c.thermal_time_constant,
        ]

    grid = np.arange(0.0, duration, 1e-3)
    solution = solve_ivp(rates, (0.0, duration), [0.0, 0.0, 0.0], "LSODA", grid, rtol=1e-8, atol=1e-9, max_step=5e-4)
    return solution.y


def test_run_through_the_winding_agrees_with_an_independent_integrator(circuit):
    rig = lab_rig()
    axis = AxisParameters.from_rig(rig)
    top, duration = 5000.0 / RPM, 0.6
    run = run_winding(rig, axis, np.full(round(duration / STEP), top), COLD, True)
    every = slice(None, None, round(1e-3 / STEP))
    current, speed, warming = independent(circuit, torque_constant(rig), axis, top, duration, COLD)
    off = np.abs(run.velocity[every] - speed).max(), np.abs(run.current[every] - current)[5:].max()
    corners = extrapolated_corner(speed, current) * RPM, extrapolated_corner(run.velocity, run.current) * RPM
    print(f"speed off by {off[0]:.2g} rad/s, current by {off[1]:.2g} A, corner by {corners[1] - corners[0]:+.2g} rpm")
    assert off[0] < 0.15
    assert off[1] < 0.01
    assert corners[1] == pytest.approx(corners[0], abs=1.0)
    assert run.warming[-1] == pytest.approx(warming[-1], rel=0.01)
    assert np.abs(run.voltage).max() <= circuit.voltage * (1.0 + 1e-12)


def test_11_split_against_closed_forms(done, circuit):
    task = done["11"]
    hot = task["corner, hot, quasi-static"].value
    cold = task["corner, cold, quasi-static"].value
    # without warming, n = n_0 - (n_0 - n_c)*R/R_hot
    assert hot == pytest.approx(2100.0, abs=20.0)
    assert cold == pytest.approx(5000.0 - 0.7 * 2900.0, abs=20.0)
    assert hot < 2100.0
    assert cold < 2970.0
    assert cold - hot == pytest.approx(870.0, abs=5.0)
    assert task["corner, cold, with inductance"].value == pytest.approx(cold, abs=1.0)
    # U = R*Imax + Ke*w with the winding as it starts, and as warm as it ends
    ends = [(circuit.voltage - circuit.resistance_at(t) * 5.7) / circuit.back_emf_constant * RPM for t in (20.0, 22.3)]
    assert ends[1] < cold < ends[0]


def test_11_without_warming_the_hot_corner_is_the_datasheets():
    rig = lab_rig()
    slow = rig.model_copy(update={"motor": rig.motor.model_copy(update={"thermal_time_constant": 1e9})})
    run = run_winding(slow, AxisParameters.from_rig(rig), np.full(round(0.6 / STEP), 5000.0 / RPM), HOT, False)
    assert extrapolated_corner(run.velocity, run.current) * RPM == pytest.approx(2100.0, abs=0.5)
