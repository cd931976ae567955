"""Actuators of mjlab and Isaac Lab that `bench servo` and `bench robot` write, read as these simulators read them."""

import sys
from types import ModuleType, SimpleNamespace

import pytest

from bench.export.actuator import isaaclab_actuators, mjlab_actuators

SERVO = {"kp": 40.0, "kv": 1.5, "delay": 0.0123, "damping": 0.2, "frictionloss": 0.3, "armature": 0.01}
SERVOS = {"hip.joint": {**SERVO, "forcerange": 23.7}, "calf": {**SERVO, "delay": 0.0}}


@pytest.fixture
def loaded(monkeypatch):
    """What a module defines, whose classes keep what they are given."""
    for name in ("mjlab", "mjlab.actuator", "isaaclab", "isaaclab.actuators"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    sys.modules["mjlab.actuator"].BuiltinPositionActuatorCfg = SimpleNamespace
    sys.modules["isaaclab.actuators"].DelayedPDActuatorCfg = SimpleNamespace

    def load(text):
        names = {}
        exec(compile(text, "exported", "exec"), names)
        return names["ACTUATORS"]

    return load


def test_mjlab_has_gains_delay_and_joint(loaded):
    hip, calf = loaded(mjlab_actuators(SERVOS))
    assert hip.target_names_expr == (r"hip\.joint",)
    assert (hip.stiffness, hip.damping, hip.effort_limit) == (40.0, 1.5, 23.7)
    assert (hip.armature, hip.frictionloss, hip.viscous_damping) == (0.01, 0.3, 0.2)
    assert (hip.delay_min_lag, hip.delay_max_lag) == (2, 2)
    assert calf.delay_max_lag == 0
    assert not hasattr(calf, "effort_limit")


def test_isaac_lab_has_the_same(loaded):
    actuators = loaded(isaaclab_actuators(SERVOS))
    hip, calf = actuators["hip.joint"], actuators["calf"]
    assert hip.joint_names_expr == [r"hip\.joint"]
    assert (hip.friction, hip.dynamic_friction, hip.viscous_friction) == (0.3, 0.3, 0.2)
    assert (calf.friction, calf.dynamic_friction) == (0.3, 0.3)
    assert (hip.min_delay, hip.max_delay) == (2, 2)
