"""Gains of controllers whose torque is recorded: cascades and PD of an independent integrator, and a simulated rig."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest

import bench
from bench.servos.law import law_of
from tests.command import bench as command
from tests.studies.cascades import Cascade, cascade_of, judged, log, motion, reference

#: Gains of a drive that reaches no limit.
FULL = Cascade(position_gain=40.0, velocity_gain=0.5, reset_time=0.02, inertia_feedforward=1.8e-3)
COMBINED = {"velocity_gain*position_gain + integral_gain": "kp", "position_gain*integral_gain": "ki"}


def near(found, truth, share=0.03):
    """Whether a value is right within a share, and its interval, doubled as a single draw may miss, contains it."""
    return abs(found.value - truth) <= min(share * abs(truth), 2.0 * found.half_width)


@pytest.fixture(scope="module", params=[1e-3, 250e-6], ids=["1 kHz", "4 kHz"])
def full(request):
    """A drive with full speed feed-forward, and what is found of it."""
    drive = dataclasses.replace(FULL, tick=request.param, velocity_gain=0.35 if request.param == 1e-3 else 0.5)
    return drive, bench.servo(log(drive, np.random.default_rng(1)))


def test_with_full_feed_forward_two_gains_only_appear_together(full):
    drive, found = full
    truth, of = drive.truth, found.found
    assert all(near(of.inseparable[name], truth[key]) for name, key in COMBINED.items())
    assert near(found.parameters["velocity_gain"], truth["velocity_gain"])
    assert near(found.parameters["inertia_feedforward"], truth["inertia_feedforward"])
    assert {"position_gain", "integral_gain"}.isdisjoint(found.parameters)
    assert "may be exchanged" in of.refused["position_gain"]
    assert any("half of the speed feed-forward" in line for line in of.advice)


def test_the_residual_of_a_cascade_is_noise_and_its_gap_is_of_the_torque(full):
    _, found = full
    assert found.verdict == "nothing_missing" and found.compared == ("torque", "N*m")
    assert found.gaps["identify"].after < 0.05 * found.gaps["identify"].before


def test_exchanged_gains_have_the_same_torque_along_the_same_motion():
    """What is stated as inseparable really is: K_p and K_i/K_v exchanged change no sample beyond the tick."""
    other = dataclasses.replace(FULL, position_gain=1.0 / FULL.reset_time, reset_time=1.0 / FULL.position_gain)
    along = reference(np.random.default_rng(2), FULL.tick, 3.0, 30.0)
    fine = (dataclasses.replace(one, bits=30) for one in (FULL, other))
    one, exchanged = (motion(drive, along)[2] for drive in fine)
    assert np.sqrt(np.mean((one - exchanged) ** 2)) < 0.01 * np.std(one)


@pytest.mark.parametrize("share", [0.0, 0.5])
def test_without_all_of_the_feed_forward_each_gain_is_found(share):
    drive = dataclasses.replace(FULL, velocity_feedforward=share)
    found = bench.servo(log(drive, np.random.default_rng(3)))
    names = "position_gain", "velocity_gain", "integral_gain"
    assert all(near(found.parameters[name], drive.truth[name]) for name in names)
    assert found.parameters["reset_time"].value == pytest.approx(0.02, rel=0.03)
    assert found.parameters["velocity_feedforward"].value == pytest.approx(share, abs=0.01)
    assert not found.found.inseparable and not found.found.advice


def test_a_late_reference_is_not_taken_for_less_feed_forward():
    recording = log(FULL, np.random.default_rng(4))
    early = {name: np.roll(recording[name], -4) for name in ("position_reference", "velocity_reference")}
    shifted = recording.with_signals(early, {})[8:-8]
    found = bench.servo(shifted)
    assert {*found.found.inseparable} == {*COMBINED}
    assert near(found.found.inseparable["position_gain*integral_gain"], FULL.truth["ki"], 0.05)


def test_samples_at_the_limit_are_left_out_and_show_it():
    drive = dataclasses.replace(FULL, limit=0.35, inertia_feedforward=0.0)
    found = bench.servo(log(drive, np.random.default_rng(5)))
    assert found.parameters["force_limit"].value == pytest.approx(0.35, rel=0.02)
    assert all(near(found.found.inseparable[name], drive.truth[key]) for name, key in COMBINED.items())


def test_a_holdout_is_judged_by_the_law():
    rng = np.random.default_rng(6)
    found = bench.servo(log(FULL, rng, 8.0), holdout=log(FULL, rng, 6.0))
    assert found.gaps["holdout"].after < 1.3 * found.gaps["identify"].after


def test_pd_with_a_recorded_torque_has_its_gains_and_scale():
    drive = Cascade(50.0, 0.06, math.inf, 0.0, viscous=0.02, coulomb=0.01, bits=14)
    recording = log(drive, np.random.default_rng(7), speed=4.0)[::5]
    found = bench.servo(recording.without("velocity_reference"))
    assert not law_of(recording, recording["torque"]).reading.integral
    assert near(found.parameters["kp"], 3.0) and near(found.parameters["kv"], 0.06)
    assert found.parameters["moment_of_inertia"].value == pytest.approx(2e-3, rel=0.03)
    assert found.compared == ("position", "rad")


def test_a_torque_that_follows_no_law_is_reported():
    drive = Cascade(50.0, 0.06, math.inf, 0.0, viscous=0.02, coulomb=0.01, bits=14)
    rng = np.random.default_rng(8)
    recording = log(drive, rng, speed=4.0)[::10]
    strange = recording.with_signals({"torque": np.cumsum(rng.standard_normal(len(recording)))}, {})
    found = bench.servo(strange)
    assert "kp" not in found.parameters
    assert any("follows no law" in line for line in found.warnings)


def test_the_drive_of_a_simulated_rig_comes_out_and_a_wrong_list_differs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert command("simulate", "sh30701p", "--out", "run.csv").status == 0
    assert command("servo", "run.csv", "--rig", "sh30701p", "--out", "servo").status == 0
    found = json.loads(Path("servo/servo.json").read_text(encoding="utf-8"))
    assert {*found["stated"]} == {"velocity_gain", "inertia_feedforward", *COMBINED}
    assert all(one["agrees"] for one in found["stated"].values())
    assert found["gap"]["torque"]["identify"]["after"] < 2.0 * found["gap"]["torque"]["noise_floor"]
    own = bench.load_rig("sh30701p").to_dict()
    own["drive"]["integral_gain"] *= 1.2
    wrong = bench.servo("run.csv", bench.Rig(**own)).found.stated
    assert wrong["velocity_gain"].agrees and not any(wrong[name].agrees for name in COMBINED)


@pytest.mark.slow
def test_intervals_cover_drives_drawn_at_random():
    rows = []
    for k in range(20):
        rng = np.random.default_rng([1, k])
        drive = cascade_of(rng)
        rows += judged(drive, log(drive, rng)).values()
    assert np.median([abs(error) for error, _, _ in rows]) < 0.005
    assert np.mean([covered for _, _, covered in rows]) > 0.88
