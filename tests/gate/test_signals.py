"""Signals that stand still, are clipped, or come in coarse steps."""

import numpy as np
import pytest

from bench.gate import signals
from bench.gate.gate import CHECKS, UnanswerableError, passed
from tests.gate.damage import changed


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
def test_coarse_steps_are_reported(sound, rig, steps, status):
    step = np.std(sound["current"]) / steps
    rounded = changed(sound, current=np.round(sound["current"] / step) * step)
    assert signals.resolution(rounded, rig)[1].status == status
