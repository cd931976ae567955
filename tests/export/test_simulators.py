"""Files for other simulators: values on the joint's side of the gear, what they lack named; and loaded by each of them.

The slow tests run where the Python of an environment with the simulator is named: `MJLAB_PYTHON`, `NEWTON_PYTHON`
(`pip install "newton[sim]"`), `BAM_PYTHON` (`pip install better-actuator-models`, from Python 3.12 on).
"""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace

import mujoco
import numpy as np
import pytest

from bench.export.actuator import isaaclab_actuators, mjlab_actuators
from bench.export.mjcf import ArmatureShare, armature_of, onto
from bench.export.simulators import simulator_file
from bench.files import write_text
from bench.plant.model_file import Mounting, joints_toml, load_joints
from bench.plant.robot import Robot, rig_within
from bench.rig.rig import Rig
from tests.command import bench
from tests.effects.axes import WINDING
from tests.export.arms import PARAMETERS, stored
from tests.export.two_links import MJCF

COGGING = ("cogging_torque", {"amplitude": 0.4, "harmonic": 6.0, "phase": 0.3})
SECOND = ("cogging_torque", {"amplitude": 0.2, "harmonic": 12.0, "phase": 0.0})
BRISTLES = ("presliding_friction", {"bristle_stiffness": 20.0})
STRIBECK = ("stribeck_friction", {"static_friction": 0.12, "stribeck_velocity": 2.0})
LOADED = ("load_dependent_friction", {"load_friction_coefficient": 0.12})
DIRECTED = ("directional_load_friction", {"motor_coefficient": 0.1, "load_ratio": 2.0})
SPRING = ("torsion_spring", {"stiffness": 0.5})
RATIO = 12.0


def of(*effects, **parts):
    made = stored(*effects, gear_ratio=RATIO)
    return replace(made, model=replace(made.model, **parts))


def limited(model, limit):
    """A model whose joint has a limit of torque - N*m."""
    return replace(model, mounting=replace(model.mounting, effort_limit=limit))


class Stub(SimpleNamespace):
    """A configuration of another simulator, as what it was given."""


def loaded(text, monkeypatch):
    """What a module for another simulator defines, whose classes keep what they are given."""
    for name in ("mjlab", "mjlab.actuator", "isaaclab", "isaaclab.actuators", "newton"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    for kind in ("BuiltinDcMotorActuatorCfg", "DcMotorPhysicalParams", "BuiltinPositionActuatorCfg"):
        setattr(sys.modules["mjlab.actuator"], kind, Stub)
    sys.modules["mjlab.actuator"].DcMotorInputMode = SimpleNamespace(VOLTAGE=0)
    sys.modules["isaaclab.actuators"].DelayedPDActuatorCfg = Stub
    sys.modules["isaaclab.actuators"].ImplicitActuatorCfg = sys.modules["newton"].ModelBuilder = Stub
    names = {}
    exec(compile(text, "exported", "exec"), names)
    return names


SERVO = {"kp": 40.0, "kv": 1.5, "delay": 0.0123, "damping": 0.2, "frictionloss": 0.3, "armature": 0.01}
SERVOS = {"hip.joint": {**SERVO, "forcerange": 23.7}, "calf": {**SERVO, "delay": 0.0}}


def test_servos_have_gains_delay_and_friction(monkeypatch):
    """As `bench servo` and `bench robot` write them."""
    hip, calf = loaded(mjlab_actuators(SERVOS), monkeypatch)["ACTUATORS"]
    assert hip.target_names_expr == (r"hip\.joint",)
    assert (hip.stiffness, hip.damping, hip.effort_limit) == (40.0, 1.5, 23.7)
    assert (hip.armature, hip.frictionloss, hip.viscous_damping) == (0.01, 0.3, 0.2)
    assert (hip.delay_min_lag, hip.delay_max_lag, calf.delay_max_lag) == (2, 2, 0)
    assert not hasattr(calf, "effort_limit")
    actuators = loaded(isaaclab_actuators(SERVOS), monkeypatch)["ACTUATORS"]
    hip, calf = actuators["hip.joint"], actuators["calf"]
    assert hip.joint_names_expr == [r"hip\.joint"]
    assert (hip.friction, hip.dynamic_friction, hip.viscous_friction) == (0.3, 0.3, 0.2)
    assert (calf.friction, calf.dynamic_friction) == (0.3, 0.3)
    assert (hip.min_delay, hip.max_delay) == (2, 2)


def test_mjlab_gets_torque_cogging_and_bristles(monkeypatch):
    model = limited(of(COGGING, SECOND, BRISTLES, LOADED, peak_effort=2.44), 3.0 * RATIO)
    text, lines = simulator_file("mjlab", {"elbow": model}, None)
    (motor,) = loaded(text, monkeypatch)["ACTUATORS"]
    assert motor.target_names_expr == ("elbow",)
    assert (motor.gear, motor.effort_limit, motor.frictionloss) == (RATIO, 3.0, 0.0)
    assert motor.armature == pytest.approx(1e-4 * RATIO**2)
    assert motor.viscous_damping == pytest.approx(1.1e-3 * RATIO**2)
    assert motor.cogging == pytest.approx((-0.4, 6.0, 0.3))
    assert motor.lugre[0] == 20.0
    assert motor.lugre[2:4] == pytest.approx((0.08, 0.08))
    assert motor.motor_params.kt == motor.motor_params.resistance
    assert "elbow: carried: cogging_torque, presliding_friction" in lines
    assert "elbow: not carried: cogging_torque (MuJoCo has it: --mjcf ROBOT)" in lines
    assert "elbow: not carried: load_dependent_friction (bench.Effects steps it)" in lines


def test_the_largest_logged_torque_is_no_limit(monkeypatch):
    """A limit is what the MJCF or the rig states; `peak_effort` may be the largest that was recorded."""
    for target, names in (("mjlab", "ACTUATORS"), ("newton", "JOINTS")):
        text, lines = simulator_file(target, {"elbow": of(peak_effort=2.44)}, None)
        assert "effort_limit" not in repr(loaded(text, monkeypatch)[names])
        assert any(line.startswith("elbow: no effort_limit: neither MJCF nor rig states one") for line in lines)
        text, lines = simulator_file(target, {"elbow": limited(of(peak_effort=2.44), 28.0)}, None)
        value = 28.0 / RATIO if target == "mjlab" else 28.0
        assert f"'effort_limit': {value!r}" in text or f"effort_limit={value!r}" in text
        assert not any("no effort_limit" in line for line in lines)


MOTOR = '<motor joint="elbow" gear="2" {}/>'


@pytest.mark.parametrize(
    ("joint", "actuator", "limit"),
    [
        ("", "", None),
        ("", MOTOR.format(""), None),
        ("", MOTOR.format('forcerange="-14 14"'), 28.0),
        ("", MOTOR.format('ctrlrange="-14 10"'), 28.0),
        ('actuatorfrcrange="-20 20"', MOTOR.format('ctrlrange="-14 10"'), 20.0),
        ('actuatorfrcrange="-20 20"', "", 20.0),
        ("", '<position joint="elbow" kp="50" ctrlrange="-3 3"/>', None),
        ("", '<position joint="elbow" kp="50" ctrlrange="-3 3" forcerange="-7 7"/>', 7.0),
        ("", MOTOR.format('forcerange="-14 14"') + MOTOR.format(""), None),
    ],
)
def test_a_limit_is_that_of_the_mjcf_or_of_the_rig(tmp_path, joint, actuator, limit):
    path = tmp_path / "robot.xml"
    body = f'<body><joint name="elbow" axis="0 1 0" {joint}/><geom size="0.1"/></body>'
    write_text(path, f"<mujoco><worldbody>{body}</worldbody><actuator>{actuator}</actuator></mujoco>")
    robot = Robot.of(path, "elbow")
    assert robot.effort_limit == limit
    known = {"torque_constant": "0.5 N*m/A", "peak_current": "4 A"}
    rig = Rig.of({"name": "elbow", "kind": "rotary", "motor": known, "load": {"gear_ratio": 12.0}})
    mounting = Mounting.of(rig_within(rig, robot))
    assert mounting.effort_limit == min(24.0, limit or np.inf)
    model = replace(of(), mounting=mounting)
    write_text(tmp_path / "effects.toml", joints_toml({"elbow": model}))
    assert load_joints(tmp_path / "effects.toml")["elbow"].mounting == mounting


@pytest.mark.parametrize(
    ("effects", "variant"),
    [((), "m1"), ((STRIBECK,), "m2"), ((LOADED,), "m5"), ((STRIBECK, DIRECTED), "m5"), ((STRIBECK, COGGING), "m2")],
)
def test_bams_friction_is_that_of_the_effects(effects, variant):
    """BAM's published law, on the joint's side, beside what the effects say on the motor's."""
    model = of(*effects, winding=WINDING)
    text, lines = simulator_file("bam", {"elbow": model}, "xl330")
    values = json.loads(text)
    assert (values["model"], values["actuator"]) == (variant, "xl330")
    assert values["kt"] == pytest.approx(WINDING.torque_constant * RATIO)
    for motor, outside, speed in STATES:
        assert bams(values, motor, outside, speed) == pytest.approx(level(effects, motor, outside, speed), rel=1e-9)
    assert any("cogging_torque" in line for line in lines) == (COGGING in effects)


STATES = [(0.0, 0.0, 0.01), (3.0, -1.0, 0.1), (-3.0, 1.5, 0.4), (1.0, 2.0, -0.2)]


def bams(values, motor, outside, speed):
    """Dry friction - N*m."""
    rise = values.get("friction_stribeck", 0.0) * np.exp(
        -(abs(speed / values.get("dtheta_stribeck", 1.0)) ** values.get("alpha", 1.0))
    )
    loaded = abs(values.get("load_friction_external", 0.0) * outside - values.get("load_friction_motor", 0.0) * motor)
    return values["friction_base"] + rise + loaded


def level(effects, motor, outside, speed):
    """The effects' dry friction - N*m - by their equations, of torques and speed of the motor."""
    motor, load, speed, found = motor / RATIO, -outside / RATIO, speed * RATIO, PARAMETERS.coulomb_friction
    for name, values in effects:
        if name == "stribeck_friction":
            found += (values["static_friction"] - 0.08) * np.exp(-((speed / values["stribeck_velocity"]) ** 2))
        if name == "load_dependent_friction":
            found += values["load_friction_coefficient"] * abs(motor)
        if name == "directional_load_friction":
            found += values["motor_coefficient"] * abs(motor + values["load_ratio"] * load)
    return found * RATIO


def test_isaac_lab_gets_static_and_dynamic_friction(monkeypatch):
    text, lines = simulator_file("isaaclab", {"elbow": of(STRIBECK, LOADED), "my wrist": of()}, None)
    actuators = loaded(text, monkeypatch)["ACTUATORS"]
    elbow, wrist = actuators["elbow"], actuators["my wrist"]
    assert (elbow.friction, elbow.dynamic_friction) == pytest.approx((0.12 * RATIO, 0.08 * RATIO))
    assert wrist.friction == wrist.dynamic_friction == pytest.approx(0.08 * RATIO)
    assert wrist.viscous_friction == pytest.approx(1.1e-3 * RATIO**2)
    assert wrist.joint_names_expr == [r"my\ wrist"]
    said = ["carried: stribeck_friction", "not carried: load_dependent_friction (bench.Effects steps it)"]
    assert {f"elbow: {one}" for one in said} <= {*lines}


def test_newton_gets_a_spring_unless_it_rests_elsewhere(monkeypatch):
    text, lines = simulator_file("newton", {"elbow": of(SPRING, COGGING)}, None)
    builder = Stub(joint_label=["world/arm/shoulder", "world/arm/elbow"], joint_qd_start=[0, 1])
    for name in ("armature", "friction", "damping", "stiffness"):
        setattr(builder, f"joint_{name}", [7.0, 7.0])
    loaded(text, monkeypatch)["onto"](builder)
    assert builder.joint_stiffness == pytest.approx([7.0, 0.5 * RATIO**2])
    assert builder.joint_armature == pytest.approx([7.0, 1e-4 * RATIO**2])
    assert "elbow: not carried: cogging_torque (MuJoCo has it: --mjcf ROBOT)" in lines
    elsewhere = ("torsion_spring", {"stiffness": 0.5, "reference": 0.3})
    text, lines = simulator_file("newton", {"elbow": of(elsewhere)}, None)
    assert "'stiffness': 0" in text
    assert any("elbow: not carried: torsion_spring" in line for line in lines)


def test_nothing_of_a_name_becomes_code(monkeypatch):
    name = 'elbow"\n)]; raise SystemExit #'
    for target in ("mjlab", "isaaclab", "newton"):
        text, _ = simulator_file(target, {name: of()}, None)
        loaded(text, monkeypatch)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ("--to gazebo", "--to: found 'gazebo'; allowed: mjcf, mjlab, bam, isaaclab, newton"),
        ("--to bam --joint elbow", "--actuator: missing"),
        ("--to bam --actuator xl330", "found several joints; allowed: one joint that turns, by --joint"),
        ("--to newton --actuator xl330", "allowed: with --to bam"),
        ("--to newton --joint wrist", "found no 'wrist'; allowed: shoulder, elbow"),
        ("--to newton --snippet", "found none or several"),
        ("--snippet", "effects.toml: found several joints; pick one: `--joint shoulder`; the file has shoulder, elbow"),
    ],
)
def test_what_no_simulator_takes_is_one_line(tmp_path, arguments, says, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_text(tmp_path / "effects.toml", joints_toml({"shoulder": of(), "elbow": of(STRIBECK)}))
    done = bench("export", "effects.toml", *arguments.split(), "--out", "x.py")
    assert (done.status, says in done.err, (tmp_path / "x.py").exists()) == (2, True, False), done.err


@pytest.fixture
def export(tmp_path, monkeypatch):
    """Runs `bench export` on a file of three joints in a folder of its own; what it prints."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "robot.xml").write_text(MJCF)

    def run(models, *arguments):
        write_text(tmp_path / "effects.toml", joints_toml(models))
        done = bench("export", "effects.toml", *arguments)
        assert done.status == 0, done.err
        return done.out

    return run


def test_the_command_writes_the_file_of_all_joints_or_of_those_that_are_repeated(export, monkeypatch):
    models = {"shoulder": of(), "elbow": of(STRIBECK), "wrist": of()}
    said = export(models, "--to", "newton", "--out", "joints.py")
    assert set(loaded(Path("joints.py").read_text(), monkeypatch)["JOINTS"]) == set(models)
    assert "elbow: not carried: stribeck_friction" in said
    export(models, "--to", "newton", "--joint", "elbow", "--joint", "wrist", "--out", "some.py")
    assert set(loaded(Path("some.py").read_text(), monkeypatch)["JOINTS"]) == {"elbow", "wrist"}


def test_an_mjcf_gets_all_joints(export):
    said = export({"shoulder": of(), "elbow": of(COGGING)}, "--mjcf", "robot.xml", "--out", "robot_id.xml")
    simulation = mujoco.MjModel.from_xml_path("robot_id.xml")
    np.testing.assert_allclose(simulation.dof_frictionloss, 0.08 * RATIO)
    assert "elbow: native: cogging_torque" in said


MODELS = {"shoulder": of(), "elbow": of(COGGING)}


def pushed(models):
    """Torques of the joints - (400, 2) - and velocities of the arm on MuJoCo's CPU, in the bench's own export."""
    spec = mujoco.MjSpec.from_string(MJCF)
    for name, model in models.items():
        onto(spec, name, model, armature_of(model, ArmatureShare.MOTOR))
        joint = spec.joint(name)  # others hold friction no harder than MuJoCo does by default
        joint.solref_friction, joint.solimp_friction = [0.02, 1.0], [0.9, 0.95, 0.001, 0.5, 2.0]
    simulation = spec.compile()
    data, time = mujoco.MjData(simulation), 5e-4 * np.arange(400)
    torques, found = np.stack([30.0 * np.sin(40.0 * time), 12.0 * np.sin(23.0 * time)], axis=1), []
    for torque in torques:
        data.ctrl[:2] = torque
        mujoco.mj_step(simulation, data)
        found.append(data.qvel.copy())
    return torques, np.array(found)


def elsewhere(engine, tmp_path, *arguments):
    """What a program of `engines` prints in the environment of an engine."""
    python = os.environ.get(f"{engine.upper()}_PYTHON")
    if python is None:
        pytest.skip(f"{engine.upper()}_PYTHON names no environment with {engine}")
    program = Path(__file__).parent / "engines" / f"in_{engine}.py"
    done = subprocess.run(
        [python, str(program), *map(str, arguments)], capture_output=True, text=True, cwd=tmp_path, check=False
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return np.array(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["mjlab", "newton"])
def test_a_simulator_moves_the_arm_as_mujoco_does(engine, tmp_path):
    models = MODELS if engine == "mjlab" else {"shoulder": of(), "elbow": of(SPRING)}
    torques, expected = pushed(models)
    robot, joints, inputs = tmp_path / "robot.xml", tmp_path / "joints.py", tmp_path / "torques.json"
    robot.write_text(MJCF.replace(MJCF[MJCF.index("<actuator>") : MJCF.index("</mujoco>")], ""))
    joints.write_text(simulator_file(engine, models, None)[0])
    inputs.write_text(json.dumps((torques / (RATIO if engine == "mjlab" else 1.0)).tolist()))
    found = elsewhere(engine, tmp_path, robot, joints, inputs)
    off = np.abs(found - expected).max() / np.abs(expected).max()
    print(f"\n{engine}: {100 * off:.3f} % of the largest speed")
    assert off < 0.01


@pytest.mark.slow
def test_bam_reads_its_parameters(tmp_path):
    effects = (STRIBECK, DIRECTED)
    (tmp_path / "m5.json").write_text(simulator_file("bam", {"elbow": of(*effects)}, "xl330")[0])
    (tmp_path / "states.json").write_text(json.dumps(STATES))
    found = elsewhere("bam", tmp_path, tmp_path / "m5.json", tmp_path / "states.json")
    expected = [[level(effects, *state), PARAMETERS.viscous_friction_coefficient * RATIO**2] for state in STATES]
    np.testing.assert_allclose(found, expected, rtol=1e-9)
