"""A model on a joint of somebody's MJCF moves it as the axis of its own; what is not carried is reported."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.effects.mjcf import AXIS, DRIVE
from bench.errors import InputError
from bench.export.mjcf import (
    ArmatureShare,
    armature_of,
    commented,
    link_inertia,
    onto,
    robot_with,
    single_joint,
)
from bench.plant.mjcf_file import read_mjcf
from bench.plant.model_file import model_xml
from bench.plant.silenced import silenced
from tests.export.arms import ARM, PARAMETERS, stored
from tests.export.two_links import C2, I2, M2, MJCF

COGGING = ("cogging_torque", {"amplitude": 0.05, "harmonic": 6.0, "phase": 0.3})
OFFSET = ("torque_offset", {"torque": 0.02})
DRAG = ("quadratic_drag", {"quadratic_drag": 2e-5})
SPRING = ("torsion_spring", {"stiffness": 0.03})
BRISTLES = ("presliding_friction", {"bristle_stiffness": 20.0})
COUPLING = ("elastic_coupling", {"stiffness": 30.0, "damping": 2e-3})
BACKLASH = ("backlash", {"gap": 0.02})
STRIBECK = ("stribeck_friction", {"static_friction": 0.12, "stribeck_velocity": 2.0})
LAG = ("velocity_filter_lag", {"time_constant": 2e-3})
TIMESTEP = 1e-4
FILES = pytest.mark.parametrize(
    "text", [model_xml, lambda model: single_joint(model, "axis")[0]], ids=["model.xml", "snippet"]
)


def moved(spec, joint, actuator, scale=1.0, count=6000):
    """Angle of a joint's link under a swinging torque of its motor, and of the joint itself - (n,) each."""
    spec.option.timestep, spec.option.gravity = TIMESTEP, [0.0, 0.0, 0.0]
    model = spec.compile()
    data = mujoco.MjData(model)
    motor, control = model.joint(joint).qposadr[0], model.actuator_ctrladr[model.actuator(actuator).id]
    found = np.empty((2, count))
    for k in range(count):
        data.ctrl[control] = 0.4 * np.sin(k * TIMESTEP * 25.0)
        mujoco.mj_step(model, data)
        found[:, k] = data.qpos[motor] * scale, data.qpos.sum() * scale
    return found


@pytest.mark.parametrize("ratio", [1.0, 5.0])
@pytest.mark.parametrize(
    "effects",
    [(), (COGGING, OFFSET), (DRAG, SPRING), (BRISTLES,), (COUPLING, COGGING), (BACKLASH,)],
    ids=lambda effects: "+".join(name for name, _ in effects) or "bare",
)
def test_it_moves_as_the_axis_alone(effects, ratio):
    """The link has the load's inertia, so that the robot is the axis, seen through its gear."""
    model = stored(*effects, gear_ratio=ratio)
    load = (PARAMETERS.inertia - PARAMETERS.motor_inertia) * ratio**2
    xml = f"""<mujoco><worldbody><body name="base"><body name="link"><joint name="joint" axis="0 0 1" armature="9"/>
      <inertial pos="0 0 0" mass="1" diaginertia="{load} {load} {load}"/></body></body></worldbody></mujoco>"""
    spec = mujoco.MjSpec.from_string(xml)
    spec.option.timestep = TIMESTEP
    carried = onto(spec, "joint", model, armature_of(model, ArmatureShare.MOTOR))
    assert set(carried.native) == {name for name, _ in effects}
    robot = moved(spec, "joint", "joint motor", ratio)
    alone = model.model.spec(TIMESTEP)
    alone.option.disableflags = 0  # a user's model takes damping as it comes
    alone.joint(AXIS).armature = 0.0
    axis = moved(alone, AXIS, DRIVE)
    np.testing.assert_allclose(robot, axis, atol=2e-5 * np.ptp(axis))


def test_what_the_joint_had_is_replaced_and_the_rest_kept():
    spec = mujoco.MjSpec.from_string(ARM)
    carried = onto(spec, "elbow", stored(COGGING, STRIBECK, DRAG, LAG, gear_ratio=10.0))
    elbow, model = spec.joint("elbow"), spec.compile()
    assert elbow.armature == pytest.approx(1e-4 * 100.0)
    assert elbow.damping == pytest.approx([1.1e-3 * 1e2, 2e-5 * 1e3, 0.0])
    assert elbow.frictionloss == pytest.approx(0.8)
    assert spec.joint("shoulder").damping[0] == 0.2
    assert model.actuator(0).name == "lift"
    assert carried.native == ("cogging_torque", "quadratic_drag")
    assert carried.left == (
        ("stribeck_friction", "bench.Effects steps it"),
        ("velocity_filter_lag", "it is in what sensors report, not in the motion"),
    )


@pytest.mark.parametrize("angle", ["degree", "radian"])
def test_two_springs_of_a_joint_add_and_rest_between_their_references(angle):
    """c_1*(q - r_1) + c_2*(q - r_2) is zero at (c_1*r_1 + c_2*r_2)/(c_1 + c_2); the model's 4 rad are 0.4 here."""
    reference = np.rad2deg(0.1) if angle == "degree" else 0.1
    xml = ARM.replace('name="elbow"', f'name="elbow" stiffness="3" springref="{reference}"')
    xml = xml.replace("<worldbody>", f'<compiler angle="{angle}"/><worldbody>', 1)
    shaft = ("torsion_spring", {"stiffness": 0.03, "reference": 4.0})
    for effects, stiffness, rest in (((), 3.0, 0.1), ((shaft,), 6.0, (3.0 * 0.1 + 3.0 * 0.4) / 6.0)):
        spec = mujoco.MjSpec.from_string(xml)
        onto(spec, "elbow", stored(*effects, gear_ratio=10.0))
        joint = spec.compile().joint("elbow")
        assert (joint.stiffness[0], joint.qpos_spring[0]) == pytest.approx((stiffness, rest), rel=1e-9)


def test_links_are_stated_without_the_joints_own_armature():
    """The forearm of two_links about its elbow, I + m*c**2, whose joint has an armature of 0.5 kg*m**2 beside."""
    assert link_inertia(mujoco.MjSpec.from_string(MJCF), "elbow") == pytest.approx(I2 + M2 * C2**2, rel=1e-9)
    carried = onto(mujoco.MjSpec.from_string(MJCF), "elbow", stored())
    assert f"the links beyond the joint have {I2 + M2 * C2**2:.4g} kg*m**2" in carried.notes[0]


@pytest.mark.parametrize("angle", ["degree", "radian"])
@pytest.mark.parametrize("ratio", [1.0, 5.0])
def test_a_gap_is_as_wide_whatever_the_mjcf_writes_angles_in(angle, ratio):
    spec = mujoco.MjSpec.from_string(ARM.replace("<option", f'<compiler angle="{angle}"/><option'))
    onto(spec, "shoulder", stored(BACKLASH, gear_ratio=ratio))
    model = spec.compile()
    between = next(model.joint(k) for k in range(model.njnt) if "backlash" in model.joint(k).name)
    assert between.range == pytest.approx([-0.01 / ratio, 0.01 / ratio])


@pytest.mark.parametrize(
    ("share", "motor", "links", "armature"),
    [
        (None, 1e-4, 0.0, 1e-2),
        (None, 0.0, 0.0, 0.1),
        (None, 1e-4, 0.03, 0.07),
        (ArmatureShare.ALL, 1e-4, 0.0, 0.1),
        (ArmatureShare.MOTOR, 1e-4, 0.03, 1e-2),
    ],
)
def test_armature_is_the_share_that_is_asked_for_or_known(share, motor, links, armature):
    """Of 1e-3 kg*m**2 behind a gear of 10."""
    model = stored(parameters=replace(PARAMETERS, motor_inertia=motor), gear_ratio=10.0, link_inertia=links)
    assert armature_of(model, share).value == pytest.approx(armature)


def test_the_links_of_a_robot_are_not_counted_twice():
    spec = mujoco.MjSpec.from_string(ARM)
    onto(spec, "elbow", stored(gear_ratio=10.0, link_inertia=0.03))
    assert spec.joint("elbow").armature == pytest.approx(1e-3 * 100.0 - 0.03)
    with pytest.raises(InputError, match="more than the links have"):
        onto(spec, "elbow", stored(link_inertia=0.03))


@pytest.mark.parametrize(
    ("joint", "says"), [("elbo", "did you mean 'elbow'"), ("slide", "type slide; allowed: .*rotary")]
)
def test_a_joint_that_cannot_have_it_is_reported(joint, says):
    with pytest.raises(InputError, match=says):
        onto(mujoco.MjSpec.from_string(ARM), joint, stored())


def test_a_coupling_needs_a_body_of_one_joint():
    xml = ARM.replace('<geom size=".03" mass=".1"/>', '<joint name="wrist"/><geom size=".03" mass=".1"/>')
    with pytest.raises(InputError, match="body of several joints"):
        onto(mujoco.MjSpec.from_string(xml), "wrist", stored(COUPLING))


FLYING = """<mujoco><worldbody><body name="drone"><freejoint/><geom size=".1"/>
  <body name="boom" pos="0 0 .2"><joint name="tilt"/><geom size=".05"/></body></body></worldbody></mujoco>"""


@FILES
@pytest.mark.filterwarnings("ignore:Attach conflict")
def test_files_attach_to_a_moving_body(text):
    """The child's timestep is not the parent's, which MuJoCo says and keeps."""
    parent = mujoco.MjSpec.from_string(FLYING)
    child = mujoco.MjSpec.from_string(text(stored(COGGING, gear_ratio=3.0, load_mass=0.9)))
    with silenced():
        parent.attach(child, prefix="servo ", frame=parent.body("boom").add_frame(pos=[0.0, 0.0, 0.1]))
    model = parent.compile()
    assert "servo axis" in [model.joint(k).name for k in range(model.njnt)]
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=50)
    assert np.isfinite(data.qpos).all()


def test_masses_are_known_or_said_to_be_invented():
    known = mujoco.MjModel.from_xml_string(model_xml(stored(load_mass=0.9)))
    assert known.body("load").mass[0] == 0.9
    np.testing.assert_allclose(known.body("load").inertia, [9e-4, 4.5e-4, 4.5e-4], rtol=2e-4)
    assert "the load's either; 1e-06 kg is used for what is not known" in model_xml(stored())
    assert "motor's side of a gear of 7" in model_xml(stored(gear_ratio=7.0))
    assert "gear" not in model_xml(stored()).partition("<mujoco")[0]


@settings(max_examples=30)
@given(st.floats(1e-7, 1e3), st.floats(0.0, 0.99))
def test_files_open_whatever_the_inertia(inertia, motor):
    """MuJoCo wants A + B >= C of every body, and its own files hold six digits."""
    parameters = replace(PARAMETERS, inertia=inertia, motor_inertia=motor * inertia, viscous_friction_coefficient=0.0)
    model = stored(parameters=parameters)
    for text in (model_xml(model), single_joint(model, "axis")[0]):
        opened = mujoco.MjModel.from_xml_string(text)
        assert opened.dof_M0[0] == pytest.approx(inertia, rel=2e-3)


def test_the_snippet_has_its_values_in_a_class():
    text, _ = single_joint(stored(COGGING, gear_ratio=2.0, load_mass=0.9), "axis")
    assert '<default class="the_axis">' in text
    assert '<joint name="axis" class="the_axis"' in text
    model = mujoco.MjModel.from_xml_string(text)
    assert model.dof_armature[0] == pytest.approx(4e-4)
    np.testing.assert_allclose(model.body("load").inertia, [3.6e-3, 1.8e-3, 1.8e-3], rtol=2e-4)
    assert model.body("load").mass[0] == 0.9
    assert "as a placeholder: give the body its own" in single_joint(stored(), "axis")[0]


@pytest.mark.parametrize("known", [{"motor_inertia": 1e-4}, {"motor_inertia": 0.0}, {"link_inertia": 0.02}], ids=str)
def test_the_snippet_has_the_models_inertia_once(known):
    parameters = replace(PARAMETERS, motor_inertia=known.get("motor_inertia", 0.0))
    whole = stored(parameters=parameters, gear_ratio=10.0, link_inertia=known.get("link_inertia", 0.0))
    model = mujoco.MjModel.from_xml_string(single_joint(whole, "axis")[0])
    assert model.dof_M0[0] == pytest.approx(PARAMETERS.inertia * 100.0)


def test_a_robot_in_a_file_keeps_its_meshes(tmp_path):
    cube = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (tmp_path / "robot" / "meshes").mkdir(parents=True)
    (tmp_path / "robot" / "meshes" / "cube.obj").write_text(cube)
    robot = tmp_path / "robot" / "robot.xml"
    robot.write_text(
        '<mujoco><compiler meshdir="meshes"/><asset><mesh name="cube" file="cube.obj"/></asset><worldbody><body>'
        '<joint name="elbow"/><geom type="mesh" mesh="cube"/></body></worldbody></mujoco>'
    )
    out = tmp_path / "elsewhere" / "deeper" / "out.xml"
    out.parent.mkdir(parents=True)
    text, _ = robot_with(robot, {"elbow": (stored(), armature_of(stored()))}, out)
    out.write_text(text)
    assert mujoco.MjModel.from_xml_path(str(out)).dof_frictionloss[0] == pytest.approx(0.08)


@FILES
def test_no_actuator_is_of_a_kind_that_only_mujoco_has(text):
    """mujoco_warp 4.0.0 refuses the gain of a PID."""
    model = mujoco.MjModel.from_xml_string(text(stored(COGGING, OFFSET)))
    assert model.nu >= 1
    assert mujoco.mjtGain.mjGAIN_PID not in model.actuator_gaintype


@pytest.mark.parametrize(("content", "says"), [("<mujoco>", "refuses it"), ("", "refuses it"), (None, "no such file")])
def test_a_robot_that_is_none_is_reported_in_one_line(tmp_path, content, says):
    if content is not None:
        (tmp_path / "robot.xml").write_text(content)
    with pytest.raises(InputError, match=says) as error:
        read_mjcf(tmp_path / "robot.xml")
    assert "\n" not in str(error.value)


def test_meshes_that_are_not_there_are_left_out_with_a_word(tmp_path):
    path = tmp_path / "robot.xml"
    body = '<body><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/><joint name="elbow"/>'
    world = f'<worldbody>{body}<geom type="mesh" mesh="shell"/></body></worldbody>'
    path.write_text(f'<mujoco><asset><mesh name="shell" file="shell.stl"/></asset>{world}</mujoco>')
    text, lines = robot_with(path, {"elbow": (stored(), armature_of(stored()))}, tmp_path / "out.xml")
    assert mujoco.MjModel.from_xml_string(text).ngeom == 0
    assert lines[0] == "meshes that do not exist are omitted from robot.xml: shell"


def test_nothing_ends_the_comment():
    text = commented(mujoco.MjSpec(), ("of a joint named --><body/>",))
    assert text.count("-->") == 1
