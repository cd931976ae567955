"""Positions that wrap run on again; other jumps are refused."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.fit.identify import identify
from bench.gate import repairs
from bench.gate.gate import gate, passed
from bench.trace.trace import Trace
from tests.gate.damage import changed, keeping


@pytest.mark.parametrize("period", [2.0 * np.pi, 1.0, 25.0, 2.0 * np.pi / 7.0])
def test_a_wrapped_position_runs_on_again(sound, rig, period):
    wrapped = changed(sound, position=np.mod(sound["position"] + 0.1, period) - 0.5 * period)
    gated = gate(wrapped, rig, [repairs.runs_on])
    mended, (found,) = gated.trace, gated.checks
    assert found.status == "pass"
    assert "undone" in found.found
    difference = mended["position"] - sound["position"]
    assert np.ptp(difference) < 1e-3 * period * np.ceil(np.ptp(sound["position"]) / period)
    assert mended.wraps is not None
    assert mended.wraps.period == pytest.approx(period, rel=1e-4)


def test_a_set_point_wraps_or_runs_on_by_itself(sound, rig):
    """One that runs on and steps by 0.7 of a turn is not moved to the other side."""
    turn, late = 2.0 * np.pi, (sound.time > sound.time[1000]) * 0.7
    wrapped = {"position": np.mod(sound["position"], turn)}
    ahead = sound["position"] + late * turn
    for setpoint, meant in ((ahead, ahead), (np.mod(sound["position"], turn), sound["position"])):
        mended = gate(changed(sound, position_reference=setpoint, **wrapped), rig, [repairs.runs_on]).trace
        apart = mended["position_reference"] - meant
        np.testing.assert_allclose(apart, apart[0], atol=1e-3 * turn)


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
    gated = gate(shifted, rig, [repairs.runs_on])
    mended, (found,) = gated.trace, gated.checks
    assert found.status == "pass"
    assert mended.wraps is None
