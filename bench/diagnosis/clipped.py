"""An effort that stands at the end of its range: what lies beyond is lost."""

from __future__ import annotations

import numpy as np

from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Share of the samples that stand at exactly the largest value, in rows of so many, which no motion and no noise make.
CLIPPED, IN_A_ROW = 0.005, 5
#: Distance from the drive's own limit within which standing there is the drive's doing and the value true.
AT_LIMIT = 0.02


def clipped(trace: Trace, rig: Rig) -> list[str]:
    """A warning of each signal of the effort that stands at the end of its range."""
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
