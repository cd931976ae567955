"""The MJCF files open in MuJoCo alone and show what they are; the linearised model against closed forms."""

import mujoco
import numpy as np
import pytest

from bench.assets import asset
from bench.axis_kind import axis_kind
from bench.effects.present import Present
from bench.plant.axis_model import AxisModel, AxisParameters, build_spec
from bench.plant.linear import speed_over_torque
from bench.rig.rig import Load

FREQUENCY = np.geomspace(0.5, 400.0, 60)
S = 2j * np.pi * FREQUENCY
MOTOR, LOAD, VISCOUS = 1e-3, 2e-3, 2e-3


def axis(*effects):
    return AxisModel(AxisParameters(MOTOR + LOAD, VISCOUS, 0.05, motor_inertia=MOTOR), effects)


def test_one_mass_is_one_over_inertia_and_viscous_friction():
    assert speed_over_torque(axis(), FREQUENCY) == pytest.approx(1.0 / ((MOTOR + LOAD) * S + VISCOUS), rel=3e-3)


def test_two_masses_have_an_antiresonance_and_a_resonance():
    stiffness, damping = LOAD * (2.0 * np.pi * 40.0) ** 2, 0.02
    coupling = Present.of("elastic_coupling", {"stiffness": stiffness, "damping": damping})
    between = damping + stiffness / S
    behind = between * LOAD * S / (between + LOAD * S)
    found = speed_over_torque(axis(coupling), FREQUENCY)
    assert found == pytest.approx(1.0 / (MOTOR * S + VISCOUS + behind), rel=5e-3)


def test_a_dead_zone_is_not_linear():
    backlash = Present.of("backlash", {"gap": 0.01, "contact_stiffness": 500.0, "contact_damping": 0.1})
    assert speed_over_torque(axis(backlash), FREQUENCY) is None


KINDS = ("rotary", "linear")


@pytest.mark.parametrize("kind", KINDS)
def test_loads_alone_and_moves_under_torque(kind):
    model = mujoco.MjModel.from_xml_path(str(asset("mjcf", f"{kind}_axis.xml")))
    data = mujoco.MjData(model)
    inertia = np.zeros((1, 1))
    mujoco.mj_forward(model, data)
    mujoco.mj_fullM(model, data, inertia)
    data.ctrl[0] = 0.5
    for _ in range(100):
        mujoco.mj_step(model, data)
    assert data.qvel[0] == pytest.approx(0.5 / inertia[0, 0] * 100 * model.opt.timestep, rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_visible_geometry_adds_no_inertia(kind):
    parameters = AxisParameters(inertia=3.3e-3, motor_inertia=1e-4, kind=axis_kind(kind, "test"))
    spec = build_spec(parameters, 250e-6, Load.model_construct(outer_diameter=0.2, thickness=0.02, gear_ratio=1.0))
    with_geometry = spec.compile()
    for geom in list(spec.geoms):
        spec.delete(geom)
    assert with_geometry.dof_M0[0] == spec.compile().dof_M0[0]
    assert with_geometry.dof_M0[0] == pytest.approx(3.3e-3, rel=1e-14)


def test_disk_is_drawn_to_size():
    load = Load.model_construct(outer_diameter=0.2, thickness=0.02, gear_ratio=1.0)
    model = build_spec(AxisParameters(inertia=1e-3), 250e-6, load).compile()
    assert model.geom("disk").size[:2] == pytest.approx([0.1, 0.01])
    assert model.geom("angle mark").pos[0] == pytest.approx(0.01)  # on its face
    assert model.geom("angle mark").pos[2] + model.geom("angle mark").size[2] < 0.1


def test_model_survives_its_own_xml(tmp_path):
    parameters = AxisParameters(2.2e-3, 1.1e-3, 0.085, load_torque=0.02, motor_inertia=2.5e-5)
    spec = build_spec(parameters, 250e-6)
    model = spec.compile()
    again = mujoco.MjModel.from_xml_string(spec.to_xml())
    for name in ("dof_damping", "dof_frictionloss", "dof_armature", "dof_M0", "dof_solimp", "dof_solref"):
        np.testing.assert_allclose(getattr(again, name), getattr(model, name), rtol=1e-5, err_msg=name)
