"""The full equation of motion M = J*alpha + K_w*omega + K_0*sgn(omega) + M_load/i, J = J_motor + J_load/i**2."""

from __future__ import annotations

from dataclasses import replace

from bench.axis_kind import OFFSET
from bench.course.axis import KG_CM2, rotor_inertia, simulated_with
from bench.course.recordings import LabRecordings
from bench.course.result import EXAMPLE, DoneTask, Number
from bench.fit.identify import identify
from bench.plant.axis_model import AxisParameters
from bench.plant.simulate import simulate
from bench.rig.load import Load
from bench.rig.rig import Rig

KEY, TITLE = "equation", "Load torque and gearbox"

#: Motor turns per turn of the load; inertia of the gear on the motor's side - kg*m**2; load torque, behind it - N*m.
RATIO, GEAR_INERTIA, LOAD_TORQUE = 3.0, 0.1e-4, 1.2
#: A disk so many times as heavy as the lab's turns behind the gear.
HEAVIER = 6.0


def geared(rig: Rig) -> Rig:
    """The lab's axis with a gear, a heavier disk and a load torque; identification fits a constant torque too."""
    load = rig.load or Load()
    inertia = HEAVIER * (load.disk_inertia or 0.0)
    load = load.model_copy(update={"gear_ratio": RATIO, "gear_inertia": GEAR_INERTIA})
    total = rotor_inertia(rig) + GEAR_INERTIA + load.reflected(inertia)
    rig = simulated_with(rig, moment_of_inertia=total, load_torque=LOAD_TORQUE, friction="mechanics")
    drive = rig.drive.model_copy(update={"inertia_feedforward": total}) if rig.drive else None
    return rig.model_copy(update={"load": load, "drive": drive, "offset": True})


def task(recordings: LabRecordings) -> DoneTask:
    """Simulate and identify it.

    Raises:
        InputError: the example's rig lacks what the simulation needs.
    """
    axis = geared(recordings.example)
    truth = AxisParameters.from_rig(axis)
    found = identify(simulate(axis).trace, axis)
    load = (truth.inertia - truth.motor_inertia) * RATIO**2
    numbers = (
        Number("J", found["moment_of_inertia"].value * KG_CM2, "kg·cm²", truth.inertia * KG_CM2),
        Number("J_load behind the gear", found["load_moment_of_inertia"].value * KG_CM2, "kg·cm²", load * KG_CM2),
        Number(
            "K_fric_w",
            found["viscous_friction_coefficient"].value,
            "N·m·s/rad",
            truth.viscous_friction_coefficient,
        ),
        Number("K_fric_0", found["coulomb_friction_torque"].value, "N·m", truth.coulomb_friction),
        Number("M_load behind the gear", found[axis.axis_kind.parameter(OFFSET)].value * RATIO, "N·m", LOAD_TORQUE),
    )
    findings = (
        f"With i = {RATIO:g} the motor feels J_load/i² and M_load/i. Simulated with {LOAD_TORQUE:g} N·m on the load "
        "and identified with a constant torque beside inertia and friction.",
    )
    return DoneTask(KEY, TITLE, findings, tuple(replace(number, source=EXAMPLE) for number in numbers), example=True)
