"""Every number of every task against the truth of the synthetic recordings, closed forms, or the datasheet."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.course.axis import lab_rig
from bench.course.catapult import FLIGHTS, fly
from bench.course.friction import lateness
from bench.course.methods import RPM, num_derivative
from bench.course.peak_torque import decline
from bench.course.recordings import LabRun
from bench.course.torque_constants import datasheet_points
from bench.errors import UndeterminedError
from tests.course.drawn import curves, extrapolated_corner


def near(number, share):
    """The number against its truth."""
    assert number.truth is not None
    off = number.value / number.truth - 1.0
    print(f"{number.name}: {number.value:.6g} {number.unit}, truth {number.truth:.6g}, {off:+.3%}")
    assert number.value == pytest.approx(number.truth, rel=share)


def test_1_catapult_recovers_the_throw_within_its_scatter(done):
    task = done["1"]
    flights = np.array([fly(factor, angle).coefficients for factor, angle in ((1.015, 2.3562), (0.985, 2.3562))])
    spread = np.abs(flights[0] - flights[1]) / 2.0
    assert len(curves(task)) == FLIGHTS + 1
    for name, reach in zip("abc", spread, strict=True):
        number = task[name]
        # ten launches, each as far off as one standard deviation of stiffness makes it; the release scatters alike
        assert abs(number.value - number.truth) < 4.0 * reach / np.sqrt(FLIGHTS) + 0.01
    y, z = np.concatenate([np.stack([c.x, c.y]) for c in curves(task)[:FLIGHTS]], axis=1)
    expected = np.polyfit(y, z, 2)
    assert [task[name].value for name in "abc"] == pytest.approx(expected.tolist(), rel=1e-9)
    assert task["E"].value == pytest.approx(np.sum((z - np.polyval(expected, y)) ** 2), rel=1e-9)


def test_1_a_flight_in_mujoco_is_the_ballistic_parabola():
    flight = fly()
    y, z = flight.points.T
    assert y.size == 20
    assert np.abs(np.polyval(flight.coefficients, y) - z).max() < 1e-9


def test_2_backward_difference_is_half_a_sample_late(done):
    near(done["2"]["largest error of the backward difference"], 1e-3)
    time = curves(done["2"])[0].x
    assert (time.size, time[0], time[-1]) == (6284, 0.0, pytest.approx(6.283))
    assert num_derivative(np.array([3.0]), 1.0).tolist() == [0.0]
    assert num_derivative(np.array([]), 1.0).size == 0
    assert num_derivative(np.array([1.0, 3.0, 2.0]), 0.5).tolist() == [0.0, 4.0, -2.0]


def test_3_and_4_torque_constant_is_exact(done):
    assert done["3"]["kT from stall"].value == pytest.approx(1.4 / 1.8, rel=1e-15)
    assert done["3"]["kT from peak"].value == pytest.approx(3.5 / 5.7, rel=1e-15)
    rig = lab_rig()
    a, b, c = (done["4"][name].value for name in "abc")
    assert b == 0.0
    assert a * 1.8**2 + c == pytest.approx(1.4 / 1.8, rel=1e-14)
    assert a * 5.7**2 + c == pytest.approx(3.5 / 5.7, rel=1e-14)
    _, _, constant = datasheet_points(rig)
    assert (constant.curvature, constant.constant) == (a, c)
    curve = curves(done["4"])[0]
    assert (curve.x[0], curve.x[-1], np.all(np.diff(curve.y) < 0.0)) == (0.0, 5.7, True)


FOUR = ["speed ω / (rad/s)", "acceleration α / (rad/s²)", "filtered α_filt / (rad/s²)", "torque M / (N·m)"]


def test_5_and_7_four_signals_on_one_time_axis_in_si(done):
    for key in ("5", "7"):
        (drawn,) = done[key].charts
        assert [panel.y_label for panel in drawn.panels] == FOUR
        assert {panel.x_label for panel in drawn.panels} == {"time / s"}
        assert 100.0 < done[key]["largest speed"].value < 200.0
        assert 2.0 < done[key]["largest torque"].value < 3.5
        (speed,), (filtered,) = (curves(done[key], panel=k) for k in (0, 2))
        assert filtered.x == pytest.approx(speed.x[2:-2])
        assert filtered.y == pytest.approx((speed.y[4:] - speed.y[:-4]) / 4e-3, rel=1e-6, abs=1e-6)


def test_8_the_remaining_samples_lie_over_the_four_graphs_of_task_7(done):
    (drawn,) = done["8"].charts
    assert [panel.y_label for panel in drawn.panels] == FOUR
    for place in range(4):
        original, remaining = curves(done["8"], panel=place)
        (whole,) = curves(done["7"], panel=place)
        assert (original.x.tolist(), original.y.tolist()) == (whole.x.tolist(), whole.y.tolist())
        at = np.searchsorted(whole.x, remaining.x)
        assert remaining.y == pytest.approx(whole.y[at])
        assert remaining.x.size == done["8"]["samples remaining"].value
    speed, fast = curves(done["8"])
    assert np.count_nonzero(np.abs(speed.y[2:-2]) >= 20.0) == fast.x.size
    assert np.abs(fast.y).min() >= 20.0


def test_6_inertia_within_half_a_percent(done):
    near(done["6"]["J"], 0.005)
    near(done["6"]["J_load"], 0.005)
    mass = 7850.0 * np.pi / 4.0 * (0.14**2 - 0.014**2) * 0.0065
    theory = 1e4 * mass / 8.0 * (0.14**2 + 0.014**2)
    assert done["6"]["J_load, theory"].value == pytest.approx(theory, rel=1e-12)
    assert 0.10 < done["6"]["J_load"].value / theory - 1.0 < 0.20
    text = " ".join(done["6"].findings)
    assert "In which unit?" in text
    measured, modelled = curves(done["6"])
    residual = curves(done["6"], 0, 1)[0]
    assert residual.y == pytest.approx(measured.y - modelled.y)
    assert f"{done['6']['RMS of M - J·α'].value:.3g} N·m" in text


def test_9_inertia_within_half_a_percent_and_friction_within_three(done):
    near(done["9"]["J"], 0.005)
    near(done["9"]["J_load"], 0.005)
    near(done["9"]["K_fric_w"], 0.03)
    near(done["9"]["K_fric_0"], 0.03)
    assert done["9"]["J_load"].value == pytest.approx(done["6"]["J_load"].value, rel=0.005)
    assert done["9"]["E"].value < 2.0


def test_9_the_torque_is_reconstructed_for_all_samples(done):
    measured, estimated = curves(done["9"])
    assert estimated.x.size == measured.x.size == curves(done["7"])[0].x.size
    assert done["9"]["samples of M_est"].value == measured.x.size
    off = np.sqrt(np.mean((measured.y - estimated.y) ** 2))
    assert done["9"]["RMS of M - M_est, all samples"].value == pytest.approx(off)
    (sentence,) = [finding for finding in done["9"].findings if "of the torque; over the fitted samples" in finding]
    assert float(re.search(r"([\d.]+) ?% of the torque", sentence)[1]) < 10.0


def test_8_the_filtered_acceleration_is_in_step_with_the_speed(done):
    assert done["8"]["alpha_filt late, on t_sync"].value == pytest.approx(0.0, abs=0.01)
    assert done["8"]["alpha_filt late, as it comes"].value == pytest.approx(2.0, abs=0.05)
    time = 1e-3 * np.arange(4000)
    speed = 100.0 * np.sin(7.0 * time) + 0.02 * np.random.default_rng(1).standard_normal(time.size)
    run = LabRun(time, speed, 0.0 * time, num_derivative(speed, 1e-3), 0.0 * time, 1e-3)
    for late in (0, 1, 2):
        assert lateness(run, late) == pytest.approx(late, abs=0.01)


def test_10_peak_torque_and_corner(done):
    near(done["10"]["peak torque"], 0.005)
    near(done["10"]["measured corner"], 0.002)
    assert done["10"]["datasheet's corner"].value == pytest.approx(2100.0)
    measured, sheet, *_ = curves(done["10"])
    assert measured.y.min() >= 0.2
    assert measured.y[0] > 3.0
    assert np.stack([sheet.x, sheet.y], axis=1) == pytest.approx(np.array([[0.0, 3.5], [2100.0, 3.5], [5000.0, 0.0]]))


def test_10_table_of_peak_torque_and_the_tail(done):
    task, rig = done["10"], lab_rig()
    speeds = [n.name for n in task.tabled if n.name.endswith("rpm")]
    assert [name.split()[-2] for name in speeds] == ["0", "1000", "2000", "2100", "3000", "4000"]
    (table,) = task.tables
    assert [column.heading for column in table.columns][1:] == ["0", "1000", "2000", "2100", "3000", "4000", "5000"]
    assert table.rows[0][1:] == ("3.5", "3.5", "3.5", "3.5", "2.41", "1.21", "0")
    assert table.rows[1][-1] == "-"
    assert task["M_max at 5000 rpm, datasheet"].value == 0.0
    for name in speeds:
        speed = float(name.split()[-2])
        sheet = 3.5 * min(1.0, (5000.0 - speed) / 2900.0)
        assert task[f"{name}, datasheet"].value == pytest.approx(sheet)
    assert task["M_max at 2100 rpm"].value == pytest.approx(rig.motor.peak_torque, rel=2e-3)
    (slowest,) = [text for text in task.findings if "M_max at 0 rpm" in text]
    samples = re.search(r"of (\d+) samples from (\d+) to (\d+) rpm", slowest)
    assert 0 < int(samples[2]) <= int(samples[3]) <= 48  # 5 rad/s are 48 rpm
    assert any("tail above" in text and "set to about 44" in text for text in task.findings)


@pytest.mark.parametrize("lag", [0.0, 1e-3, 3e-3, 8e-3])
def test_10_the_corner_is_where_the_decline_begins_whatever_the_lag(lag):
    """Against an integrator of the circuit: U = R*I + L*dI/dt + Ke*w, with noise as the lab's."""
    ke, resistance, voltage, peak, inertia = 0.76, 28.0, 398.0, 5.7, 2.2e-3
    corner = (voltage - resistance * peak) / ke

    def rates(t, state):
        speed, current = state
        wanted = min(peak, (voltage - ke * speed) / resistance)
        return [0.75 * current / inertia, (wanted - current) / max(lag, 2e-5)]

    time = np.arange(0.0, 0.45, 1e-3)
    speed, current = solve_ivp(rates, (0.0, 0.45), [0.0, peak], "LSODA", time, rtol=1e-9, atol=1e-9).y
    random = np.random.default_rng(3)
    noisy = current + 0.005 * random.standard_normal(time.size), speed + 0.026 * random.standard_normal(time.size)
    found = decline(noisy[1], noisy[0], 1e-3)
    print(f"lag {lag * 1e3:g} ms: corner {(found.corner - corner) * RPM:+.2f} rpm, lag {found.lag * 1e3:.2f} ms")
    assert found.corner == pytest.approx(corner, abs=13.0 / RPM)  # one sample of the run-up
    assert found.lag == pytest.approx(lag, abs=0.7e-3)
    assert found.no_load == pytest.approx(voltage / ke, rel=2e-3)
    if lag >= 3e-3:  # the line through the fall takes the lag for a shift
        assert extrapolated_corner(noisy[1], noisy[0]) - corner > 20.0 / RPM


def test_10_a_run_up_that_was_filtered_or_never_declines_has_no_corner():
    """A winding's L/R is a few milliseconds: of a current that falls 14 ms late something else is the cause."""
    speed, lag = 3.0 * np.arange(170.0), np.exp(-np.arange(170) / 14.0) / 14.5
    late = np.convolve(np.minimum(5.7, (398.0 - 0.76 * speed) / 28.0) - 5.7, lag) + 5.7
    with pytest.raises(UndeterminedError, match=r"falls 1\d ms late"):
        decline(speed, late[:170], 1e-3)
    with pytest.raises(UndeterminedError):
        decline(speed, np.full(170, 5.7), 1e-3)
