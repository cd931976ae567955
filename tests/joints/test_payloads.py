"""A joint that swings several masses, each on a pendulum of its own length: one armature, one friction, one kT.

The torque is written out, J*a + m*l**2*a + B*w + C*sgn(w) + m*g*l*sin(q); nothing of MuJoCo is in the logs.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.joints.friction_models import MODELS, LoadedMotion, friction_models, predicted
from bench.plant.robot import Robot, joint_rig, read_log
from tests.command import bench as command

ARMATURE, VISCOUS, COULOMB = 0.012, 0.05, 0.15
#: Mass - kg - and length - m - of each pendulum.
PENDULUMS = {"a": (0.3, 0.1), "b": (0.9, 0.15), "c": (0.5, 0.2)}
MJCF = """<mujoco><option gravity="0 0 -9.81"/><worldbody><body><joint name="j" axis="{axis}"/>
<inertial pos="0 0 -{length}" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/></body></worldbody></mujoco>"""


def coulomb(free, load, sign):
    """Torque of the motor (n,) with Coulomb friction, by that without."""
    return free + COULOMB * sign


def directional(free, load, sign):
    """The same with BAM's M5, M = free + sign*(K_0 + |K_m*M + K_e*load|), which is linear on each side of the bars."""
    of = [(free + sign * (0.02 + side * 0.05 * load)) / (1.0 - sign * side * 0.25) for side in (1.0, -1.0)]
    return np.where(0.25 * of[0] + 0.05 * load >= 0.0, *of)


def swung(
    folder, names, effort="torque [N*m]", per_torque=1.0, stated=None, axis="0 1 0", friction=coulomb, period=2e-3
):
    """Logs of 12 s of some pendulums, and an MJCF of each, with the masses that are `stated`."""
    rng, time = np.random.default_rng(0), period * np.arange(round(12.0 / period))
    for name in names:
        mass, length = PENDULUMS[name]
        omega, size = 2.0 * np.pi * np.array([[0.3], [1.1], [2.3]]), np.array([[1.2], [0.3], [0.1]])
        angle = omega * time + rng.uniform(0.0, 2.0 * np.pi, (3, 1))
        q, w = (size * np.sin(angle)).sum(0), (size * omega * np.cos(angle)).sum(0)
        a = -(size * omega**2 * np.sin(angle)).sum(0)
        load = mass * 9.81 * length * np.sin(q) * (axis == "0 1 0")
        torque = friction((ARMATURE + mass * length**2) * a + VISCOUS * w + load, load, np.sign(w))
        columns = {
            "time [s]": time,
            "j.position [rad]": q + 1e-4 * rng.standard_normal(time.size),
            "j.velocity [rad/s]": w + 5e-3 * rng.standard_normal(time.size),
            f"j.{effort}": per_torque * (torque + 0.01 * rng.standard_normal(time.size)),
        }
        table, header = np.column_stack(list(columns.values())), ",".join(columns)
        np.savetxt(folder / f"{name}.csv", table, "%.8g", ",", header=header, comments="")
        mass = (stated or {}).get(name, mass)
        (folder / f"{name}.xml").write_text(MJCF.format(axis=axis, length=length, mass=mass))
    return [folder / f"{name}.csv" for name in names], [folder / f"{name}.xml" for name in names]


def holds(parameter, true):
    return parameter.ci95[0] <= true <= parameter.ci95[1]


def test_several_payloads_have_one_armature_and_a_torque_scale_that_nothing_else_looks_like(tmp_path):
    """On one pendulum an unbalance looks like a scale of the torque, and so do heavier links."""
    joint = bench.robot(*swung(tmp_path, "abc", per_torque=1.3)).joints["j"]
    assert joint.diagnosis is not None
    (scale,) = joint.diagnosis.effects
    assert scale.name == "torque_scale"
    assert not scale.ambiguous_with
    assert not joint.contested
    assert scale.values["scale"] == pytest.approx(1.3, rel=2e-3)
    true = {"armature": ARMATURE, "viscous_friction_coefficient": VISCOUS, "coulomb_friction_torque": COULOMB}
    for name, value in true.items():
        assert joint.parameters[name].value == pytest.approx(value, rel=0.01), name
        assert holds(joint.parameters[name], value), name
    assert not any("known weight" in warning for warning in joint.warnings)


def test_a_payload_that_its_mjcf_has_wrong_is_reported_with_its_log(tmp_path):
    logs, mjcfs = swung(tmp_path, "abc", stated={"b": 0.99}, period=16e-3)
    joint = bench.robot(logs, mjcfs, excluded=[*catalogue()]).joints["j"]
    (warning,) = [one for one in joint.warnings if "known weight" in one]
    assert "0.909 ± " in warning.split("in a.csv")[1].split("in b.csv")[0]


def test_currents_count_by_the_weight_of_the_links_and_in_their_own_direction(tmp_path):
    """kT is -0.8 N*m/A: the log counts the current against the joint's angle."""
    logs, mjcfs = swung(tmp_path, "ab", "current [A]", -1.0 / 0.8, period=4e-3)
    line = ["robot", *logs, *(word for one in mjcfs for word in ("--mjcf", one))]
    done = command(*line, "--out", tmp_path / "found")
    assert done.status == 0, done.err
    assert "Torque constants by the weight of the links" in done.out
    found = json.loads((tmp_path / "found" / "robot.json").read_text())
    parameters = found["joints"]["j"]["parameters"]
    low, high = parameters["torque_constant"]["ci95"]
    assert low < -0.8 < high
    assert high - low < 0.005
    assert parameters["armature"]["value"] == pytest.approx(ARMATURE, rel=0.01)
    assert [one["file"].rpartition("/")[2] for one in found["provenance"]["mjcf"]] == ["a.xml", "b.xml"]


def test_without_a_weight_that_moves_a_current_is_no_torque(tmp_path):
    """About the vertical the links' inertia is constant, and none of it is known apart from the armature's."""
    joint = bench.robot(*swung(tmp_path, "a", "current [A]", 2.0, axis="0 0 1")).joints["j"]
    assert not joint.parameters
    assert "no known weight of links or payload moves clearly" in joint.refused["effects"]
    assert "torque_constant under [joints.j]" in joint.record


def test_an_mjcf_is_of_all_logs_or_of_one_each(tmp_path):
    logs, mjcfs = swung(tmp_path, "abc")
    with pytest.raises(InputError, match="--mjcf: found 2 MJCF files for 3 logs; allowed: one for all"):
        bench.robot(logs, mjcfs[:2])


@pytest.mark.parametrize(("friction", "name", "period"), [(coulomb, "M1", 48e-3), (directional, "M5", 16e-3)])
def test_the_friction_model_of_a_servo_is_the_simplest_that_predicts_its_torque(tmp_path, friction, name, period):
    """M5 includes M1, and M6 both: none that is larger predicts better than the noise of the torque, 0.01 N*m."""
    logs, mjcfs = swung(tmp_path, "ab", friction=friction, period=period)
    first = Robot.of(mjcfs[0], "j")
    rig = joint_rig(None, first)
    robots = [first, *(replace(Robot.of(mjcf, "j"), datum=first.inertia) for mjcf in mjcfs[1:])]
    models = friction_models([read_log(log, rig, robot, {}) for log, robot in zip(logs, robots, strict=True)], rig)
    (chosen,) = [model for model in models if model.chosen]
    assert chosen.name == name
    assert chosen.error < 0.02  # noise of torque and acceleration
    assert chosen.parameters["armature"] == pytest.approx(ARMATURE, rel=0.05)
    if name == "M5":
        assert chosen.error < 0.2 * models[0].error
        factor = chosen.parameters["load_friction_motor"], chosen.parameters["load_friction_external"]
        assert factor == pytest.approx((0.25, 0.05), abs=0.01)


def test_the_torque_of_the_fullest_friction_model_solves_its_equation():
    """Of BAM's M6 (Duclusaud et al., 2024) at drawn motions and loads, of either sign against the torque."""
    rng, sizes = np.random.default_rng(0), ("acceleration", "speed", "load", "momentum_rate")
    drawn = {name: rng.normal(size=400) for name in sizes}
    sign = np.sign(drawn["speed"])
    motion = LoadedMotion(**drawn, sign=sign, torque=np.zeros(400), log=np.zeros(400, dtype=np.intp))
    names = [*MODELS["M6"][3:]]
    values = {"armature": 0.5, "friction_viscous": 0.3, "friction_base": 0.2, "dtheta_stribeck": 0.7, "alpha": 1.3}
    values |= {name: 0.02 * (k + 1) for k, name in enumerate(names) if name not in values}
    m, load = predicted(motion, values), drawn["load"]
    constant = values["friction_base"] + np.abs(
        values["load_friction_motor"] * m + values["load_friction_external"] * load
    )
    rise = values["friction_stribeck"] + np.abs(
        values["load_friction_motor_stribeck"] * m + values["load_friction_external_stribeck"] * load
    )
    driven, holding = values["load_friction_external_quad"] * load**2, values["load_friction_motor_quad"] * m**2
    rise = rise + np.where(load * m > 0.0, np.where(np.abs(load) < np.abs(m), driven, holding), 0.0)
    friction = constant + rise * np.exp(-((np.abs(drawn["speed"]) / 0.7) ** 1.3))
    known = 0.5 * drawn["acceleration"] + 0.3 * drawn["speed"] + drawn["momentum_rate"] + load
    solved = np.isclose(m, known + sign * friction, rtol=1e-6, atol=1e-6)
    assert solved.mean() > 0.97  # at a border of the cases the equation has no solution
