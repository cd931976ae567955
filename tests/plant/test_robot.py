"""What the rest of a robot asks of a joint, against Lagrange's equations written out."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest

import bench
from bench.errors import InputError
from bench.plant.robot import AddedBody, Robot, read_log, rig_within
from bench.rig.rig import Rig
from bench.trace.trace import less_known
from tests.export.two_links import HIDDEN, MJCF, elbow_torque, log, motion, write_log

ELBOW = Rig.of({"name": "elbow", "kind": "rotary"})


@pytest.fixture
def arm(tmp_path):
    path = tmp_path / "arm.xml"
    path.write_text(MJCF)
    return path


def test_a_spring_of_the_robot_is_taken_off_with_its_sign(tmp_path, arm):
    """A motor that bends a joint against its spring gives k*(q - q_0), beside what the links ask."""
    sprung = tmp_path / "sprung.xml"
    sprung.write_text(MJCF.replace('<joint name="elbow"', '<joint name="elbow" stiffness="3" springref="20"'))
    q, w = np.array([[0.3, -0.4], [0.1, 0.9]]), np.array([[1.0, 2.0], [-0.5, 0.0]])
    plain, found = (Robot.of(path, "elbow").rest(q, w)[0] for path in (arm, sprung))
    np.testing.assert_allclose(found - plain, 3.0 * (q[:, 1] - np.deg2rad(20.0)), rtol=1e-12)


def test_it_is_that_of_mujocos_inverse_dynamics(tmp_path, arm):
    """Springs, damping of the other joint and gravity compensation included, at a pose and an acceleration by hand."""
    text = MJCF.replace('name="shoulder"', 'name="shoulder" damping="2" stiffness="5"')
    text = text.replace('<body name="forearm"', '<body name="forearm" gravcomp="0.4"')
    path = tmp_path / "compensated.xml"
    path.write_text(text)
    q, w, a, step = np.array([0.4, -0.7]), np.array([1.3, -2.1]), np.array([5.0, 9.0]), 1e-5
    robot = Robot.of(path, "elbow")
    time = step * np.array([-1.0, 0.0, 1.0])[:, None]
    r, p = robot.rest(q + w * time + a * time**2 / 2.0, w + a * time)
    found = r[1] + (p[2] - p[0]) / (2.0 * step) + robot.inertia * a[1]
    model = mujoco.MjModel.from_xml_path(str(path))
    model.dof_armature[1] = model.dof_damping[1] = model.dof_frictionloss[1] = 0.0
    data = mujoco.MjData(model)
    data.qpos, data.qvel, data.qacc = q, w, a
    mujoco.mj_inverse(model, data)
    assert found == pytest.approx(data.qfrc_inverse[1], rel=1e-6)


BENT = """<mujoco><option gravity="1 -2 -9"/><worldbody><body euler="10 20 0">
  <joint name="rail" type="slide" axis="1 2 0" armature="0.1"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
  <body pos="0.1 0.2 0.3" euler="0 30 40"><joint name="turn" axis="0 1 3" pos="0.05 0 0"/>
    <inertial pos="0 0 0.1" mass="2" diaginertia="0.1 0.1 0.1"/>
    <body name="hand" pos="0 0.1 0.4" euler="50 0 0"><joint name="wrist" axis="2 0 1" pos="0 0.02 0"/>
      <inertial pos="0.1 0 0" mass="1" diaginertia="0.1 0.1 0.1"/></body></body></body></worldbody></mujoco>"""


@pytest.mark.parametrize("joint", ["rail", "turn", "wrist"])
@pytest.mark.parametrize("added", [AddedBody("hand", 0.7, (0.2, -0.1, 0.3)), AddedBody(joint="wrist", inertia=0.04)])
def test_what_is_added_asks_what_the_robot_with_it_asks_more(tmp_path, joint, added):
    """By MuJoCo's inverse dynamics of a model that has it, at poses drawn at random."""
    (tmp_path / "bent.xml").write_text(BENT)
    without, having = (Robot.of(tmp_path / "bent.xml", joint, more) for more in ((), (added,)))
    rng = np.random.default_rng(2)
    q, w = rng.uniform(-2.0, 2.0, (20, 3)), rng.uniform(-3.0, 3.0, (20, 3))
    ((r, p),) = without.asked([added], q, w)
    for found, before, after in zip((r, p), without.rest(q, w), having.rest(q, w), strict=True):
        np.testing.assert_allclose(found, after - before, atol=2e-6)
    assert max(np.abs(r).max(), np.abs(p).max()) > 1e-3 or (joint, added.joint) == ("rail", "wrist")


def identified(path, arm, rig=ELBOW, **stated):
    robot = Robot.of(arm, "elbow")
    beside = rig_within(rig, robot)
    return bench.identify(read_log(path, beside, robot, stated), beside)


def test_the_joint_is_identified_among_its_links(arm, tmp_path):
    """Without cogging, which is not in the equation that identify fits."""
    hidden = replace(HIDDEN, cogging=0.0)
    found = identified(write_log(tmp_path / "log.csv", log(hidden)), arm)
    for name, true, share in (
        ("armature", hidden.armature, 0.01),
        ("viscous_friction_coefficient", hidden.viscous, 0.03),
        ("coulomb_friction_torque", hidden.coulomb, 0.03),
    ):
        assert found[name].value == pytest.approx(true, rel=share)
        assert found[name].ci95[0] < true < found[name].ci95[1]
    assert found.residual.rms < 1.1 * found.residual.noise_floor


def test_the_motors_side_of_a_gear(arm, tmp_path):
    """The log has the motor's angle and torque; the armature is reported on the joint's side all the same."""
    ratio, hidden, columns = 8.0, replace(HIDDEN, cogging=0.0), log(replace(HIDDEN, cogging=0.0))
    for name in ("elbow.position [rad]", "elbow.velocity [rad/s]"):
        columns[name] = columns[name] * ratio
    columns["elbow.torque [N*m]"] = columns["elbow.torque [N*m]"] / ratio
    geared = Rig.of({"name": "elbow", "kind": "rotary", "load": {"gear_ratio": ratio}})
    found = identified(write_log(tmp_path / "log.csv", columns), arm, geared)
    assert found["armature"].value == pytest.approx(hidden.armature, rel=0.01)
    assert found["coulomb_friction_torque"].value == pytest.approx(hidden.coulomb / ratio, rel=0.03)


def test_a_joint_that_stands_may_be_stated(arm, tmp_path):
    """The same log, of an arm whose shoulder was clamped at 0.3 rad; the links' share follows from that."""
    columns = log(noise=0.0)
    time, _, elbow = motion()
    still = np.zeros_like(time)
    columns["elbow.torque [N*m]"] = elbow_torque(still + 0.3, still, still, *elbow) + HIDDEN.torque(*elbow)
    own = {name: values for name, values in columns.items() if not name.startswith("shoulder")}
    robot, path = Robot.of(arm, "elbow"), write_log(tmp_path / "log.csv", own)
    beside = rig_within(ELBOW, robot)
    trace = read_log(path, beside, robot, {"shoulder": 0.3})
    rest = less_known(trace, trace["torque"])
    own_torque = HIDDEN.torque(*elbow) + robot.inertia * elbow[2]
    np.testing.assert_allclose(rest[1:-1], own_torque[1:-1], atol=1e-4)
    with pytest.raises(InputError, match="joint 'shoulder': is neither in the log nor stated"):
        read_log(path, beside, robot, {})


FINGERS = """<body name="left"><joint name="left" type="slide" axis="1 0 0"/><geom size=".02" mass=".1"/></body>
<body name="right"><joint name="right" type="slide" axis="-1 0 0"/><geom size=".02" mass=".1"/></body></body></body>
</worldbody>
<equality><joint joint1="right" joint2="left" polycoef="0 1 0 0 0"/></equality>"""


def test_a_finger_that_follows_another_needs_no_column(tmp_path):
    """Its own log tells nothing of its motor, which is refused by name; the arm feels both where they are."""
    path, columns = tmp_path / "gripper.xml", log(noise=0.0)
    path.write_text(MJCF.replace("</body></body></worldbody>", FINGERS))
    columns["left.position [m]"] = 0.03 * np.sin(columns["time [s]"])
    robot, logged = Robot.of(path, "elbow"), write_log(tmp_path / "log.csv", columns)
    followed = read_log(logged, rig_within(ELBOW, robot), robot, {})
    columns["right.position [m]"] = columns["left.position [m]"]
    recorded = read_log(write_log(tmp_path / "both.csv", columns), rig_within(ELBOW, robot), robot, {})
    np.testing.assert_allclose(
        less_known(followed, followed["torque"]), less_known(recorded, recorded["torque"]), atol=1e-6
    )
    for finger in ("left", "right"):
        with pytest.raises(InputError, match=f"joint '{finger}': found an equality that couples it"):
            Robot.of(path, finger)


def test_a_finger_follows_a_polynomial_of_the_way_from_where_both_are_at_rest(tmp_path):
    """y - y0 = a0 + a1*(x - x0) + a2*(x - x0)**2, x0 and y0 where the joints of the MJCF are (MuJoCo's reference)."""
    path, x = tmp_path / "gripper.xml", np.array([0.01, 0.03])
    fingers = FINGERS.replace("0 1 0 0 0", ".002 1 3 0 0")
    fingers = fingers.replace('name="left" type="slide"', 'name="left" type="slide" ref=".01"')
    fingers = fingers.replace('name="right" type="slide"', 'name="right" type="slide" ref="-.02"')
    path.write_text(MJCF.replace("</body></body></worldbody>", fingers))
    found = Robot.of(path, "elbow").follows("right", {"left": (x, np.array([0.5, 0.5]))})
    assert found is not None
    np.testing.assert_allclose(found, [[-0.018, -0.02 + 0.002 + 0.02 + 3.0 * 0.02**2], [0.5, 0.5 * 1.12]], atol=1e-12)


def test_what_floats_beside_the_arm_is_not_felt(tmp_path, arm):
    """A cube on the table has six coordinates of its own, and is none of the arm's."""
    beside = tmp_path / "table.xml"
    cube = '<worldbody><body><freejoint name="cube"/><geom size=".03" mass=".2"/></body>'
    beside.write_text(MJCF.replace("<worldbody>", cube))
    q, w = np.array([[0.3, -0.4], [0.1, 0.9]]), np.array([[1.0, 2.0], [-0.5, 0.3]])
    for alone, among in zip(*(Robot.of(path, "elbow").rest(q, w) for path in (arm, beside)), strict=True):
        np.testing.assert_allclose(among, alone, rtol=1e-9)


LOOP = '<equality><connect body1="forearm" body2="world" anchor="0 0 -.1"/></equality><actuator>'
TENDON = '<tendon><fixed name="cable"><joint joint="elbow" coef="1"/></fixed></tendon><actuator>'
PULLED = '<motor name="elbow motor" tendon="cable"/>'


SWIMS = MJCF.replace('<joint name="shoulder" axis="0 1 0"/>', '<freejoint name="shoulder"/>')
WEIGHTLESS = '<mujoco><worldbody><body><joint name="elbow"/></body></worldbody></mujoco>'


@pytest.mark.parametrize(
    ("text", "joint", "says"),
    [
        (MJCF, "elbov", "found no joint 'elbov', did you mean 'elbow'"),
        (SWIMS, "elbow", "free or ball"),
        (WEIGHTLESS, "elbow", "MuJoCo refuses it"),
        (MJCF.replace("<actuator>", LOOP), "elbow", "a loop that an equality closes over it"),
        (
            MJCF.replace("<actuator>", TENDON).replace('<motor name="elbow motor" joint="elbow"/>', PULLED),
            "elbow",
            "the tendon 'cable' on it",
        ),
    ],
)
def test_a_robot_that_cannot_be_had_is_reported_in_one_line(tmp_path, text, joint, says):
    path = tmp_path / "arm.xml"
    path.write_text(text)
    with pytest.raises(InputError, match=says) as error:
        Robot.of(path, joint)
    assert "\n" not in str(error.value)
