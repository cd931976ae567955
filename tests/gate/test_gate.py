"""The gate as a whole: of a sound recording, without a rig, part by part, and of a steady speed."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.fit.identify import identify
from bench.gate.check import LONGEST, MOST, Seen
from bench.gate.gate import STEADY, gate, joined, warnings_of
from bench.trace.trace import Trace
from tests.gate.damage import changed, keeping

NAMES = [
    "velocity_is_derivative_of_position",
    "position_wraps",
    "lost_samples",
    "time_is_regular",
    "signal_moves",
    "signal_clips",
    "resolution",
    "effort_has_a_sign",
    "effort_follows_motion",
    "sampling_rate_plausible",
    "motor_constants_agree",
    "balance_holds_throughout",
    "agrees_with_rig",
]


def test_the_gate_has_the_contracts_checks_and_a_sound_recording_passes_all(sound, rig):
    gated = gate(sound, rig)
    assert {check.name for check in gated.checks} == set(NAMES)
    assert {check.status for check in gated.checks} == {"pass"}
    assert gated.trace is sound
    assert warnings_of(gated.checks) == []


def test_without_a_rig_the_gate_asks_the_signals_alone(sound):
    by_name = {check.name: check.status for check in gate(sound).checks}
    assert {by_name.pop(name) for name in ("motor_constants_agree", "agrees_with_rig")} == {"not_applicable"}
    assert set(by_name.values()) == {"pass"}
    alone = {check.name: check.status for check in gate(keeping(sound, ["position"])).checks}
    assert alone["position_wraps"] == "pass"
    assert alone["effort_follows_motion"] == "not_applicable"
    assert "fail" not in alone.values()


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


def test_of_a_long_recording_whole_stretches_are_asked_not_what_lies_between_holes():
    lengths = [LONGEST, 100] * (2 * MOST)
    time = 1e-3 * np.concatenate([np.arange(length) + 10_000 * k for k, length in enumerate(lengths)])
    seen = Seen(Trace(time, {"velocity": np.zeros(time.size)}, {"velocity": "rad/s"}, "holes"))
    assert [piece.stop - piece.start for piece in seen.stretches(50)] == [LONGEST] * MOST
