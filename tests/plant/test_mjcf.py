"""The MJCF files open in MuJoCo alone and show what they are."""

import mujoco
import numpy as np
import pytest

from bench.assets import asset
from bench.axis_kind import axis_kind
from bench.plant.axis_model import AxisParameters, build_spec
from bench.rig.rig import Load

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
