"""What symmetry, dimensions and order ask of an identified axis, held under axes and motions that are drawn."""

from dataclasses import replace

import numpy as np
import pytest

from bench.fit.identify import identify
from bench.rig.rig import Rig
from bench.trace.read import read
from bench.trace.trace import Trace
from tests.fit.motions import NAMES, RIG, UNITS, Truth, recording

SEEDS = range(3)
#: Given where the law is not about it, which takes a fifth of the time - Hz.
CUTOFF = 60.0


def drawn(seed, **more):
    """Recording of a random axis; noise in proportion to its torque."""
    rng = np.random.default_rng(seed)
    inertia, viscous, coulomb = 10.0 ** rng.uniform((-3.3, -3.5, -1.6), (-2.3, -2.5, -0.8))
    return recording(rng, Truth(inertia, viscous, coulomb), duration=4.0, torque_noise=0.1 * coulomb, **more)


def scaled(trace, time=1.0, origin="scaled", **signals):
    """The recording with its time and some signals times a number."""
    changed = {name: values * signals.get(name, 1.0) for name, values in trace.signals.items()}
    return Trace(trace.time * time, changed, UNITS, origin)


def assert_alike(found, expected, factors=(1.0, 1.0, 1.0), rel=1e-9, sigmas=0.0):
    """Each parameter and its error is the expected one's times its factor."""
    for name, factor in zip(NAMES, factors, strict=True):
        here, there = found[name], expected[name]
        reach = max(rel * abs(there.value), sigmas * there.std_error)
        assert here.value / factor == pytest.approx(there.value, rel=0.0, abs=reach), name
        assert here.std_error / factor == pytest.approx(there.std_error, rel=max(rel, sigmas)), name


@pytest.mark.parametrize("seed", SEEDS)
def test_a_mirrored_recording_gives_the_same_axis(seed):
    trace = drawn(seed, shift=0.2e-3, position=True)
    mirrored = scaled(trace, **dict.fromkeys(trace.signals, -1.0))
    assert_alike(identify(mirrored, RIG), identify(trace, RIG))


@pytest.mark.parametrize("seed", SEEDS)
def test_a_slower_clock_scales_inertia_by_its_square_and_viscous_friction_by_itself(seed):
    """M = J*alpha + K_w*omega + K_0*sgn(omega) keeps its torque, its speed falls, its acceleration falls twice."""
    trace, factor = drawn(seed), float(np.random.default_rng(seed).uniform(1.2, 2.0))
    slower = scaled(trace, time=factor, velocity=1.0 / factor)
    found = identify(slower, RIG, CUTOFF / factor)
    assert_alike(found, identify(trace, RIG, CUTOFF), (factor**2, factor, 1.0), sigmas=0.02)


@pytest.mark.parametrize("seed", SEEDS)
def test_current_and_torque_constant_go_against_each_other(seed):
    trace, factor = drawn(seed), float(np.random.default_rng(seed).uniform(0.2, 5.0))
    motor = RIG.motor.model_copy(update={"torque_constant": RIG.motor.torque_constant / factor})
    found = identify(scaled(trace, current=factor), RIG.model_copy(update={"motor": motor}))
    assert_alike(found, identify(trace, RIG))


@pytest.mark.parametrize("seed", SEEDS)
def test_an_axis_that_is_heavier_in_everything_takes_as_much_more_current(seed):
    trace, factor = drawn(seed), float(np.random.default_rng(seed).uniform(0.5, 5.0))
    assert_alike(identify(scaled(trace, current=factor), RIG), identify(trace, RIG), (factor,) * 3)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_constant_load_changes_the_offset_alone(seed):
    """Inertia, friction, their errors, the residual and its floor are those without the load."""
    trace, rig = drawn(seed), RIG.model_copy(update={"offset": True})
    loaded = replace(trace, signals={**trace.signals, "current": trace["current"] + 0.3})
    found, without = identify(loaded, rig, CUTOFF), identify(trace, rig, CUTOFF)
    assert_alike(found, without, rel=1e-6)
    offset, before = (each["torque_offset"].value for each in (found, without))
    assert offset - before == pytest.approx(0.3 * RIG.motor.torque_constant, rel=1e-6)
    assert found.residual.rms == pytest.approx(without.residual.rms, rel=1e-6)
    assert found.residual.noise_floor == pytest.approx(without.residual.noise_floor, rel=1e-3)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_load_behind_a_gear_has_the_kinetic_energy_that_rotor_and_gear_leave(seed):
    """J*omega**2 = (J_rotor + J_gear)*omega**2 + J_load*(omega/i)**2, to the ends of its interval."""
    trace, rng = drawn(seed), np.random.default_rng(seed)
    ratio, rotor, gear = float(rng.uniform(2.0, 20.0)), 1e-4, float(rng.uniform(0.5e-4, 1.5e-4))
    table = {"motor": {"torque_constant": 0.8, "rotor_inertia": rotor}, "load": {"gear_ratio": ratio}}
    table["load"]["gear_inertia"] = gear
    found = identify(trace, Rig(**table), CUTOFF)
    whole, load = found["moment_of_inertia"], found["load_moment_of_inertia"]
    behind = np.array([load.value, *load.ci95]) / ratio**2
    assert behind + rotor + gear == pytest.approx([whole.value, *whole.ci95], rel=1e-9)
    assert load.std_error / ratio**2 == pytest.approx(whole.std_error, rel=1e-9)


@pytest.mark.parametrize("order", [(2, 1, 0), (1, 2, 0), (2, 0, 1)])
def test_the_order_of_recordings_does_not_matter(order):
    rng, truth = np.random.default_rng(0), Truth()
    runs = [recording(rng, replace(truth, inertia=truth.inertia * share), duration=3.0) for share in (0.98, 1.0, 1.03)]
    there, back = identify(runs, RIG, CUTOFF), identify([runs[k] for k in order], RIG, CUTOFF)
    assert_alike(back, there)
    assert back.residual.rms == pytest.approx(there.residual.rms)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_order_of_columns_does_not_matter(seed, tmp_path):
    """Columns that nothing needs are among them, and such as hold the same signal in another form."""
    trace, rng = drawn(seed, position=True), np.random.default_rng(seed)
    columns = {
        "time [ms]": 1e3 * trace.time,
        "velocity [deg/s]": np.rad2deg(trace["velocity"]),
        "position [deg]": np.rad2deg(trace["position"]),
        "current [mA]": 1e3 * trace["current"],
        "torque [N*m]": 0.8 * trace["current"],
        "note [V]": rng.normal(size=trace.time.size),
        "temperature [K]": np.full(trace.time.size, 300.0),
    }
    found = []
    for order in (list(columns), rng.permutation(list(columns))):
        rows = np.stack([columns[name] for name in order], axis=1)
        np.savetxt(tmp_path / "x.csv", rows, delimiter=",", header=",".join(order), comments="")
        found.append(identify(read(tmp_path / "x.csv"), RIG, CUTOFF))
    assert found[0] == found[1]


def test_more_noise_widens_the_intervals():
    """In the median over seeds: threefold noise, threefold intervals."""
    ratios = []
    for seed in range(8):
        quiet, loud = (
            identify(recording(np.random.default_rng(seed), duration=4.0, torque_noise=noise), RIG, CUTOFF)
            for noise in (0.02, 0.06)
        )
        ratios.append([loud[name].std_error / quiet[name].std_error for name in NAMES])
    median = np.median(ratios, axis=0)
    print(f"\nintervals under threefold noise: {median} times as wide (J, viscous, Coulomb)")
    assert (median > 2.0).all()
    assert (median < 4.0).all()


def test_friction_that_there_is_none_of_is_zero_within_its_errors_on_either_side():
    """A value below zero is no refusal as long as its interval reaches above."""
    deviations = []
    for seed in range(8):
        found = identify(recording(np.random.default_rng(seed), Truth(viscous=0.0), duration=3.0), RIG, CUTOFF)
        one = found["viscous_friction_coefficient"]
        deviations.append(one.value / one.std_error)
    assert -3.5 < min(deviations) < 0.0 < max(deviations) < 3.5
