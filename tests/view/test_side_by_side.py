"""What is shown moves as the recording and its replay do, or as the drive that follows a profile."""

import numpy as np
import pytest

from bench.arrays import rms
from bench.assets import asset
from bench.diagnosis.replay import replay
from bench.errors import InputError
from bench.export.feedforward import tracking
from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.drive import Cascade
from bench.plant.model_file import StoredModel, model_toml
from bench.plant.profiles import MotionLimits, plan
from bench.rig.rig import load_rig
from bench.view.side_by_side import along_profile, along_recording
from tests.diagnosis.test_commands import only
from tests.fit.motions import RIG
from tests.view.motions import AHEAD, BALANCE, shown


def test_along_a_recording_the_ghost_is_what_was_measured(folder, trace):
    found = along_recording("model.toml", replay(folder / "model.toml", trace, RIG))
    np.testing.assert_array_equal(found.ghost, trace["position"])
    assert found.kind is RIG.axis_kind
    assert rms(found.apart) < 0.005  # some 100 rad are turned
    assert "recorded torque" in found.simulated_is
    moved = np.gradient(found.position, trace.sample_period)
    assert rms((moved - found.velocity)[1:-1]) < 0.02  # position and velocity are those of one motion


def test_without_position_both_start_at_zero_and_turn_as_fast(folder, trace):
    blind = only(trace, "velocity", "current")
    found = along_recording("model.toml", replay(folder / "model.toml", blind, RIG))
    assert found.ghost[0] == 0.0
    np.testing.assert_allclose(found.ghost, trace["position"] - trace["position"][0], atol=0.02)


def test_a_model_without_motion_is_refused(trace, tmp_path):
    (tmp_path / "model.toml").write_text(f'schema = "bench.model/1"\nkind = "rotary"\n{BALANCE}', encoding="utf-8")
    with pytest.raises(InputError, match="missing, so that nothing can move"):
        along_recording(tmp_path / "model.toml", replay(tmp_path / "model.toml", trace, RIG))


def test_along_a_profile_the_ghost_is_what_was_asked_for(tmp_path):
    rig = load_rig(asset("data", "rigs", "sh30701p.toml"))
    model = AxisModel(AxisParameters.from_rig(rig))
    (tmp_path / "model.toml").write_text(model_toml(StoredModel("axis", model)), encoding="utf-8")
    found = along_profile(tmp_path / "model.toml", rig, "slow_reversals")
    motion = plan("slow_reversals", MotionLimits.from_rig(rig, model.parameters, Cascade.from_rig(rig).control_period))
    errors = tracking(model, rig, motion)
    assert rms(found.apart) == pytest.approx(errors.position, rel=1e-12)
    assert rms(found.velocity - found.ghost_velocity) == pytest.approx(errors.velocity, rel=1e-12)
    assert found.ghost_is == "demanded"


def test_a_part_is_cut_out_and_an_empty_one_refused():
    part = shown().between(0.5, None)
    assert (part.time[0], part.time[-1]) == (0.5, 2.0)
    np.testing.assert_allclose(part.apart, AHEAD)
    with pytest.raises(InputError, match=r"found 3 s to 2 s; allowed: a part of 0 s to 2 s"):
        shown().between(3.0, None)
