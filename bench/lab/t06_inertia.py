"""Task 6: inertia as the mean of M/alpha where the axis accelerates hard."""

from __future__ import annotations

from bench.identify.lab import mean_inertia
from bench.lab.result import Chart, Curve, Number, Panel, Task
from bench.lab.rig import rotor_inertia
from bench.lab.run import Run
from bench.rig.rig import Rig

KEY, TITLE = "6", "Moment of inertia without friction"

#: kg*cm**2 in one kg*m**2.
KG_CM2 = 1e4


def task(run: Run, rig: Rig) -> Task:
    """alpha_max, J from samples with |alpha| >= alpha_max/4, J_load = J - J_motor beside theory.

    Raises:
        UndeterminedError: the axis never accelerates.
        InputError: the rig does not give the rotor's inertia.
    """
    inertia, largest, taken = mean_inertia(run.acceleration, run.torque)
    rotor = rotor_inertia(rig)
    theory = rig.load.disk_inertia if rig.load else None
    true = run.true("moment_of_inertia", KG_CM2)
    numbers = [
        Number("alpha_max", largest, "rad/s²"),
        Number("J", inertia * KG_CM2, "kg·cm²", true),
        Number("J_load", (inertia - rotor) * KG_CM2, "kg·cm²", None if true is None else true - rotor * KG_CM2),
    ]
    says = [f"{taken.sum()} of {taken.size} samples accelerate at alpha_max/4 or more."]
    if theory is not None:
        numbers.append(Number("J_load, theory", theory * KG_CM2, "kg·cm²"))
        off = (inertia - rotor) / theory - 1.0
        says.append(f"J_load is {off:+.2%} off what the disk's geometry gives; hub and screws are not part of it.")
    curves = (
        Curve(run.time, run.torque, "measured torque", "wide"),
        Curve(run.time, inertia * run.acceleration, "J·α"),
    )
    chart = Chart("Task 6: J·α over the measured torque", (Panel("time / s", "torque / (N·m)", curves),))
    return Task(KEY, TITLE, tuple(says), tuple(numbers), (chart,))
