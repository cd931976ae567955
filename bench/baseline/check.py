"""Check an axis, or a model of one, against its baseline."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from bench.baseline.allowed import Allowed
from bench.baseline.baseline import require_source
from bench.baseline.compare import Checked, compare
from bench.baseline.observe import Observed, diagnosed, identified
from bench.baseline.state import State
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Probability of a false alarm of an unchanged axis, over all comparisons together.
FALSE_ALARM_RATE = 0.01


def check(
    trace: Trace | Sequence[Trace],
    rig: Rig,
    baseline: State,
    false_alarm_rate: float = FALSE_ALARM_RATE,
    progress: Callable[[float], None] = lambda share: None,
) -> Checked:
    """Whether an axis still is as its baseline; effects are searched for if the baseline names them.

    Args:
        trace: a recording of the axis now, or a list of several.
        rig: of the axis.
        baseline: its earlier state (`bench.baseline.baseline.read_baseline`).
        false_alarm_rate: probability that an axis within its margins is called changed, over all comparisons.
        progress: called with the share done.

    Raises:
        UndeterminedError: the recording does not determine what the baseline holds.
        InputError: rig and recording do not fit together, or the baseline is that of a model.
    """
    require_source(baseline, "recordings")
    return compare(baseline, observe(trace, rig, baseline.names, progress), Allowed.of(rig), false_alarm_rate)


def observe(
    trace: Trace | Sequence[Trace], rig: Rig, names: bool = True, progress: Callable[[float], None] = lambda share: None
) -> Observed:
    """The state of an axis now.

    Args:
        trace: a recording, or a list of several.
        rig: of the axis.
        names: whether effects are searched for, which takes seconds; else only parameters and residual.
        progress: called with the share done.
    """
    traces = [trace] if isinstance(trace, Trace) else list(trace)
    return diagnosed(traces, rig, progress) if names else identified(traces, rig)
