"""`bench limits`: a recording in the speed-torque diagram of its motor."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bench.course.operating_range import task
from bench.course.result import Task
from bench.errors import InputError
from bench.report.charts import chart_figure
from bench.report.figures import save_as_named
from bench.rig.rig import Rig
from bench.trace.trace import Trace


def operating_range(trace: Trace, rig: Rig) -> Task:
    """The recording's reserve to the motor's limits, at every mains voltage the rig has a curve for.

    Raises:
        InputError: a linear axis, no velocity, no torque in N*m to be had, or no limits in the rig.
    """
    if not rig.axis_kind.turns:
        raise InputError(rig.source, f"found a {rig.kind} axis", "allowed: a rotary one, whose motor has peak_curves")
    effort, unit = rig.effort(trace)
    if unit != "N*m":
        raise InputError(rig.source, f"gives the effort in {unit}", "the operating range needs it in N*m")
    return task(rig, trace["velocity"], np.asarray(effort), Path(trace.origin).name)


def draw_operating_range(found: Task, path: Path) -> None:
    """Write the diagram; the ending decides the format.

    Raises:
        InputError: another ending, or a place that cannot be written to.
    """
    save_as_named(chart_figure(found.charts[0]), path)
