from pathlib import Path

import pytest

from bench.plant.axis_model import AxisModel, AxisParameters
from bench.plant.drive import Cascade
from bench.plant.plant import Plant
from bench.rig.rig import Rig, load_rig

RIG = """
name = "axis"
kind = "rotary"
[motor]
rotor_inertia = "0.25 kg*cm**2"
torque_constant = "0.7 N*m/A"
peak_current = "5 A"
{motor}
[drive]
position_gain = "70 1/s"
velocity_gain = "0.9 N*m*s/rad"
integral_gain = "55 N*m/rad"
inertia_feedforward = "22 kg*cm**2"
[simulation]
moment_of_inertia = "22 kg*cm**2"
viscous_friction_coefficient = "1.1 mN*m*s/rad"
coulomb_friction = "85 mN*m"
{simulation}
"""


@pytest.fixture
def plant() -> Plant:
    cascade = Cascade(70.0, 0.9, 55.0, 2.2e-3, 3.5, 250e-6)
    return Plant(AxisModel(AxisParameters(2.2e-3, 1.1e-3, 0.085, motor_inertia=2.5e-5)), cascade, 250e-6)


@pytest.fixture
def rig_of(tmp_path: Path):
    def make(simulation: str = "", motor: str = "") -> Rig:
        path = tmp_path / "rig.toml"
        path.write_text(RIG.format(simulation=simulation, motor=motor), encoding="utf-8")
        return load_rig(path)

    return make
