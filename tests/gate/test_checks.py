"""Each check against recordings that are sound, and against the same damaged the one way it is for."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.gate import effort, losses, signals, timing, velocity, wraps
from bench.gate.gate import CHECKS, STEADY, UnanswerableError, gate, joined, passed, warnings_of
from bench.identify.regression import identify
from bench.trace.trace import Trace
from tests.gate.damage import changed, doubled, keeping, losing, stale, with_samples, without
from tests.independent.axes import PLAIN

NAMES = [
    "velocity_is_derivative_of_position",
    "position_wraps",
    "lost_samples",
    "time_is_regular",
    "signal_moves",
    "signal_clips",
    "resolution",
    "effort_follows_motion",
    "sampling_rate_plausible",
    "motor_constants_agree",
]


def test_the_gate_has_the_contracts_checks_and_a_sound_recording_passes_all(sound, rig):
    gated = gate(sound, rig)
    assert {check.name for check in gated.checks} == set(NAMES)
    assert {check.status for check in gated.checks} == {"pass"}
    assert gated.trace is sound
    assert warnings_of(gated.checks) == []


def test_without_a_rig_the_gate_asks_the_signals_alone(sound):
    by_name = {check.name: check.status for check in gate(sound).checks}
    assert by_name.pop("motor_constants_agree") == "not_applicable"
    assert set(by_name.values()) == {"pass"}
    alone = {check.name: check.status for check in gate(keeping(sound, ["position"])).checks}
    assert alone["position_wraps"] == "pass"
    assert alone["effort_follows_motion"] == "not_applicable"
    assert "fail" not in alone.values()


# velocity_is_derivative_of_position


@pytest.mark.parametrize("factor", [0.16, 0.5, 0.6, 6.0, -1.0, 0.88, 1.12, 180.0 / np.pi, 1e-20, 1e20])
def test_a_speed_of_another_scale_fails(sound, rig, factor):
    _, found = velocity.check(changed(sound, velocity=factor * sound["velocity"]), rig)
    assert found.status == "fail"
    assert float(found.found.split()[2]) == pytest.approx(factor, rel=1e-3)


@pytest.mark.parametrize(("factor", "status"), [(0.99, "pass"), (1.05, "warn"), (0.94, "warn")])
def test_a_speed_some_per_cent_off_is_told(sound, rig, factor, status):
    assert velocity.check(changed(sound, velocity=factor * sound["velocity"]), rig)[1].status == status


@pytest.mark.parametrize("lag", [0.5e-3, 2e-3, 20e-3])
def test_a_filtered_speed_is_late_and_no_other_scale(sound, rig, lag):
    alpha = np.exp(-sound.sample_period / lag)
    late = np.zeros(len(sound))
    for k in range(1, len(sound)):
        late[k] = alpha * late[k - 1] + (1.0 - alpha) * sound["velocity"][k]
    _, found = velocity.check(changed(sound, velocity=late), rig)
    assert found.status == "pass"


def test_an_offset_of_the_speed_is_no_other_scale(sound, rig):
    _, found = velocity.check(changed(sound, velocity=sound["velocity"] + 2.0), rig)
    assert found.status == "pass"


def test_the_speed_of_another_axis_fails(sound, rig):
    _, found = velocity.check(changed(sound, velocity=sound["velocity"][::-1].copy()), rig)
    assert found.status == "fail"


def test_a_standstill_compares_nothing(sound, rig):
    rng = np.random.default_rng(0)
    still = changed(sound, velocity=rng.normal(scale=0.02, size=len(sound)), position=np.zeros(len(sound)))
    assert velocity.check(still, rig)[1].status == "not_applicable"


# position_wraps


@pytest.mark.parametrize("period", [2.0 * np.pi, 1.0, 25.0, 2.0 * np.pi / 7.0])
def test_a_wrapped_position_runs_on_again(sound, rig, period):
    wrapped = changed(sound, position=np.mod(sound["position"] + 0.1, period) - 0.5 * period)
    mended, found = wraps.check(wrapped, rig)
    assert found.status == "pass"
    assert "undone" in found.found
    difference = mended["position"] - sound["position"]
    assert np.ptp(difference) < 1e-3 * period * np.ceil(np.ptp(sound["position"]) / period)
    assert mended.wraps is not None
    assert mended.wraps.period == pytest.approx(period, rel=1e-4)


@pytest.mark.parametrize("names", [("position", "current"), ("position", "velocity", "current")])
def test_a_wrapped_position_gives_the_same_inertia(sound, rig, names):
    wrapped = changed(sound, position=np.mod(sound["position"], 2.0 * np.pi))
    inertias = [identify(keeping(one, names), rig)["moment_of_inertia"].value for one in (sound, wrapped)]
    assert inertias[1] == pytest.approx(inertias[0], rel=1e-6)


def test_jumps_of_no_one_period_are_refused(sound, rig):
    position = sound["position"].copy()
    position[1000:] += 300.0
    position[3000:] -= 450.0
    with pytest.raises(InputError, match=r"position_wraps.*jumps 2 times"):
        passed(changed(sound, position=position), rig)


def test_a_position_elsewhere_after_a_hole_is_no_wrap(sound, rig):
    kept = np.r_[0:1000, 4000:4200]
    apart = Trace(sound.time[kept], {n: v[kept] for n, v in sound.signals.items()}, sound.units, sound.origin)
    shifted = changed(apart, position=apart["position"] + 1e3 * (np.arange(kept.size) >= 1000))
    mended, found = wraps.check(shifted, rig)
    assert found.status == "pass"
    assert mended.wraps is None


# lost_samples


@pytest.mark.parametrize("damage", [losing, stale, doubled])
@pytest.mark.parametrize("share", [0.001, 0.005])
@pytest.mark.parametrize("seed", range(3))
def test_lost_and_repeated_samples_are_put_right(sound, rig, damage, share, seed):
    damaged = damage(sound, share, seed)
    mended, found = losses.check(damaged, rig)
    assert found.status == "warn"
    assert identify(mended, rig)["moment_of_inertia"].value == pytest.approx(PLAIN.inertia, rel=0.01)


def test_each_place_of_a_loss_is_found(sound, rig):
    places = [900, 1800, 2700]
    kept = np.delete(np.arange(len(sound)), places)
    speed = np.abs(sound["velocity"][places])
    assert speed.min() > 5.0, "the axis has to move where samples are lost"
    damage = losses.damage_of(with_samples(sound, kept))
    assert np.flatnonzero(damage.missing).tolist() == [k - 1 - n for n, k in enumerate(places)]
    mended = losses.repaired(with_samples(sound, kept), damage)
    assert mended.time == pytest.approx(sound.time)
    assert np.abs(mended["position"] - sound["position"]).max() < 0.01 * np.abs(np.diff(sound["position"])).max()


def test_a_longer_loss_is_a_hole(sound, rig):
    kept = np.delete(np.arange(len(sound)), np.arange(1500, 1520))
    mended, found = losses.check(with_samples(sound, kept), rig)
    assert "20 samples lost" in found.found
    assert [part.stop for part in mended.segments] == [1500, len(sound) - 20]
    assert mended.time[-1] == pytest.approx(sound.time[-1])


def test_many_losses_are_refused(sound, rig):
    with pytest.raises(InputError, match="lost_samples"):
        passed(losing(sound, 0.03), rig)


def test_losses_that_no_speed_confirms_are_refused(sound, rig):
    alone = without(sound, "velocity")
    assert losses.check(alone, rig)[1].status == "pass"
    assert losses.check(losing(alone, 0.005), rig)[1].status == "fail"


# time_is_regular, sampling_rate_plausible


def test_times_that_jitter_are_told_and_irregular_ones_refused(sound, rig):
    rng = np.random.default_rng(0)
    jittering = sound.time + rng.uniform(-2e-4, 2e-4, len(sound))
    read = Trace.from_arrays({"time": jittering, **sound.signals}, {"time": "s", **sound.units})
    assert timing.regular(read, rig)[1].status == "warn"
    raw = Trace(jittering, sound.signals, sound.units, sound.origin)
    assert timing.regular(raw, rig)[1].status == "fail"


@pytest.mark.parametrize(
    "names", [("velocity", "current"), ("position", "velocity", "current"), ("position", "current")]
)
@pytest.mark.parametrize("factor", [1e3, 1e-3, 1e6])
def test_another_unit_of_time_is_refused(sound, rig, names, factor):
    every = np.arange(len(sound))
    with pytest.raises((InputError, UnanswerableError), match=r"unit of (the )?time"):
        passed(with_samples(keeping(sound, names), every, factor * sound.sample_period), rig)


def test_an_axis_thousands_of_times_as_heavy_as_its_rotor_is_refused(sound, rig):
    alone = keeping(sound, ["velocity", "current"])
    found = timing.rate(changed(alone, velocity=1e-3 * sound["velocity"]), rig)[1]
    assert found.status == "fail"
    assert "times the motor's own" in found.found


@pytest.mark.parametrize("names", [("velocity", "current"), ("position", "velocity", "current")])
def test_ten_hertz_are_too_slow_for_a_fast_motion(sound, rig, names):
    every = np.arange(0, len(sound), 100)
    repeated = np.tile(every, 20)  # long enough to be judged
    slow = keeping(with_samples(sound, repeated, 0.1), names)
    with pytest.raises((InputError, UnanswerableError)):
        passed(slow, rig)


def test_noise_of_the_speed_is_no_undersampling(sound, rig):
    rng = np.random.default_rng(0)
    noisy = changed(sound, velocity=sound["velocity"] + rng.normal(scale=200.0, size=len(sound)))
    assert timing.rate(noisy, rig)[1].status == "pass"


# signal_moves, signal_clips, resolution


def test_a_current_that_never_changes_is_refused(sound, rig):
    with pytest.raises(UnanswerableError, match=r"signal_moves.*current.*record instead") as told:
        passed(changed(sound, current=np.full(len(sound), 0.3)), rig)
    assert len(told.value.checks) == len(CHECKS)


@pytest.mark.parametrize("name", ["position", "velocity", "current"])
def test_a_sensor_that_stands_still_while_the_axis_moves_is_refused(sound, rig, name):
    moving = int(np.argmax(np.convolve(np.abs(sound["velocity"]), np.ones(200), "valid")))
    stuck = sound[name].copy()
    stuck[moving : moving + 200] = stuck[moving]
    assert signals.moves(changed(sound, **{name: stuck}), rig)[1].status == "fail"


def test_a_drive_switched_off_is_no_frozen_current(sound, rig):
    coasting = sound["current"].copy()
    coasting[2000:2300] = 0.0
    assert signals.moves(changed(sound, current=coasting), rig)[1].status == "pass"


def test_a_current_clipped_by_its_sensor_is_refused(sound, rig):
    limit = 0.4 * np.abs(sound["current"]).max()
    clipped = changed(sound, current=np.clip(sound["current"], -limit, limit))
    found = signals.clips(clipped, rig)[1]
    assert found.status == "fail"
    assert f"exactly {limit:.4g} A" in found.found or f"exactly {-limit:.4g} A" in found.found


def test_a_current_at_the_drives_own_limit_is_true(sound, rig):
    limit = rig.motor.peak_current
    driven = np.where(np.arange(len(sound)) % 50 < 10, limit, np.minimum(sound["current"], 0.9 * limit))
    assert signals.clips(changed(sound, current=driven), rig)[1].status == "pass"


@pytest.mark.parametrize(("steps", "status"), [(0.5, "fail"), (4.0, "warn"), (50.0, "pass")])
def test_coarse_steps_are_told(sound, rig, steps, status):
    step = np.std(sound["current"]) / steps
    rounded = changed(sound, current=np.round(sound["current"] / step) * step)
    assert signals.resolution(rounded, rig)[1].status == status


# effort_follows_motion


def test_a_turned_current_is_refused_and_named(sound, rig):
    with pytest.raises(InputError, match=r"effort_follows_motion.*opposite signs.*\[trace.columns\]"):
        passed(changed(sound, current=-sound["current"]), rig)


def test_another_axis_current_is_refused(sound, rig):
    foreign = np.sin(2.0 * np.pi * 1.7 * sound.time)
    found = effort.check(changed(sound, current=foreign), rig)[1]
    assert found.status == "fail"
    assert "another axis" in found.advice


def test_noise_alone_is_told_as_no_torque_signal(sound, rig):
    noise = np.random.default_rng(2).normal(size=len(sound))
    found = effort.check(changed(sound, current=noise), rig)[1]
    assert found.status == "warn"
    assert "no torque signal" in found.advice


def test_gravity_is_named_as_likeliest(sound, rig):
    heavy = changed(sound, current=sound["current"] + 8.0 * np.sin(sound["position"]))
    found = effort.check(heavy, rig)[1]
    assert found.status == "pass"
    assert "gravity" in found.advice


# streams and steady recordings


def test_parts_of_a_recording_are_gated_one_by_one(sound, rig):
    def parts(trace):
        half = len(trace) // 2
        return [with_signals_of(trace, slice(0, half)), with_signals_of(trace, slice(half, len(trace)))]

    whole = identify(parts(sound), rig)
    assert {check.status for check in whole.checks} == {"pass"}
    bad = sound["velocity"].copy()
    bad[len(sound) // 2 :] *= 0.5
    with pytest.raises(InputError, match="velocity_is_derivative_of_position"):
        identify(parts(changed(sound, velocity=bad)), rig)


def with_signals_of(trace, part):
    return Trace(trace.time[part], {n: v[part] for n, v in trace.signals.items()}, trace.units, trace.origin)


def test_a_part_at_rest_says_nothing_against_the_others(sound, rig):
    rest = {"position": np.zeros(2000), "velocity": np.zeros(2000), "current": np.zeros(2000)}
    still = Trace(np.arange(2000) * 1e-3, rest, {name: sound.units[name] for name in rest}, "rest")
    together = joined([gate(sound, rig).checks, gate(still, rig).checks])
    assert "fail" not in {check.status for check in together}


def test_a_steady_speed_has_checks_of_its_own():
    time = np.arange(3000) * 1e-3
    steady = Trace(
        time,
        {"velocity": np.full(3000, 5.0), "current": np.full(3000, 0.1)},
        {"velocity": "rad/s", "current": "A"},
        "steady",
    )
    assert "fail" not in {check.status for check in gate(steady, None, STEADY).checks}
