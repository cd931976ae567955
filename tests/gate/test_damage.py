"""One sound recording, damaged one way at a time: what each check reports, and what is refused for which reason."""

import re

import numpy as np
import pytest

from bench.errors import BenchError, InputError
from bench.fit.identify import identify
from bench.gate import repairs
from bench.gate.check import Seen
from bench.gate.effort import follows_motion, has_sign
from bench.gate.gate import UnanswerableError, gate, passed
from bench.gate.signals import clips, moves, resolution
from bench.gate.throughout import holds
from bench.gate.timing import rate, regular
from bench.gate.velocity import is_derivative
from bench.trace.trace import Trace
from tests.gate.damage import changed, keeping, losing, with_samples


def rng():
    return np.random.default_rng(0)


def current(values):
    """The recording with a current made of it."""
    return lambda trace: changed(trace, current=values(trace))


def speed(change):
    return lambda trace: changed(trace, velocity=change(trace["velocity"]))


def foreign(trace):
    """A current that follows another motion."""
    return np.sin(2.0 * np.pi * 1.7 * trace.time)


def of_one_sign(trace, least):
    rectified = least + np.abs(foreign(trace))
    rectified[rectified < least + 0.2] = least
    return rectified


def standing(trace):
    noise = {"velocity": 1e-3 * rng().normal(size=len(trace)), "position": 1e-6 * rng().normal(size=len(trace))}
    return changed(trace, current=foreign(trace), **noise)


def stuck(name):
    def damaged(trace):
        moving = int(np.argmax(np.convolve(np.abs(trace["velocity"]), np.ones(200), "valid")))
        values = trace[name].copy()
        values[moving : moving + 200] = values[moving]
        return changed(trace, **{name: values})

    return damaged


def stepped(steps):
    def values(trace):
        step = np.std(trace["current"]) / steps
        return np.round(trace["current"] / step) * step

    return current(values)


def zero_where(chosen):
    return current(lambda trace: np.where(chosen(trace), 0.0, trace["current"]))


def switched_off(trace):
    return np.isin(np.arange(len(trace)), np.arange(2000, 2300))


def in_gaps(trace):
    return np.isin(np.arange(len(trace)) // 60, np.arange(2, 80, 8))


def where_it_coasts(trace):
    return abs(trace["current"]) < 0.05 * abs(trace["current"]).max()


def filtered(lag):
    def damaged(trace):
        alpha, late = np.exp(-trace.sample_period / lag), np.zeros(len(trace))
        for k in range(1, len(trace)):
            late[k] = alpha * late[k - 1] + (1.0 - alpha) * trace["velocity"][k]
        return changed(trace, velocity=late)

    return damaged


def still(trace):
    return changed(trace, velocity=0.02 * rng().normal(size=len(trace)), position=np.zeros(len(trace)))


def jittering(trace):
    time = trace.time + rng().uniform(-2e-4, 2e-4, len(trace))
    return Trace(time, trace.signals, trace.units, trace.origin)


def resampled(trace):
    return Trace.from_arrays({"time": jittering(trace).time, **trace.signals}, {"time": "s", **trace.units})


def heavy(trace):
    return changed(keeping(trace, ["velocity", "current"]), velocity=1e-3 * trace["velocity"])


def late(samples):
    return current(lambda trace: np.roll(trace["current"], samples))


#: A check, the damage, its status, and words of what it finds and advises.
FOUND = {
    "another axis' current": (follows_motion, current(foreign), "fail", "another axis"),
    "noise": (follows_motion, current(lambda s: rng().normal(size=len(s))), "warn", "no torque signal"),
    "gravity": (follows_motion, current(lambda s: s["current"] + 8.0 * np.sin(s["position"])), "pass", "gravity"),
    "an axis that stands": (follows_motion, standing, "fail", "^the speed hardly changes.*move it$"),
    "what presses on an axis": (has_sign, current(lambda s: of_one_sign(s, 0.5)), "pass", ""),
    "a lost sign": (has_sign, current(lambda s: of_one_sign(s, 0.0)), "fail", ""),
    **{f"a stuck {name}": (moves, stuck(name), "fail", name) for name in ("position", "velocity", "current")},
    "a drive switched off": (moves, zero_where(switched_off), "pass", ""),
    "half a step": (resolution, stepped(0.5), "fail", ""),
    "few steps": (resolution, stepped(4.0), "warn", ""),
    "many steps": (resolution, stepped(50.0), "pass", ""),
    "zeros that the motion contradicts": (clips, zero_where(in_gaps), "fail", "exactly 0 A.*dropped out"),
    "a motor that coasts": (clips, zero_where(where_it_coasts), "pass", ""),
    "1 % of scale": (is_derivative, speed(lambda w: 0.99 * w), "pass", ""),
    "5 % of scale": (is_derivative, speed(lambda w: 1.05 * w), "warn", ""),
    "-6 % of scale": (is_derivative, speed(lambda w: 0.94 * w), "warn", ""),
    "an offset, no other scale": (is_derivative, speed(lambda w: w + 2.0), "pass", ""),
    "another axis' speed": (is_derivative, speed(lambda w: w[::-1].copy()), "fail", ""),
    **{f"a filter of {lag} s": (is_derivative, filtered(lag), "pass", "") for lag in (0.5e-3, 2e-3, 20e-3)},
    "a standstill": (is_derivative, still, "not_applicable", ""),
    "jitter, resampled": (regular, resampled, "warn", ""),
    "jitter, as it came": (regular, jittering, "fail", ""),
    "thousands of times the rotor": (rate, heavy, "fail", "times the motor's own"),
    "noise, no undersampling": (rate, speed(lambda w: w + 200.0 * rng().normal(size=w.size)), "pass", ""),
    **{f"a delay of {k} ms, as drives have": (holds, late(k), "pass", "") for k in (1, 5, -5)},
}


@pytest.mark.parametrize("damage", FOUND)
def test_a_check_reports_a_damage_and_nothing_else(sound, rig, damage):
    look, damaged, status, words = FOUND[damage]
    found = look(Seen(damaged(sound), rig))
    assert found.status == status
    assert re.search(words, f"{found.found}; {found.advice}")


def jumping(trace):
    position = trace["position"].copy()
    position[1000:] += 300.0
    position[3000:] -= 450.0
    return changed(trace, position=position)


PAIR, ALL, BLIND = ("velocity", "current"), ("position", "velocity", "current"), ("position", "current")
#: The damage, the error and its words.
REFUSED = {
    "a turned current": (
        current(lambda s: -s["current"]),
        InputError,
        r"effort_follows_motion.*opposite signs.*\[trace.columns\]",
    ),
    "a current that never changes": (
        current(lambda s: np.full(len(s), 0.3)),
        UnanswerableError,
        r"signal_moves.*current.*record instead",
    ),
    "many losses": (lambda s: losing(s, 0.03), InputError, "lost_samples"),
    "jumps of no one period": (jumping, InputError, r"position_wraps.*jumps 2 times"),
    **{
        f"time by {factor} of {', '.join(names)}": (
            lambda s, n=names, f=factor: with_samples(keeping(s, n), np.arange(len(s)), f * s.sample_period),
            BenchError,
            r"unit of (the )?time",
        )
        for names in (PAIR, ALL, BLIND)
        for factor in (1e3, 1e-3, 1e6)
    },
    **{
        f"ten hertz of {', '.join(names)}": (
            lambda s, n=names: keeping(with_samples(s, np.tile(np.arange(0, len(s), 100), 20), 0.1), n),
            BenchError,
            "velocity_is_derivative_of_position|sampling_rate_plausible|effort_follows_motion",
        )
        for names in (PAIR, ALL)
    },
}


@pytest.mark.parametrize("damage", REFUSED)
def test_a_damage_is_refused_for_its_reason_with_every_check(sound, rig, damage):
    damaged, error, words = REFUSED[damage]
    with pytest.raises(error, match=words) as refused:
        passed(damaged(sound), rig)
    if isinstance(refused.value, UnanswerableError):
        assert [check.name for check in refused.value.checks] == [check.name for check in gate(sound, rig).checks]


def during(trace, factor, noise=0.0):
    """The current by a factor from 2.0 s to 3.5 s."""
    bad = (trace.time >= 2.0) & (trace.time < 3.5)
    return np.where(bad, factor * trace["current"] + noise * rng().normal(size=len(trace)), trace["current"])


#: By factor and noise; a fifth is more than what passes for a signal that dropped out, and of a hundred times the
#: stretch makes nearly all of the effort.
FOR_A_WHILE = {
    (-1.0, 0.0): "the sign of current is turned",
    (0.0, 3e-3): "current is nearly zero while the motion takes effort",
    (0.1, 0.0): "current is nearly zero while the motion takes effort",
    (0.2, 0.0): "current has another scale",
    (5.0, 0.0): "current has another scale",
    (100.0, 0.0): "current has another scale",
}


@pytest.mark.parametrize("fault", FOR_A_WHILE)
def test_what_is_wrong_for_a_while_is_named_with_its_time(sound, rig, fault):
    bad = changed(sound, current=during(sound, *fault))
    with pytest.raises(BenchError, match=FOR_A_WHILE[fault]):
        passed(bad, rig)
    begin, end = map(float, re.findall(r"([\d.]+) s", holds(Seen(bad, rig)).found))
    assert (begin, end) == (pytest.approx(2.0, abs=0.35), pytest.approx(3.5, abs=0.35))


@pytest.mark.parametrize("fault", [(1.0, 0.0), *FOR_A_WHILE])
@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_the_answer_does_not_depend_on_the_unit_of_the_effort(sound, rig, fault, factor):
    current = during(sound, *fault)
    once, other = (holds(Seen(changed(sound, current=by * current), rig)) for by in (1.0, factor))
    assert other == once


def test_a_load_for_a_while_is_no_other_scale(sound, rig):
    """It changes the effort, and not how that follows the motion."""
    acts = (sound.time >= 2.0) & (sound.time < 3.5)
    loaded = changed(sound, current=sound["current"] + np.where(acts, np.ptp(sound["current"]), 0.0))
    assert "another scale" not in holds(Seen(loaded, rig)).found


@pytest.mark.parametrize("delay", [20, -20, 60])
def test_a_delay_is_named_with_its_size(sound, rig, delay):
    found = holds(Seen(late(delay)(sound), rig))
    (milliseconds,) = re.findall(rf"([\d.]+) ms {'late' if delay > 0 else 'early'}", found.found)
    assert found.status == "fail" and float(milliseconds) == pytest.approx(abs(delay), abs=3.0)


@pytest.mark.parametrize("factor", [0.16, 0.5, 0.6, 6.0, -1.0, 0.88, 1.12, 180.0 / np.pi, 1e-20, 1e20])
def test_a_speed_of_another_scale_fails_with_that_scale(sound, rig, factor):
    found = is_derivative(Seen(changed(sound, velocity=factor * sound["velocity"]), rig))
    assert found.status == "fail"
    assert float(found.found.split()[2]) == pytest.approx(factor, rel=1e-3)


def test_a_current_clipped_by_its_sensor_fails_and_at_the_drives_own_limit_is_true(sound, rig):
    limit = 0.4 * np.abs(sound["current"]).max()
    found = clips(Seen(changed(sound, current=np.clip(sound["current"], -limit, limit)), rig))
    assert found.status == "fail"
    assert f"exactly {limit:.4g} A" in found.found or f"exactly {-limit:.4g} A" in found.found
    peak = rig.motor.peak_current
    driven = np.where(np.arange(len(sound)) % 50 < 10, peak, np.minimum(sound["current"], 0.9 * peak))
    assert clips(Seen(changed(sound, current=driven), rig)).status == "pass"


def runs_on(trace, rig):
    """The mended recording and the check."""
    gated = gate(trace, rig, [repairs.runs_on])
    (found,) = gated.checks
    return gated.trace, found


@pytest.mark.parametrize("period", [2.0 * np.pi, 1.0, 25.0, 2.0 * np.pi / 7.0])
def test_a_wrapped_position_runs_on_again(sound, rig, period):
    wrapped = changed(sound, position=np.mod(sound["position"] + 0.1, period) - 0.5 * period)
    mended, found = runs_on(wrapped, rig)
    assert found.status == "pass" and "undone" in found.found
    difference = mended["position"] - sound["position"]
    assert np.ptp(difference) < 1e-3 * period * np.ceil(np.ptp(sound["position"]) / period)
    assert mended.wraps is not None and mended.wraps.period == pytest.approx(period, rel=1e-4)


def test_a_set_point_wraps_or_runs_on_by_itself(sound, rig):
    """One that runs on and steps by 0.7 of a turn is not moved to the other side."""
    turn, step = 2.0 * np.pi, (sound.time > sound.time[1000]) * 0.7
    wrapped = np.mod(sound["position"], turn)
    ahead = sound["position"] + step * turn
    for setpoint, meant in ((ahead, ahead), (wrapped, sound["position"])):
        mended, _ = runs_on(changed(sound, position_reference=setpoint, position=wrapped), rig)
        apart = mended["position_reference"] - meant
        np.testing.assert_allclose(apart, apart[0], atol=1e-3 * turn)


@pytest.mark.parametrize("names", [BLIND, ALL])
def test_a_wrapped_position_gives_the_same_inertia(sound, rig, names):
    wrapped = changed(sound, position=np.mod(sound["position"], 2.0 * np.pi))
    inertias = [identify(keeping(one, names), rig)["moment_of_inertia"].value for one in (sound, wrapped)]
    assert inertias[1] == pytest.approx(inertias[0], rel=1e-6)


def test_a_position_elsewhere_after_a_hole_is_no_wrap(sound, rig):
    kept = np.r_[0:1000, 4000:4200]
    apart = Trace(sound.time[kept], {n: v[kept] for n, v in sound.signals.items()}, sound.units, sound.origin)
    shifted = changed(apart, position=apart["position"] + 1e3 * (np.arange(kept.size) >= 1000))
    mended, found = runs_on(shifted, rig)
    assert found.status == "pass"
    assert mended.wraps is None
