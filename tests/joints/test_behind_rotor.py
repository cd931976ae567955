"""Torque that is measured on the joint's side of the gear: neither the rotor nor the friction of the drive is in it."""

from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.errors import UndeterminedError
from bench.joints.identified import JointLogs, identified
from tests.export.two_links import HIDDEN, MJCF, log, write_log

VISCOUS, COULOMB, RATIO = 0.06, 0.4, 50.0
RIG = {"name": "arm", "kind": "rotary", "joints": {"elbow": {"torque": "joint side", "gear_ratio": RATIO}}}


def light(behind_rotor):
    """A recording of a joint whose links weigh next to nothing, and its rig."""
    rng, time = np.random.default_rng(0), 2e-3 * np.arange(6000)
    phase = 2.0 * np.pi * np.array([0.2, 0.53, 0.9])[:, None] * time
    speed = (np.array([1.0, 0.6, 0.3])[:, None] * np.sin(phase)).sum(axis=0)
    torque = VISCOUS * speed + COULOMB * np.sign(speed)
    noisy = {"velocity [rad/s]": speed, "torque [N*m]": torque}
    noisy = {name: values + 0.01 * rng.standard_normal(time.size) for name, values in noisy.items()}
    rig = bench.Rig.of({"name": "wrist", "kind": "rotary", "load": {}})
    load = rig.load.model_copy(update={"link_inertia": 1e-6, "behind_rotor": behind_rotor})
    return bench.Trace.from_arrays({"time [s]": time, **noisy}), rig.model_copy(update={"load": load})


def test_friction_stands_where_the_inertia_may_be_nothing():
    with pytest.raises(UndeterminedError, match="inertia cannot be determined"):
        bench.identify(*light(behind_rotor=False))
    found = bench.identify(*light(behind_rotor=True))
    assert found["coulomb_friction_torque"].value == pytest.approx(COULOMB, rel=0.01)
    assert found["viscous_friction_coefficient"].value == pytest.approx(VISCOUS, rel=0.03)
    assert "armature" not in found.parameters


def test_the_joints_torque_stands_beside_the_motors_angle(tmp_path):
    """Of a drive that counts turns of the motor and has a torque sensor behind the gear."""
    columns = log(replace(HIDDEN, armature=0.0, cogging=0.0))
    for signal in ("position [rad]", "velocity [rad/s]"):
        columns[f"elbow.{signal}"] = RATIO * columns[f"elbow.{signal}"]
    (tmp_path / "arm.xml").write_text(MJCF)
    logged = write_log(tmp_path / "log.csv", columns)
    found = identified(JointLogs("elbow", tmp_path / "arm.xml", (logged,), rig=bench.Rig.of(RIG)))
    beyond = found.diagnosis.parameters  # friction of the link's own bearing, which is in such a torque
    assert beyond["coulomb_friction_torque"].value * RATIO == pytest.approx(HIDDEN.coulomb, rel=0.02)
    assert beyond["viscous_friction_coefficient"].value * RATIO**2 == pytest.approx(HIDDEN.viscous, rel=0.02)
    for name in ("armature", "viscous_friction_coefficient", "coulomb_friction_torque"):
        assert "on the joint's side" in found.refused[name]
        assert name not in found.parameters
    assert found.model is None
