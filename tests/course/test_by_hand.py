"""Tasks on recordings made by hand, whose answers need no computing: limits, signs, what is left out."""

import math
from pathlib import Path

import numpy as np
import pytest

from bench.course import friction, inertia, methods, peak_torque
from bench.course.axis import Sources, lab_rig
from bench.course.methods import RPM
from bench.course.record import draw_rig
from bench.course.recordings import LabRecordings, LabRun
from bench.errors import UndeterminedError
from bench.report.drive import in_range
from bench.rig.rig import Rig
from tests.course.drawn import curves

PERIOD = 1e-3
INERTIA, VISCOUS, COULOMB = 2e-3, 1e-3, 0.08


def recordings_of(**runs):
    """Recordings of the lab's axis that hold these runs."""
    found = LabRecordings(Path("by hand"), lab_rig(), Sources.of(None))
    vars(found).update(runs)  # in the place of what would be read
    return found


def run_of(velocity, torque):
    """A recording of speed - rad/s - and torque - N*m."""
    velocity, torque = (np.asarray(signal, dtype=np.float64) for signal in (velocity, torque))
    time = PERIOD * np.arange(velocity.size)
    return LabRun(time, velocity, torque / 0.75, methods.num_derivative(velocity, PERIOD), torque, PERIOD)


def there_and_back(backward):
    """A motion of 1000 samples, this share of those faster than 20 rad/s backward, and its exact torque."""
    count = round(1000 * backward)
    forward = 60.0 + 30.0 * np.sin(0.03 * np.arange(1000 - count))
    velocity = np.concatenate([forward, -60.0 - 30.0 * np.sin(0.05 * np.arange(count))])
    # alpha_filt of task 8 by its definition: four differences around a sample
    alpha = np.zeros(velocity.size)
    alpha[2:-2] = (velocity[4:] - velocity[:-4]) / (4.0 * PERIOD)
    return run_of(velocity, INERTIA * alpha + VISCOUS * velocity + COULOMB * np.sign(velocity))


def test_6_what_the_load_is_beside_its_theory():
    """J = 20 kg*cm**2 less a rotor of 0.25 over a disk of 18.9578: 4.178 % more."""
    numbers, findings = inertia.load_inertia(20e-4, 0.1e-4, recordings_of(), true=22.5)
    load, theory = numbers
    disk = 1e4 * math.pi / 32.0 * 7850.0 * 0.0065 * (0.14**4 - 0.014**4)
    assert (load.value, load.truth) == pytest.approx((19.75, 22.25), rel=1e-12)
    assert theory.value == pytest.approx(disk, rel=1e-12)
    assert f"{19.75 / disk - 1.0:+.2%} off" in findings[1]
    for negative in (0.0, -1e-3, math.nan):
        with pytest.raises(UndeterminedError, match="opposite signs"):
            inertia.require_positive(negative)


def test_6_inertia_is_the_mean_over_a_quarter_of_the_largest_acceleration_and_more():
    """Steps of speed that make alpha 40, 10, -40 and 9.99 rad/s**2; the last is below a quarter."""
    steps = np.array([0.0, 0.04, 0.01, -0.04, 0.00999])
    alpha = steps / PERIOD
    run = run_of(np.cumsum(steps), alpha * [1.0, 1e-3, 3e-3, 2e-3, 0.5])
    task = inertia.inertia_without_friction(recordings_of(without_friction=run))
    assert task["alpha_max"].value == pytest.approx(40.0)
    assert task["J"].value == pytest.approx(1e4 * 2e-3, rel=1e-9)
    assert task.findings[0].startswith("3 of 5 samples")
    # J*alpha leaves 40, 0 and 40 times a thousandth
    assert task["RMS of M - J·α"].value == pytest.approx(math.sqrt((0.01**2 + 0.04**2) / 3.0), rel=1e-9)


@pytest.mark.parametrize(("backward", "enough"), [(0.017, False), (0.023, True), (0.977, True), (0.983, False)])
def test_9_both_directions_are_needed_by_a_fiftieth_of_the_samples(backward, enough):
    run = there_and_back(backward)
    if enough:
        assert friction.identify_friction(run).coulomb == pytest.approx(COULOMB, rel=1e-9)
    else:
        with pytest.raises(UndeterminedError, match="one way only"):
            friction.identify_friction(run)


def test_9_what_is_exact_is_found_and_reconstructed_exactly():
    run = there_and_back(0.4)
    found = friction.identify_friction(run)
    assert (found.inertia, found.viscous, found.coulomb) == pytest.approx((INERTIA, VISCOUS, COULOMB), rel=1e-9)
    assert found.error == pytest.approx(0.0, abs=1e-15)
    bare = run_of(run.velocity, 1.5e-3 * run.acceleration)  # 15 kg*cm**2 in task 6
    task = friction.inertia_and_friction(recordings_of(with_friction=run, without_friction=bare))
    assert f"J_load is {19.75 / 14.75 - 1.0:+.2%} off the one of task 6, +5 ±" in task.findings[3]
    assert "the two contradict each other" in task.findings[3]
    measured, estimated = curves(task)
    inner = slice(2, -2)  # at the ends the filter has no samples, and another derivative stands in
    assert estimated.y[inner] == pytest.approx(measured.y[inner], abs=1e-12)
    assert task["J_load"].value == pytest.approx(1e4 * INERTIA - 0.25, rel=1e-9)


def test_10_the_run_up_begins_at_full_torque_and_leaves_out_what_is_below_a_fifth_of_a_newton_metre():
    torque = [0.5, 2.5, 2.99, 3.01, 2.0, 3.4, 0.21, 0.19, -1.0, 0.2]
    kept = methods.kept_samples(np.array(torque), 3.5)
    assert np.flatnonzero(kept).tolist() == [3, 4, 5, 6, 9]
    with pytest.raises(UndeterminedError, match=r"reaches 2\.99"):
        peak_torque.run_up(run_of(np.arange(3.0), torque[:3]), lab_rig())


def test_10_a_row_of_the_table_is_the_median_within_five_radians_a_second_on_the_way_up():
    at = 2000.0 / RPM
    velocity = np.array([at - 5.1, at - 4.9, at, at + 4.9, at + 5.1, 400.0, at, at])
    torque = np.array([9.0, 3.1, 1.0, 2.0, 9.0, 0.5, 7.0, 7.0])
    measured = methods.torque_at_speeds(velocity, torque)
    assert methods.SPEEDS == (0.0, 1000.0, 2000.0, 2100.0, 3000.0, 4000.0, 5000.0)
    assert measured[2] == 2.0
    assert np.isnan(measured).tolist() == [True, True, False, *[True] * 4]


def test_range_of_a_motion_at_one_speed():
    """2 N*m at 1000 rpm, driving and braking: 1.5 N*m to the peak either way, and drawn below zero where it brakes."""
    velocity, torque = np.full(4, 1000.0 / RPM), np.array([2.0, -2.0, 2.0, -1.0])
    for way in (1.0, -1.0):
        found = in_range(lab_rig(), way * velocity, torque, "by hand")
        assert found.numbers["peak reserve, 230 V, 400 V, 230 V cold, 400 V cold"] == (pytest.approx(1.5), "N·m")
        assert found.numbers["RMS torque"] == (pytest.approx(math.sqrt(13.0 / 4.0)), "N·m")
        motion, heat, least = found.chart.panels[0].series[:3]
        assert (motion.x, motion.y) == (pytest.approx([1000.0] * 4), tuple(way * torque))
        assert heat.x == pytest.approx([1000.0])
        assert (least.y, least.high) == ((2.0 * way,), pytest.approx((3.5 * way,)))


def test_a_students_axis_is_a_tenth_to_a_fifth_beyond_its_disks_theory():
    for seed in range(20):
        rig = Rig.of(draw_rig(np.random.default_rng(seed)))
        load = rig.simulation.moment_of_inertia - rig.motor.rotor_inertia
        assert 0.0999 < load / rig.load.disk_inertia - 1.0 < 0.2001
