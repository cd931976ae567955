"""The default estimator: least squares of the torque balance without effects, of a recording or of several."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from bench.fit.alone import estimated_alone
from bench.fit.estimate import Estimate
from bench.fit.gathered import gather
from bench.fit.several import estimated_together
from bench.rig.rig import Rig
from bench.trace.trace import Trace


def identify(
    trace: Trace | Iterable[Trace] | Sequence[Trace | Iterable[Trace]], rig: Rig, cutoff: float | None = None
) -> Estimate:
    """Inertia, viscous and Coulomb friction (and offset, if the rig asks for it) of a recording, or of several.

    Each recording goes through the gate, is laid out in rows through one filter, and is summed up in normal equations
    at the cut-off at which the estimate stands still; these are solved, alone or together, with intervals that count
    correlated residuals, misfit, tolerances and what the recording hints at. What is not determined is refused.

    Args:
        trace: the recording; an iterator over its consecutive parts, for one that does not fit into memory; or a list
            (tuple) of several recordings of one axis, which are fitted together (`bench.fit.several`).
        rig: what is known about the axis.
        cutoff: half-power frequency of the filter instead of the one chosen from the data - Hz.

    Raises:
        RefusedEstimateError: the recordings leave one of them undetermined; the error carries the others.
        UndeterminedError: they determine none, or one of several recordings never moves clearly.
        InputError: no recording, one that is given twice, a signal is missing, efforts in different units, rig and
            trace do not fit together, or a check of a recording fails.
    """
    recordings = trace if isinstance(trace, Sequence) else [trace]
    gathered = [gather(one, rig, cutoff) for one in recordings]
    return estimated_alone(gathered[0], rig) if len(gathered) == 1 else estimated_together(gathered, rig)
