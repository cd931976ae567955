"""Logs that count a joint from another zero, or the other way, than the MJCF: by MuJoCo's inverse dynamics."""

import mujoco
import numpy as np
import pytest

import bench
from bench.joints.identified import JointLogs, identified
from bench.joints.links import doubt_links, doubted, reversed_joints
from bench.plant.robot import Counting, count_as
from tests.sines import sines

ARM = """<mujoco><compiler angle="{angle}"/><worldbody><body pos="0 0 0.5">
<joint name="shoulder" axis="0 1 0" ref="{ref}" range="{range}"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03" mass="1.5"/>
<body pos="0.3 0 0"><joint name="elbow" axis="0 1 0"/>
<geom type="capsule" fromto="0 0 0 0.25 0 0.05" size="0.025" mass="0.8"/></body></body></worldbody></mujoco>"""
PLAIN = ARM.format(angle="radian", ref="0", range="-3 3")
#: Armature, viscous and Coulomb friction of the joints.
NAMES = "armature", "viscous_friction_coefficient", "coulomb_friction_torque"
OWN = {"shoulder": (0.08, 0.4, 0.8), "elbow": (0.03, 0.15, 0.3)}


@pytest.fixture(scope="module")
def motion():
    """Time, and position, speed, acceleration and torque (4, n, 2) of both joints, as the MJCF counts them."""
    time, rng = np.arange(0.0, 10.0, 4e-3), np.random.default_rng(5)
    waves = [[(rng.uniform(0.1, 0.35), f, rng.uniform(0.0, 6.0)) for f in rng.uniform(0.3, 2.2, 5)] for _ in OWN]
    q, v, a = np.stack([sines(time, each) for each in waves], axis=2)
    model = mujoco.MjModel.from_xml_string(PLAIN)
    data, torque = mujoco.MjData(model), np.empty_like(q)
    for k in range(time.size):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse
    armature, viscous, coulomb = np.transpose([*OWN.values()])
    torque += armature * a + viscous * v + coulomb * np.sign(v) + 0.02 * rng.standard_normal(q.shape)
    return time, np.stack([q, v + 0.002 * rng.standard_normal(q.shape), a, torque])


def written(motion, folder, zero=0.0, sign=1.0):
    """A log that counts the shoulder's position less `zero`, and the elbow `sign` the MJCF's, and the MJCF."""
    time, (q, v, _, torque) = motion
    q, ways = q - [zero, 0.0], [1.0, sign]
    columns = np.column_stack([time, *(each[:, k] * ways[k] for k in (0, 1) for each in (q, v, torque))])
    head = ["time", *(f"{joint}.{name}" for joint in OWN for name in ("position", "velocity", "effort"))]
    np.savetxt(folder / "log.csv", columns, "%.9g", ",", header=",".join(head), comments="")
    (folder / "robot.xml").write_text(PLAIN)
    return folder / "log.csv", folder / "robot.xml"


def asked(motion, folder, **counted):
    """The same as what is asked of both joints."""
    log, mjcf = written(motion, folder, **counted)
    return [JointLogs(joint, mjcf, (log,)) for joint in OWN]


@pytest.mark.parametrize("zero", [0.3, -0.05])
def test_a_zero_is_that_by_which_all_joints_are_explained(motion, tmp_path, zero):
    work, links, zeros = doubted(asked(motion, tmp_path, zero=zero))
    assert [*zeros] == ["shoulder"] and not links and zeros["shoulder"].half_width < 2e-3
    low, high = zeros["shoulder"].ci95
    assert low - 5e-4 < zero < high + 5e-4
    assert sum(one.zero for one in work[0].added) == pytest.approx(zeros["shoulder"].value, abs=1e-6)


def test_a_joint_that_is_counted_the_other_way_is_the_one_that_explains_all(motion, tmp_path):
    assert reversed_joints(asked(motion, tmp_path, sign=-1.0)) == [Counting("elbow", reversed=True)]
    work = asked(motion, tmp_path)
    assert reversed_joints(work) == [] and doubt_links(work) == {}


@pytest.mark.slow
@pytest.mark.parametrize(("zero", "sign"), [(0.3, 1.0), (0.0, -1.0)], ids=["another zero", "the other way"])
def test_a_log_that_counts_otherwise_is_identified_and_told(motion, tmp_path, zero, sign):
    found = bench.robot(*written(motion, tmp_path, zero, sign))
    for joint, truth in OWN.items():
        values = [found[joint].parameters[name].value for name in NAMES]
        assert values == pytest.approx(truth, rel=0.01) and not found[joint].diagnosis.names
    assert len(found.warnings) == 1 and ("0.3" if zero else "sign = -1") in found.warnings[0]
    text, _ = found.with_joints(tmp_path / "robot_id.xml")
    written_, original = map(mujoco.MjModel.from_xml_string, (text, PLAIN))
    np.testing.assert_allclose(place(written_, [0.4 - zero, 0.7 * sign]), place(original, [0.4, 0.7]), atol=1e-3)


def place(model, position):
    """Where the geoms of an arm are (2, 3)."""
    data = mujoco.MjData(model)
    data.qpos[:] = position
    mujoco.mj_forward(model, data)
    return data.geom_xpos.copy()


@pytest.mark.parametrize("unit", ["radian", "degree"])
def test_an_arm_that_counts_as_its_log_stands_where_it_did(unit):
    ref, reach = (20.0, "-100 150") if unit == "degree" else (np.radians(20.0), "-1.745 2.618")
    spec = mujoco.MjSpec.from_string(ARM.format(angle=unit, ref=ref, range=reach))
    original = spec.compile()
    count_as(spec, Counting("shoulder", reversed=True))
    count_as(spec, Counting("shoulder", zero=0.2))
    other = spec.compile()
    np.testing.assert_allclose(place(other, [-0.9 - 0.2, 0.5]), place(original, [0.9, 0.5]), atol=1e-12)
    np.testing.assert_allclose(other.jnt_range[0], -original.jnt_range[0][::-1] - 0.2, atol=1e-12)


@pytest.mark.parametrize("scale", [0.02, 40.0, -1.0])
def test_an_effort_in_another_unit_is_refused_by_the_weight_that_it_counts(motion, tmp_path, scale):
    time, (q, v, a, torque) = motion
    counted = time, np.stack([q, v, a, scale * torque])
    first, _ = asked(counted, tmp_path)
    found = identified(first)
    assert f"its torque is {scale:.3g} ± " in found.failed and "known weight of the links" in found.failed
    assert "gear_ratio" in found.failed
