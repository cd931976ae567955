"""`bench.servo` on servos of an independent integrator, on a joint of an MJCF, and on logs that cannot answer."""

import contextlib
import json
import re
import shutil
from pathlib import Path

import mujoco
import numpy as np
import pytest

import bench
from bench.errors import UndeterminedError
from bench.parameter import Parameter
from bench.servos.quantities import Quantities
from bench.servos.servo import _known, refuse_unresolved
from bench.trace.trace import Trace
from tests.command import bench as command
from tests.docs.pages import PAGES, run_commands
from tests.studies.servos import Truth, goals, motion

MJCF = """<mujoco><compiler angle="radian"/><worldbody><body name="arm">
<joint name="elbow" type="hinge" axis="0 1 0" armature="0.002" damping="0.02"/>
<inertial pos="0.1 0 0" mass="0.4" diaginertia="0.0004 0.0004 0.0004"/></body></worldbody></mujoco>"""
#: Of the link about the joint's axis - kg*m**2.
LINK = 0.4 * 0.1**2 + 0.0004


def log(goal, position, rate, **more):
    signals = {"time": np.arange(goal.size) / rate, "position": position, "position_reference": goal, **more}
    units = {"time": "s", "position": "rad", "position_reference": "rad"}
    return Trace.from_arrays(signals, units)


def covers(parameter, truth, reach=2.0):
    """Whether the interval, extended by `reach`, has the truth: a single draw may lie outside of 95 %."""
    return abs(parameter.value - truth) <= reach * parameter.half_width


@pytest.fixture(scope="module")
def quick():
    """A servo without a limit, as it is found from 12 s at 100 Hz and 12 bit."""
    truth = Truth(rate=100.0, control_period=50e-6, coulomb=0.02)
    goal = goals(np.random.default_rng(5), truth.rate, 12.0)
    trace = log(goal, motion(truth, goal), truth.rate)
    return truth, bench.servo(trace), trace


def test_ratios_are_found_and_their_parts_are_not_stated(quick):
    truth, found, trace = quick
    expected = truth.effective
    of = found.found.inseparable
    assert of["kp/moment_of_inertia"].value == pytest.approx(expected["kp"], rel=0.03)
    assert covers(of["kp/moment_of_inertia"], expected["kp"])
    assert covers(of["(kv + viscous_friction_coefficient)/moment_of_inertia"], expected["damping"])
    assert covers(of["coulomb_friction_torque/moment_of_inertia"], expected["friction"])
    assert found.parameters["dead_time"].value == pytest.approx(expected["dead_time"], abs=1e-3)
    assert {"kp", "kv"}.isdisjoint(found.parameters)
    assert not found.found.actuator
    advised = re.findall(r"\[(\w+)\] (rotor_inertia|moment_of_inertia)", " ".join(found.found.advice))
    half = f"{0.5 * truth.inertia} kg*m**2"
    known = bench.servo(trace, bench.Rig(**{table: {key: half} for table, key in advised}))
    assert covers(known.parameters["kp"], truth.kp)


def test_the_residual_is_noise_and_a_limit_never_reached_is_a_lower_bound(quick):
    _, found, _ = quick
    assert found.verdict == "nothing_missing"
    assert found.gaps["identify"].after < 0.2 * found.gaps["identify"].before
    assert re.search(r"not reached; it is at least [\d.]+", found.found.refused["force_limit"])
    assert {check.name: check.status for check in found.checks}["time_is_regular"] == "pass"


def test_a_limit_that_is_reached_is_found():
    truth = Truth(rate=100.0, control_period=50e-6, coulomb=0.02, limit=0.5)
    goal = goals(np.random.default_rng(6), truth.rate, 12.0)
    found = bench.servo(log(goal, motion(truth, goal), truth.rate))
    of = {**found.parameters, **found.found.inseparable}
    assert of["force_limit/moment_of_inertia"].value == pytest.approx(truth.effective["limit"], rel=0.05)
    assert of["kp/moment_of_inertia"].value == pytest.approx(truth.effective["kp"], rel=0.05)


def arm(goal, rate, kp, kv, friction, late, armature=0.002):
    """Position (n,) of the arm of MJCF under gravity, integrated at 50 us by its equation of motion."""
    h, inertia, pull = 50e-6, LINK + armature, 0.4 * 9.81 * 0.1
    q = w = 0.0
    out = np.empty(goal.size)
    every = round(1.0 / (rate * h))
    for step in range(goal.size * every):
        if step % every == 0:
            out[step // every] = q
        u = goal[max(0, int((step * h - late) * rate + 1e-9))]
        torque = kp * (u - q) - kv * w + pull * np.cos(q)
        if w == 0.0 and abs(torque) <= friction:
            continue
        speed = w + h * (torque - np.copysign(friction, torque if w == 0.0 else w) - 0.02 * w) / inertia
        speed = 0.0 if speed * w < 0.0 else speed
        q, w = q + 0.5 * h * (w + speed), speed
    return np.round(out * 2**13 / np.pi) * np.pi / 2**13


def of_joint(folder, goal, position):
    """The arm's log at 100 Hz."""
    table = np.column_stack([np.arange(goal.size) / 100.0, position, goal])
    header = "time [s],elbow.position [rad],elbow.goal [rad]"
    np.savetxt(folder / "log.csv", table, delimiter=",", header=header, comments="")


@pytest.fixture(scope="module")
def of_arm(tmp_path_factory):
    """The folder with log and MJCF of the arm, in which the commands of the manual's page have run."""
    folder = tmp_path_factory.mktemp("arm")
    goal = goals(np.random.default_rng(3), 100.0, 12.0)
    position = arm(goal, 100.0, 6.0, 0.15, 0.02, 0.012)
    (folder / "robot.xml").write_text(MJCF, encoding="utf-8")
    of_joint(folder, goal, position)
    shutil.copy(folder / "log.csv", folder / "log2.csv")
    with contextlib.chdir(folder):
        run_commands(PAGES["docs/servo.md"], once)
    return folder


def once(line):
    """One fit in place of two of the same log; the drive's log is that of test_law.py."""
    return "" if "run.csv" in line or "--holdout" not in line else f"{line} --out servo"


def test_gravity_on_known_links_gives_the_scale_and_the_actuator_loads(of_arm):
    found = json.loads((of_arm / "servo" / "servo.json").read_text(encoding="utf-8"))
    values = {name: one["value"] for name, one in found["parameters"].items()}
    assert values["kp"] == pytest.approx(6.0, rel=0.05)
    assert values["kv"] == pytest.approx(0.15, rel=0.08)
    assert values["armature"] == pytest.approx(0.002, abs=0.0006)
    assert values["dead_time"] == pytest.approx(0.012, abs=1e-3)
    including = MJCF.replace("</mujoco>", '<include file="servo/actuator.xml"/></mujoco>')
    (of_arm / "whole.xml").write_text(including, encoding="utf-8")
    model = mujoco.MjModel.from_xml_path(str(of_arm / "whole.xml"))
    assert model.actuator_gainprm[0, 0] == pytest.approx(values["kp"], rel=1e-4)
    assert -model.actuator_biasprm[0, 2] == pytest.approx(values["kv"], rel=1e-4)
    assert model.actuator_delay[0] == pytest.approx(values["dead_time"], rel=1e-4)


@pytest.mark.parametrize(
    "stated",
    [pytest.param('armature="0"', marks=pytest.mark.slow), 'armature="0.001"'],
    ids=["no armature", "a wrong one"],
)
def test_an_inertia_that_is_not_the_joint_s_gives_no_scale(tmp_path, stated):
    """With the link alone kp was 3.3 +- 0.1 of 12, as nobody states the armature of a hobby servo."""
    armature, goal = 0.02, 0.08 * goals(np.random.default_rng(3), 100.0, 12.0)
    position = arm(goal, 100.0, 6.0, 0.15, 0.02, 0.012, armature)
    (tmp_path / "robot.xml").write_text(MJCF.replace('armature="0.002"', stated), encoding="utf-8")
    of_joint(tmp_path, goal, position)
    found = bench.servo(tmp_path / "log.csv", mjcf=tmp_path / "robot.xml", joint="elbow").found
    assert "kp" not in found.parameters and not found.actuator
    assert found.inseparable["kp/moment_of_inertia"].value == pytest.approx(6.0 / (LINK + armature), rel=0.05)
    assert any("armature" in line and "state that of motor and gear" in line for line in found.advice)


def test_the_slope_of_a_known_weight_is_that_of_its_torque_over_position():
    """Of a pendulum behind a gear, m*g*r*sin(q/i - q_0)/i; the servo is corrected by it where it is off its log."""
    pendulum = {"eccentric_mass": 0.3, "eccentric_radius": 0.1, "hanging_position": 0.4, "gear_ratio": 2.0}
    position = np.linspace(-7.0, 7.0, 2001)
    torque, slope = _known(log(position, position, 100.0), bench.Rig(load=pendulum))
    assert torque == pytest.approx(0.3 * 9.80665 * 0.1 * np.sin(position / 2.0 - 0.4) / 2.0)
    assert slope[1:-1] == pytest.approx(np.gradient(torque, position)[1:-1], abs=1e-5)


def test_a_holdout_that_is_the_recording_has_its_residual(of_arm):
    found = json.loads((of_arm / "servo.json").read_text(encoding="utf-8"))
    assert found["gap"]["position"]["holdout"]["after"] == found["gap"]["position"]["identify"]["after"]


def moving(seconds=12.0, rate=100.0):
    time = np.arange(0.0, seconds, 1.0 / rate)
    return time, 0.5 * np.sin(2.0 * time) + 0.1 * np.sin(7.0 * time)


def test_a_short_log_cannot_answer():
    _, motion = moving(1.5)
    with pytest.raises(UndeterminedError, match="10 s or more"):
        bench.servo(log(motion, np.roll(motion, 3), 100.0))


def test_a_log_that_is_too_slow_says_which_rate_it_takes():
    truth = Truth(inertia=1e-4, kp=3.0, kv=0.02, viscous=0.01, rate=10.0, control_period=50e-6, dead_time=0.002)
    goal = goals(np.random.default_rng(2), truth.rate, 15.0)
    with pytest.raises(UndeterminedError, match=r"within a sample of the log \(100 ms\).*at 50 Hz or more"):
        bench.servo(log(goal, motion(truth, goal), truth.rate))


def written(goal, position, rate):
    """A log of an axis, without an MJCF."""
    position = position() if callable(position) else position
    table = np.column_stack([np.arange(position.size) / rate, position, *([] if goal is None else [goal])])
    header = ",".join(["time [s]", "position [rad]", "position_reference [rad]"][: table.shape[1]])
    np.savetxt("log.csv", table, delimiter=",", header=header, comments="", fmt="%.9g")
    Path("rig.toml").write_text('name = "servo"\nkind = "rotary"\n', encoding="utf-8")


_, SWUNG = moving()
SOFT = Truth(rate=100.0, control_period=50e-6, limit=0.02, coulomb=0.002, kv=0.0, viscous=0.01)
SQUARE = 3.0 * np.sign(np.sin(2.0 * np.pi * np.arange(1200) / 100.0 / 0.8))


@pytest.mark.parametrize(
    ("goal", "position", "status", "reason", "record"),
    [
        (None, SWUNG, 2, "contains no goal", "the position that is sent to the servo"),
        (SWUNG, SWUNG, 1, "are equal in every sample", "the goal that is sent to the servo"),
        (0.0 * SWUNG + 0.3, SWUNG, 1, "the goal never moves", "steps and waves of the goal"),
        (SWUNG, 0.0 * SWUNG, 1, "the position does not", "the servo's torque switched on"),
        (SQUARE, lambda: motion(SOFT, SQUARE), 1, "at its limit", "smaller and slower motions"),
    ],
    ids=["no goal", "goal equals position", "goal never moves", "position never moves", "always at its limit"],
)
def test_a_refusal_is_one_line_and_in_the_json(goal, position, status, reason, record, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(goal, position, 100.0)
    done = command("servo", "log.csv", "--rig", "rig.toml", "--json", "found.json")
    assert (done.status, done.err.count("\n")) == (status, 1)
    found = json.loads(Path("found.json").read_text(encoding="utf-8"))
    assert found["schema"] == "bench.servo/1" and {*found["refused"]} == {"kp", "kv"}
    for text in (done.err, found["refused"]["kp"]):
        assert reason in text and record in text


def test_a_log_too_slow_for_its_delay_refuses_only_that():
    late = Parameter(0.004, "s", 0.006, (-0.008, 0.016))
    found = Quantities(parameters={"kp": Parameter(3.0, "N*m/rad", 0.1, (2.8, 3.2)), "dead_time": late})
    refuse_unresolved(found, 0.02)
    assert {*found.parameters} == {"kp"} and "every 20 ms, is too slow for it" in found.refused["dead_time"]
    assert "goal and position at 250 Hz or more" in found.advice[0]
    sure = Quantities(parameters={"dead_time": Parameter(0.0, "s", 1e-4, (-2e-4, 2e-4))})
    refuse_unresolved(sure, 0.02)
    assert {*sure.parameters} == {"dead_time"} and not sure.refused


def test_bad_input_is_one_line_with_its_status(of_arm, monkeypatch):
    monkeypatch.chdir(of_arm)
    Path("bare.csv").write_text("time [s],elbow.position [rad]\n0,0\n0.01,0.1\n0.02,0.2\n", encoding="utf-8")
    done = command("servo", "bare.csv", "--mjcf", "robot.xml", "--joint", "elbow")
    assert (done.status, done.err.count("\n")) == (2, 1)
    assert "contains no goal" in done.err
    done = command("servo", "log.csv", "--joint", "elbow")
    assert (done.status, done.err.count("\n")) == (2, 1)
