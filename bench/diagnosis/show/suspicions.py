"""What a recording or its result looks like when a unit, a range or a sensor is wrong, found as warnings."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bench.fit.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Share of the samples that stand at exactly the largest value, in rows of so many, which no motion and no noise make.
CLIPPED, IN_A_ROW = 0.005, 5
#: Distance from the drive's own limit within which standing there is the drive's doing and the value true.
AT_LIMIT = 0.02


def suspicions(trace: Trace, rig: Rig, parameters: Mapping[str, Parameter]) -> list[str]:
    """Warnings: less inertia than the rotor alone has, or a signal that stands at the end of its range."""
    return [*_less_than_the_rotor(rig, parameters), *_clipped(trace, rig)]


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
