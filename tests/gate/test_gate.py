"""The gate as a whole: of a sound recording, without a rig, part by part, and of a steady speed."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.fit.identify import identify
from bench.gate.check import LONGEST, MOST, Seen
from bench.gate.gate import STEADY, gate, joined, warnings_of
from bench.trace.trace import Trace
from tests.gate.damage import changed, keeping, with_samples

NAMES = {
    *("velocity_is_derivative_of_position", "position_wraps", "lost_samples", "time_is_regular", "signal_moves"),
    *("signal_clips", "resolution", "effort_has_a_sign", "effort_follows_motion", "sampling_rate_plausible"),
    *("motor_constants_agree", "balance_holds_throughout", "agrees_with_rig"),
}


def statuses(checks):
    return {check.name: check.status for check in checks}


def test_the_gate_has_the_contracts_checks_and_a_sound_recording_passes_all(sound, rig):
    gated = gate(sound, rig)
    assert set(statuses(gated.checks)) == NAMES
    assert set(statuses(gated.checks).values()) == {"pass"}
    assert gated.trace is sound
    assert warnings_of(gated.checks) == []


def test_without_a_rig_the_gate_asks_the_signals_alone(sound):
    by_name = statuses(gate(sound).checks)
    assert {by_name.pop(name) for name in ("motor_constants_agree", "agrees_with_rig")} == {"not_applicable"}
    assert set(by_name.values()) == {"pass"}
    alone = statuses(gate(keeping(sound, ["position"])).checks)
    assert alone["position_wraps"] == "pass"
    assert alone["effort_follows_motion"] == "not_applicable"
    assert "fail" not in alone.values()


def test_parts_of_a_recording_are_gated_one_by_one(sound, rig):
    half = len(sound) // 2

    def parts(trace):
        return [with_samples(trace, np.arange(start, start + half)) for start in (0, half)]

    assert set(statuses(identify(parts(sound), rig).checks).values()) == {"pass"}
    bad = np.where(np.arange(len(sound)) < half, 1.0, 0.5) * sound["velocity"]
    with pytest.raises(InputError, match="velocity_is_derivative_of_position"):
        identify(parts(changed(sound, velocity=bad)), rig)


def constant(units, **levels):
    time = np.arange(3000) * 1e-3
    return Trace(time, {name: np.full(3000, level) for name, level in levels.items()}, units, "constant")


def test_a_part_at_rest_says_nothing_against_the_others(sound, rig):
    rest = constant(sound.units, position=0.0, velocity=0.0, current=0.0)
    together = joined([gate(sound, rig).checks, gate(rest, rig).checks])
    assert "fail" not in statuses(together).values()


def test_a_steady_speed_has_checks_of_its_own(sound):
    steady = constant(sound.units, velocity=5.0, current=0.1)
    assert "fail" not in statuses(gate(steady, None, STEADY).checks).values()


def test_of_a_long_recording_whole_stretches_are_asked_not_what_lies_between_holes():
    lengths = [LONGEST, 100] * (2 * MOST)
    time = 1e-3 * np.concatenate([np.arange(length) + 10_000 * k for k, length in enumerate(lengths)])
    seen = Seen(Trace(time, {"velocity": np.zeros(time.size)}, {"velocity": "rad/s"}, "holes"))
    assert [piece.stop - piece.start for piece in seen.stretches(50)] == [LONGEST] * MOST
