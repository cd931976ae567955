"""The simulated winding against an independent integrator, and the split of task 11 against closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from bench.course.axis import lab_rig, torque_constant
from bench.course.corner import TIME_CONSTANTS
from bench.course.peak_torque import extrapolated_corner
from bench.course.power import PowerOfRun, balanced_winding, circuits, speed_of_current
from bench.course.winding import (
    CURRENT_LOOP,
    STEP,
    VELOCITY_GAIN,
    WindingModel,
    full_speed,
    run_winding,
)
from bench.plant.axis_model import AxisParameters
from bench.rig.limits import COLD, HOT, Circuit
from tests.course.drawn import curves

RPM = 60.0 / (2.0 * np.pi)


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


def independent(winding, axis, demand, duration):
    """The same equations by an integrator with adaptive steps; current, speed, warming."""
    c, k, limit = winding.circuit, winding.torque_constant, winding.peak_current
    inductance = c.inductance

    def rates(t, state):
        current, speed, warm = state
        target = np.clip(VELOCITY_GAIN / k.constant * (demand - speed), -limit, limit)
        resistance = c.resistance * (1.0 + c.temperature_coefficient * (winding.temperature + warm - HOT))
        voltage = resistance * target + c.back_emf_constant * speed + inductance / CURRENT_LOOP * (target - current)
        voltage = np.clip(voltage, -c.voltage, c.voltage)
        torque = (k.constant + k.curvature * current**2) * current
        friction = axis.viscous_friction_coefficient * speed + axis.coulomb_friction * np.tanh(speed / 1e-3)
        heat = resistance * current**2 - warm / c.thermal_resistance
        # as MuJoCo has it, L/R stays that of the start: L follows R by the warming, at most a percent
        slowed = inductance * resistance / winding.resistance
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
    winding = WindingModel(circuit, torque_constant(rig), 5.7, COLD, True)
    top, duration = 5000.0 / RPM, 0.6
    run = run_winding(winding, axis, np.full(round(duration / STEP), top))
    every = slice(None, None, round(1e-3 / STEP))
    current, speed, warming = independent(winding, axis, top, duration)
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
    assert task["shift by temperature"].value == pytest.approx(870.0, abs=5.0)
    assert task["shift by inductance"].value == pytest.approx(
        task["corner, cold, with inductance"].value - cold, abs=1e-9
    )
    assert task["shift by inductance"].value == pytest.approx(0.0, abs=1.0)
    for tau in TIME_CONSTANTS:
        assert task[f"corner, L/R = {tau * 1e3:g} ms"].value == pytest.approx(cold, abs=1.0)
    # U = R*Imax + Ke*w with the winding as it starts, and as warm as it ends
    ends = [(circuit.voltage - circuit.resistance_at(t) * 5.7) / circuit.back_emf_constant * RPM for t in (20.0, 22.3)]
    assert ends[1] < cold < ends[0]
    shifts = [task[f"fall later by, L/R = {tau * 1e3:g} ms"].value for tau in TIME_CONSTANTS]
    axis = AxisParameters.from_rig(lab_rig())
    full = (3.5 - axis.coulomb_friction) / axis.inertia * np.array(TIME_CONSTANTS) * RPM
    print("shift in rpm by L/R:", dict(zip(TIME_CONSTANTS, np.round(shifts, 1).tolist(), strict=True)))
    # proportional to L/R; less than alpha*L/R of full torque, as torque falls where the corner is read
    assert np.all(np.array(shifts) < full)
    assert np.all(np.array(shifts) > 0.8 * full)
    # drawn beside them: alpha*L/R with what friction leaves of the full torque, 3.415 N*m over 22.5 kg*cm**2
    line, drawn, theory = curves(done["11"], 1, 0)[:3]
    assert (line.x, drawn.y) == (pytest.approx([1.0, 2.0, 3.0, 5.0, 8.0]), pytest.approx(shifts))
    assert theory.x == pytest.approx([0.0, 1.0, 2.0, 3.0, 5.0, 8.0])
    assert theory.y[1] == pytest.approx((3.5 - 0.085) / 22.5e-4 * 1e-3 * RPM, rel=1e-3)  # axis as task 9 finds it


def test_11_without_warming_the_hot_corner_is_the_datasheets(circuit):
    rig = lab_rig()
    axis = AxisParameters.from_rig(rig)
    slow = replace(circuit, thermal_time_constant=1e9)
    winding = WindingModel(slow, torque_constant(rig), 5.7, HOT, False)
    run = run_winding(winding, axis, np.full(round(0.6 / STEP), 5000.0 / RPM))
    assert extrapolated_corner(run.velocity, run.current) * RPM == pytest.approx(2100.0, abs=0.5)


def test_11_voltage_at_a_right_angle_meets_both_curves(circuit):
    low, high = lab_rig().motor.peak_curves
    figures = circuits(lab_rig(), high)[1]
    shift, ratio = figures.shift, figures.across / (0.7 * figures.drop)
    ke, voltage = circuit.back_emf_constant, circuit.voltage
    # p*L*I = ratio*R_cold*I and R_hot*I = R_cold*I/0.7, both corners, one unknown
    drops = []
    for curve in (low, high):
        w, u = curve.corner_speed, voltage * curve.mains_voltage / low.mains_voltage
        a, b, c = 1.0 + (0.7 * ratio * w) ** 2, 2.0 * ke * w, (ke * w) ** 2 - u**2
        drops.append((-b + np.sqrt(b**2 - 4.0 * a * c)) / (2.0 * a))
    assert drops[0] == pytest.approx(drops[1], rel=1e-9)
    assert 0.0 < shift < 870.0 / RPM


def test_11_circuits_by_their_power_and_by_both_mains_voltages():
    """By a root finder: R, and what is across, from the two corners; then the corner with 0.7 R, and with 0.85 R."""
    rig, ke, peak = lab_rig(), np.sqrt(3.0) * 230.0 * RPM / 5000.0, 3.5 / 5.7
    corners, mains = np.array([2100.0, 4200.0]) / RPM, np.sqrt(3.0) * np.array([230.0, 400.0])
    found = iter(circuits(rig, rig.motor.peak_curves[1]))
    for constant in (ke, peak):

        def off(unknown, w=corners, u=mains, constant=constant, share=1.0):
            drop, across = unknown
            return np.hypot(share * drop + constant * w, across * w) - u

        alone, both = next(found), next(found)
        drop = mains[0] - constant * corners[0]
        assert alone.shift == pytest.approx(0.3 * drop / constant, rel=1e-9)
        assert alone.corner(voltages=400.0 / 230.0) == pytest.approx((mains[1] - drop) / constant, rel=1e-9)
        assert (alone.into_shaft, both.into_shaft) == pytest.approx((peak / constant,) * 2, rel=1e-9)
        solved = fsolve(off, (100.0, 0.5))
        for share, shift in ((0.7, both.shift), (0.85, both.half_way)):
            corner = fsolve(lambda w, share=share, s=solved: off(s, w, mains[0], share=share), corners[0])[0]
            assert shift == pytest.approx(corner - corners[0], rel=1e-6)
    assert circuits(rig, rig.motor.peak_curves[1])[2].shift * RPM == pytest.approx(1229.0, abs=0.5)
    # without current the back-EMF takes all: kT(0), by the course's parabola through 7/9 and 3.5/5.7 N*m/A
    at_none = 7.0 / 9.0 + (7.0 / 9.0 - peak) * 1.8**2 / (5.7**2 - 1.8**2)
    assert both.no_load() == pytest.approx(mains[0] / at_none, rel=1e-9)
    assert (both.no_load() * RPM - 5000.0) / 5000.0 == pytest.approx(-0.044, abs=5e-4)
    fed = next(found)
    assert fed.no_load() * RPM == pytest.approx(5000.0, rel=1e-9)
    assert fed.no_load(400.0 / 230.0) * RPM == pytest.approx(8700.0, rel=1e-3)
    for ratio, corner in ((1.0, corners[0]), (400.0 / 230.0, corners[1])):
        triangle = np.hypot(fed.drop + peak * corner, fed.across * corner)
        assert triangle == pytest.approx(ratio * at_none * 5000.0 / RPM, rel=1e-9)
    assert fed.shift * RPM == pytest.approx(230.0, abs=1.0)


@pytest.fixture(scope="module")
def balanced():
    """Motor, axis and winding whose power balances, at 20 degC, and its run-up."""
    rig = lab_rig()
    axis = AxisParameters.from_rig(rig)
    figures = circuits(rig, rig.motor.peak_curves[1])[3]
    winding = balanced_winding(rig, figures, COLD)
    return rig, axis, figures, winding, run_winding(winding, axis, full_speed(rig, axis)[1])


def test_11_power_from_the_terminals_is_heat_field_and_motion(balanced, done):
    """What the axis takes is seen in its motion, and what the terminals give in voltage and current alone."""
    _, axis, _, winding, run = balanced
    power = PowerOfRun.of(run, winding, axis)
    assert power.terminals.max() > 1400.0
    assert power.lost < 0.5
    assert np.abs(np.hypot(run.voltage, run.across)).max() <= run.limit * (1.0 + 1e-9)
    assert done["11"]["power left over at most, power balances"].value < 0.5
    # the course's circuit: (Ke - kT(I_max))*I_max*omega, the most at the corner
    corner = done["11"]["corner, cold, with inductance"].value / RPM
    lost = (np.sqrt(3.0) * 230.0 * RPM / 5000.0 - 3.5 / 5.7) * 5.7 * corner
    assert done["11"]["power left over at most, course's circuit"].value == pytest.approx(lost, rel=5e-3)
    assert lost == pytest.approx(1349.0 - 1089.0, abs=10.0)


def test_11_corner_of_two_axes_is_that_of_the_voltages_triangle(balanced, done):
    """With R as warm as the winding is there: U**2 = (R*I + kT(I)*w)**2 + (w*p*L*I)**2."""
    winding, cold = balanced[3:]
    names = {HOT: "hot", 70.0: "at 70 °C", COLD: "cold"}
    corners = {start: done["11"][f"power balances: {name}"].value / RPM for start, name in names.items()}
    assert cold.corner == pytest.approx(corners[COLD], abs=0.5 / RPM)  # there with the axis as task 9 finds it
    u, across = winding.circuit.voltage, winding.across * 5.7
    for start, corner in corners.items():
        resistance = winding.circuit.resistance * (1.0 - 0.3 * (HOT - start - 1.3) / 100.0)  # warmer by 1.2 to 1.5 K

        def off(w, resistance=resistance):
            return np.hypot(resistance * 5.7 + 3.5 / 5.7 * w, across * w) - u

        assert corner == pytest.approx(fsolve(off, 220.0)[0], abs=1.0 / RPM)
    # what tells temperature from p*L: half the change of R moves this corner by a quarter of the course's 435 rpm
    assert (corners[COLD] - corners[70.0]) * RPM == pytest.approx(111.0, abs=1.0)


def test_11_two_axes_agree_with_an_independent_integrator(balanced):
    """Flux from a coenergy by differences, and the voltage on the circle by the roots of what its square is."""
    rig, axis, _, winding, run = balanced
    c, k, limit = winding.circuit, winding.torque_constant, winding.peak_current
    inductance, u = c.inductance, c.voltage
    pairs = winding.across / inductance

    def coenergy(d, q):
        return 0.5 * inductance * q**2 + (k.constant + k.curvature * q**2) * d / pairs

    def flux(q, step=1e-4):
        d_axis = (coenergy(step, q) - coenergy(-step, q)) / (2.0 * step)
        return np.array([d_axis, (coenergy(0.0, q + step) - coenergy(0.0, q - step)) / (2.0 * step)])

    top = full_speed(rig, axis)[1][0]

    def rates(t, state):
        current, speed, warm = state
        target = np.clip(VELOCITY_GAIN / k.constant * (top - speed), -limit, limit)
        resistance = c.resistance * (1.0 + c.temperature_coefficient * (winding.temperature + warm - HOT))
        (d, q), bend = flux(current), (flux(current + 1e-3) - flux(current - 1e-3)) / 2e-3

        def voltage(slope):
            turn = pairs * speed
            return np.array([bend[0] * slope - turn * q, resistance * current + bend[1] * slope + turn * d])

        wanted = (resistance * (target - current) + inductance / CURRENT_LOOP * (target - current)) / inductance
        square = np.polyfit([-1.0, 0.0, 1.0], [voltage(x) @ voltage(x) - u**2 for x in (-1e3, 0.0, 1e3)], 2)
        slope = np.clip(wanted, *sorted(1e3 * np.roots(square).real))
        torque = pairs * d * current
        friction = axis.viscous_friction_coefficient * speed + axis.coulomb_friction * np.tanh(speed / 1e-3)
        heat = resistance * current**2 * c.thermal_resistance
        return [slope, (torque - friction) / axis.inertia, (heat - warm) / c.thermal_time_constant]

    duration = 0.3
    grid = np.arange(0.0, duration, 1e-3)
    found = solve_ivp(rates, (0.0, duration), [0.0, 0.0, 0.0], "LSODA", grid, rtol=1e-7, atol=1e-8, max_step=5e-4).y
    every = slice(0, round(duration / STEP), round(1e-3 / STEP))
    off = np.abs(run.velocity[every] - found[1]).max(), np.abs(run.current[every] - found[0])[5:].max()
    print(f"speed off by {off[0]:.2g} rad/s, current by {off[1]:.2g} A")
    assert off[0] < 0.15
    assert off[1] < 0.01


def test_11_both_peak_curves_are_met_and_drawn(balanced, done):
    rig, _, figures, _, _ = balanced
    for place, (ratio, corner) in enumerate(((1.0, 2100.0), (400.0 / 230.0, 4200.0))):
        speed, current = speed_of_current(figures, 5.7, torque_constant(rig), ratio)
        assert speed[0] * RPM == pytest.approx(corner, abs=1e-6)
        assert current[0] == 5.7
        # without current all voltage is back-EMF of the unsaturated motor
        top = ratio * np.sqrt(3.0) * 230.0 / torque_constant(rig).constant * RPM
        assert speed[-1] * RPM == pytest.approx(top)
        drawn = {one.name: one for one in curves(done["11"], 3, place)}["Ke = kT(Iq), with ω·p·L·Iq"]
        assert (drawn.x[1], drawn.y[1], drawn.x[-1]) == pytest.approx((corner, 3.5, top), rel=1e-6)
    assert done["11"]["power balances: shift by temperature"].value == pytest.approx(figures.shift * RPM, abs=3.0)
