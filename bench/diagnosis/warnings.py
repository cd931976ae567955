"""Warnings: a unit, a range or a sensor that looks wrong, and what the recording does not determine."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bench.axis_kind import COULOMB, OFFSET, AxisKind
from bench.fit.fit import Fit
from bench.fit.parameter import Parameter
from bench.fit.rows import Rows
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Share of the samples that stand at exactly the largest value, in rows of so many, which no motion and no noise make.
CLIPPED, IN_A_ROW = 0.005, 5
#: Distance from the drive's own limit within which standing there is the drive's doing and the value true.
AT_LIMIT = 0.02


def suspicions(trace: Trace, rig: Rig, parameters: Mapping[str, Parameter]) -> list[str]:
    """Warnings: less inertia than the rotor alone has, or a signal that stands at the end of its range."""
    return [*_less_than_the_rotor(rig, parameters), *_clipped(trace, rig)]


def left_open(rows: Rows, kind: AxisKind) -> list[str]:
    """A warning of what motion in one direction does not determine."""
    if not rows.scope.one_way:
        return []
    offset, friction = kind.parameter(OFFSET), kind.parameter(COULOMB)
    forward = float(np.mean(rows.values(lambda s: s.sign))) > 0.0
    return [
        f"the axis moves {'forward' if forward else 'backward'} only: {friction} holds any "
        f"{offset} too, and no effect on friction was sought; record both directions for that"
    ]


def impacts(fitted: Fit, unit: str) -> list[str]:
    """A warning if rows that depend on the instants of impacts were excluded from the verdict."""
    share = 1.0 - float(fitted.determined.mean())
    if share == 0.0:
        return []
    return [
        f"{100.0 * share:.0f} % of the rows follow impacts so closely that their torque hangs on instants which the "
        f"recording does not tell: the verdict is by the others, on which {fitted.rms:.3g} {unit} are left; the torque "
        "gap counts all"
    ]


def _less_than_the_rotor(rig: Rig, parameters: Mapping[str, Parameter]) -> list[str]:
    found, rotor = parameters.get("moment_of_inertia"), rig.motor.rotor_inertia
    if found is None or rotor is None or found.unit != "kg*m**2" or found.ci95[1] >= rotor:
        return []
    return [
        f"the moment of inertia, {found.value:.3g} kg*m**2, is less than the rotor's alone, {rotor:.3g} kg*m**2: "
        "check the units of current and speed and the torque constant"
    ]


def _clipped(trace: Trace, rig: Rig) -> list[str]:
    found = []
    for name in ("current", "torque", "force"):
        if name not in trace:
            continue
        for side in (1.0, -1.0):
            values = side * trace[name]
            top = float(values.max())
            peak = rig.motor.peak_current if name == "current" else None
            limited = peak is not None and abs(top / peak - 1.0) < AT_LIMIT
            standing = _in_a_row(values == top)
            if top > 0.0 and standing > CLIPPED * len(trace) and not limited:
                found.append(
                    f"{standing / len(trace):.1%} of {name} stand at exactly {side * top:.4g} {trace.units[name]}: "
                    "the end of its range? What lies beyond is lost"
                )
    return found


def _in_a_row(standing: np.ndarray) -> int:
    """How many samples stand in runs of IN_A_ROW or longer."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], standing, [False]]).astype(int)))
    runs = edges[1::2] - edges[::2]
    return int(runs[runs >= IN_A_ROW].sum())
