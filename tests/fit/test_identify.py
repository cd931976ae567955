"""Recovery, symmetry and refusals of the default estimator on recordings in closed form."""

import numpy as np
import pytest

from bench.errors import InputError, UndeterminedError
from bench.fit.estimate import RefusedEstimateError
from bench.fit.hypothesis import Hypothesis, lay_out
from bench.fit.identify import identify
from bench.fit.lab import identify_as_in_the_lab
from bench.fit.rows import Rows
from bench.trace.trace import Trace
from tests.fit.motions import NAMES, RIG, UNITS, Truth, recording


def errors(estimate, truth):
    return np.array([estimate[name].value / value - 1.0 for name, value in zip(NAMES, truth.values, strict=True)])


@pytest.mark.parametrize("position", [False, True])
def test_without_noise_the_truth_comes_back(position):
    truth = Truth()
    trace = recording(np.random.default_rng(0), truth, torque_noise=0.0, velocity_noise=0.0, position=position)
    assert np.abs(errors(identify(trace, RIG), truth)).max() < 1e-5


def test_a_shift_below_a_sample_is_found_and_leaves_friction_alone():
    truth, shift = Truth(), 0.3e-3
    trace = recording(np.random.default_rng(1), truth, torque_noise=1e-3, velocity_noise=1e-3, shift=shift)
    found = identify(trace, RIG)
    assert found["misalignment"].value == pytest.approx(shift, rel=0.02)
    assert np.abs(errors(found, truth)).max() < 2e-3


def test_an_offset_is_fitted_when_the_rig_asks_for_it():
    truth = Truth(offset=0.05)
    trace = recording(np.random.default_rng(2), truth, torque_noise=1e-3, velocity_noise=1e-3)
    found = identify(trace, RIG.model_copy(update={"offset": True}))
    assert found["torque_offset"].value == pytest.approx(0.05, rel=5e-3)
    assert np.abs(errors(found, truth)).max() < 5e-3


def test_inertia_stays_unbiased_where_speed_noise_rivals_the_acceleration():
    """A slow motion under coarse speed: plain least squares would draw J towards zero by the noise's share."""
    truth, ratio, plain = Truth(), [], []
    rng = np.random.default_rng(3)
    for _ in range(20):
        trace = recording(rng, truth, speed=0.05, velocity_noise=0.1, torque_noise=1e-4, duration=4.0)
        found = identify(trace, RIG, cutoff=60.0)
        ratio.append(found["moment_of_inertia"].value / truth.inertia)
        plain.append(identify_as_plain(trace) / truth.inertia)
    print(f"\nJ over truth: {np.mean(ratio):.4f} with the noise taken out, {np.mean(plain):.4f} without")
    assert abs(np.mean(ratio) - 1.0) < 0.02
    assert np.mean(plain) < 0.97


def identify_as_plain(trace):
    """J by least squares on the same columns without taking the noise out."""
    laid = lay_out(Rows.of(trace, RIG, cutoff=60.0), Hypothesis())
    return np.linalg.lstsq(laid.columns, laid.effort, rcond=None)[0][0]


def test_the_start_of_time_does_not_matter():
    trace = recording(np.random.default_rng(5))
    late = Trace(trace.time + 1000.0, trace.signals, UNITS, "late")
    for name in NAMES:
        assert identify(late, RIG)[name].value == pytest.approx(identify(trace, RIG)[name].value, rel=1e-6)


def test_parts_give_what_the_whole_gives():
    trace = recording(np.random.default_rng(6), duration=40.0)
    parts = [trace.between(start, start + 10.0) for start in (0.0, 10.0, 20.0, 30.0)]
    whole, joined = identify(trace, RIG), identify(iter(parts), RIG)
    for name in NAMES:
        assert abs(joined[name].value - whole[name].value) < 0.3 * whole[name].std_error
        assert joined[name].std_error == pytest.approx(whole[name].std_error, rel=0.1)


@pytest.mark.parametrize("still", [60, 3000])
def test_a_part_without_clear_motion_contributes_no_rows(still):
    """A short end, or an axis that stands still for a while: both are in parts what they are in the whole."""
    trace, rng = recording(np.random.default_rng(6), duration=20.0), np.random.default_rng(7)
    time = np.arange(20000 + still) * 1e-3
    rest = {"velocity": rng.normal(scale=0.03, size=still), "current": rng.normal(scale=0.0125, size=still)}
    signals = {name: np.concatenate([values, rest[name]]) for name, values in trace.signals.items()}
    longer = Trace(time, signals, UNITS, "longer")
    cut = [longer.between(0.0, 10.0), longer.between(10.0, 20.0), longer.between(20.0, np.inf)]
    whole, parts, moving = (identify(of, RIG, cutoff=66.0) for of in (longer, iter(cut), iter(cut[:2])))
    assert parts.samples_read == whole.samples_read == 20000 + still
    for name in NAMES:
        assert parts[name].value == pytest.approx(moving[name].value, rel=1e-9)
        assert abs(parts[name].value - whole[name].value) < 0.3 * whole[name].std_error


def test_a_recording_may_begin_with_a_part_that_stands_still():
    """Its filter is that of the first part that moves; the noise of an axis at rest is none of the balance."""
    trace, rng = recording(np.random.default_rng(6), duration=10.0), np.random.default_rng(7)
    rest = {"velocity": rng.normal(scale=0.03, size=5000), "current": rng.normal(scale=0.0125, size=5000)}
    still = Trace(trace.time[:5000] - 5.0, rest, UNITS, "still")
    moving, late = identify(trace, RIG), identify(iter([still, trace]), RIG)
    assert late.samples_read == moving.samples_read + 5000
    for name in NAMES:
        assert late[name] == moving[name]
    with pytest.raises(UndeterminedError):
        identify(iter([still, still]), RIG)


def test_a_first_part_in_one_direction_leaves_the_offset_to_the_others():
    """What tolerances and cut-off say of the first part holds for the friction that it knows, offset included."""
    truth, rig = Truth(offset=0.02), RIG.model_copy(update={"offset": True})
    whole = recording(np.random.default_rng(14), truth, duration=40.0)
    there = recording(np.random.default_rng(15), truth, duration=10.0, speed=0.5, bias=300.0)
    there = Trace(there.time - 10.0 - 1e-3, there.signals, UNITS, "there")
    found = identify(iter([there, whole]), rig)
    assert found["torque_offset"].value == pytest.approx(0.02, rel=0.1)
    assert np.abs(errors(found, truth)).max() < 0.02


def test_a_hole_costs_its_samples_and_nothing_else():
    truth, trace = Truth(), recording(np.random.default_rng(7), duration=10.0)
    kept = (trace.time < 3.0) | (trace.time > 4.2)
    holed = Trace(trace.time[kept], {k: v[kept] for k, v in trace.signals.items()}, UNITS, "holed")
    assert len(holed.segments) == 2
    assert np.abs(errors(identify(holed, RIG), truth)).max() < 0.02


def test_the_default_is_better_than_the_labs_in_every_measure():
    rng, truth = np.random.default_rng(8), Truth()
    ours, labs = [], []
    for _ in range(12):
        trace = recording(rng, truth)
        ours.append(errors(identify(trace, RIG), truth))
        labs.append(errors(identify_as_in_the_lab(trace, RIG), truth))
    ours_rms, labs_rms = (np.sqrt(np.mean(np.square(found), axis=0)) for found in (ours, labs))
    print(f"\nRMS errors J, viscous, Coulomb: default {ours_rms}, lab {labs_rms}")
    assert (ours_rms < labs_rms).all()


def test_current_alone_is_identified_in_amperes():
    rig = RIG.model_copy(update={"motor": type(RIG.motor)()})
    found = identify(recording(np.random.default_rng(10)), rig)
    assert found["moment_of_inertia"].unit == "A*s**2/rad"
    assert found["moment_of_inertia"].value == pytest.approx(1.5e-3 / 0.8, rel=5e-3)
    assert "load_moment_of_inertia" not in found.parameters


def steady(speeds, seconds=2.0):
    """Speeds held one after the other, with ramps of 0.1 s between them."""
    time = np.arange(round(len(speeds) * seconds * 1000)) * 1e-3
    knots = [edge for k in range(len(speeds)) for edge in (k * seconds + 0.1, (k + 1) * seconds)]
    return time, np.interp(time, knots, np.repeat(speeds, 2))


def noisy(time, velocity, torque, seed=0):
    rng = np.random.default_rng(seed)
    signals = {"velocity": velocity + rng.normal(scale=0.03, size=time.size)}
    signals["current"] = (torque + rng.normal(scale=0.01, size=time.size)) / 0.8
    return Trace(time, signals, UNITS, "steady")


def constant_speed():
    time = np.arange(5000) * 1e-3
    return noisy(time, np.full(time.size, 50.0), np.full(time.size, 0.1))


def one_speed_both_ways():
    time, velocity = steady([50.0, -50.0] * 4, seconds=1.0)
    kept = np.abs(velocity) > 49.99
    torque = 1.5e-3 * np.gradient(velocity, 1e-3) + 8e-4 * velocity + 0.06 * np.sign(velocity)
    return noisy(time[: kept.sum()], velocity[kept], torque[kept])


def turned_sensor():
    trace = recording(np.random.default_rng(13))
    return trace.with_signals({"current": -trace["current"]}, {})


@pytest.mark.parametrize(
    ("trace", "error", "says"),
    [
        (constant_speed, UndeterminedError, r"moment of inertia cannot be determined.*record instead: .*accel"),
        (one_speed_both_ways, UndeterminedError, "record instead"),
        (lambda: noisy(1e-3 * np.arange(3000), *np.zeros((2, 3000))), UndeterminedError, "record instead"),
        (
            lambda: recording(np.random.default_rng(11), speed=0.5, bias=300.0),
            UndeterminedError,
            r"Coulomb friction torque and torque offset.*forward only",
        ),
        (lambda: recording(np.random.default_rng(12), duration=0.05), UndeterminedError, r"at least \d+ samples"),
        (turned_sensor, InputError, r"inertia and friction are negative.*opposite signs"),
        (lambda: iter([]), InputError, "found none; allowed: an iterator over one Trace or more"),
    ],
    ids=["one speed", "one speed both ways", "at rest", "one way", "short", "turned sensor", "nothing"],
)
def test_what_does_not_determine_an_axis_is_refused(trace, error, says):
    with pytest.raises(error, match=says):
        identify(trace(), RIG)


@pytest.mark.parametrize(
    ("truth", "says", "negative", "reported"),
    [
        (Truth(inertia=-1.5e-3), "moment of inertia", True, {*NAMES}),
        (Truth(coulomb=-0.06), "Coulomb .*", False, {*NAMES[:2]}),
    ],
)
def test_what_comes_out_below_zero_is_refused_and_reported(truth, says, negative, reported):
    with pytest.raises(RefusedEstimateError, match=f"{says} cannot be determined: it comes out negative") as refused:
        identify(recording(np.random.default_rng(13), truth), RIG)
    found = refused.value.estimate.parameters
    assert {*NAMES} & {*found} == reported and (found[NAMES[0]].value < 0.0) == negative


@pytest.mark.parametrize("whole", [np.round, np.trunc])
@pytest.mark.parametrize("seed", range(3))
def test_a_coarse_current_that_turns_with_the_speed_leaves_friction_open_by_half_a_step(seed, whole):
    made = recording(np.random.default_rng(seed), duration=8.0, torque_noise=6e-3, velocity_noise=3e-4, speed=0.008)
    step, constant = 0.015, 0.8  # four steps of friction; along so slow a motion the torque has the speed's sign
    current = step * whole(made["current"] / step)
    found = identify(Trace(made.time, {**made.signals, "current": current}, UNITS, "coarse"), RIG)[NAMES[2]]
    low, high = found.ci95
    assert low < Truth().coulomb < high
    assert 0.25 * step * constant < 0.5 * (high - low) < step * constant
