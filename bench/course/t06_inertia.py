"""Task 6: inertia as the mean of M/alpha where the axis accelerates hard."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.course.result import RECORDING, Chart, Curve, Number, Panel, Task
from bench.course.run import Run
from bench.course.sources import Sources, joined
from bench.errors import UndeterminedError
from bench.fit.lab import mean_inertia
from bench.rig.rig import Rig

KEY, TITLE = "6", "Moment of inertia without friction"

#: kg*cm**2 in one kg*m**2.
KG_CM2 = 1e4


def require_positive(inertia: float) -> None:
    """UndeterminedError where torque and acceleration oppose each other."""
    if not inertia > 0.0:
        raise UndeterminedError(
            "moment of inertia",
            f"it comes out as {inertia * KG_CM2:.3g} kg*cm**2, as torque and acceleration have opposite signs",
            'or turn one of them by a rig.toml beside it with [trace.columns] current = "-name of its column [unit]"',
        )


def load_inertia(inertia: float, rig: Rig, sources: Sources, true: float | None) -> tuple[list[Number], list[str]]:
    """J_load = J - J_motor beside the theory of the disk, as far as the rig tells them, and what is to be said of it.

    Args:
        inertia: J - kg*m**2.
        rig: with the rotor's inertia and the disk's geometry.
        sources: of these.
        true: J of a simulated axis - kg*cm**2.
    """
    rotor, theory = rig.motor.rotor_inertia, rig.load.disk_inertia if rig.load else None
    if rotor is None:
        return [], [f"J_load = J - J_motor is left open: {rig.source} gives no motor.rotor_inertia."]
    load, source = inertia - rotor, sources("motor", "rotor_inertia")
    numbers = [
        Number(
            "J_load",
            load * KG_CM2,
            "kg·cm²",
            None if true is None else true - rotor * KG_CM2,
            joined(RECORDING, f"J_motor: {source}"),
        )
    ]
    findings = [f"J_motor = {rotor * KG_CM2:.3g} kg·cm² ({source})."]
    if theory is not None:
        disk = sources("load", "outer_diameter")
        numbers.append(Number("J_load, theory", theory * KG_CM2, "kg·cm²", source=f"disk: {disk}"))
        findings.append(
            f"J_load is {load / theory - 1.0:+.2%} off what the disk's geometry gives ({disk}); hub, coupling and "
            "bolts are not part of it."
        )
    return numbers, findings


def task(run: Run, rig: Rig, sources: Sources) -> Task:
    """alpha_max, J from samples with |alpha| >= alpha_max/4, J_load = J - J_motor beside theory.

    Raises:
        UndeterminedError: the axis never accelerates, or torque and acceleration oppose each other.
    """
    inertia, largest, taken = mean_inertia(run.acceleration, run.torque)
    require_positive(inertia)
    true = run.true("moment_of_inertia", KG_CM2)
    loads, of_load = load_inertia(inertia, rig, sources, true)
    residual = run.torque - inertia * run.acceleration
    left = rms(residual[taken])
    numbers = (
        Number("alpha_max", largest, "rad/s²"),
        Number("J", inertia * KG_CM2, "kg·cm²", true),
        *loads,
        Number("RMS of M - J·α", left, "N·m"),
    )
    findings = (
        f"{taken.sum()} of {taken.size} samples accelerate at alpha_max/4 or more; J is the mean of M/α over them.",
        "In which unit? N·m over rad/s² is N·m·s² = kg·m², as the radian counts as 1; 1 kg·m² = 10⁴ kg·cm².",
        f"J·α compared with M: they leave {left:.3g} N·m RMS, {left / rms(run.torque[taken]):.1%} of the torque of "
        f"these samples. {_scatter(run, taken)}",
        *of_load,
    )
    curves = (
        Curve(run.time, run.torque, "measured torque M", "wide"),
        Curve(run.time, inertia * run.acceleration, "J·α"),
    )
    panels = (
        Panel("time / s", "torque / (N·m)", curves),
        Panel("time / s", "M - J·α / (N·m)", (Curve(run.time, residual),)),
    )
    return Task(KEY, TITLE, findings, numbers, (Chart("Task 6: J·α over the measured torque", panels),))


def _scatter(run: Run, taken: NDArray[np.bool_]) -> str:
    ratio: Array = run.torque[taken] / run.acceleration[taken]
    return (
        f"M/α itself scatters by {float(np.std(ratio) / abs(np.mean(ratio))):.1%} from sample to sample, most of it "
        "noise that the difference makes of the speed."
    )
