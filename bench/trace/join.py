"""Several recordings of one axis as one trace: one after the other, with a hole between any two.

What belongs to a recording stays its own where the trace is read: time since its start (`Trace.joined`), and with it
what warms up or drifts, and the phase of mains hum. What belongs to the axis is shared: so is absolute position, as an
encoder that keeps its zero gives it. One that starts anew in every recording shifts what is periodic in position, which
then fits some of them and not the others.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.arrays import Array
from bench.errors import InputError
from bench.trace.time_base import TimeBase, interpolate
from bench.trace.trace import Trace

#: Sample periods between the end of a recording and the start of the next: a hole.
APART = 10.0
#: Share by which sample periods may differ and be one: derivatives are off by as much.
SAME = 1e-5


def join(traces: Sequence[Trace]) -> Trace:
    """One trace of several recordings, of the signals that all of them hold, at the longest of their sample periods.

    Raises:
        InputError: no recording, one that is given twice, or signals in different units.
    """
    if not traces:
        raise InputError("recordings", "found none", "allowed: at least one")
    if len(traces) == 1:
        return traces[0]
    _require_alike(traces)
    first, period = traces[0], max(trace.sample_period for trace in traces)
    names = [name for name in first.signals if all(name in trace for trace in traces)]
    left_out = sorted({name for trace in traces for name in trace.signals} - set(names))
    sampled = [_sampled(trace, names, period) for trace in traces]
    times, starts, begin = [], [], float(first.time[0])
    for time, _ in sampled:
        starts.append(begin)
        times.append(begin + (time - time[0]))
        begin = float(times[-1][-1]) + APART * period
    return Trace(
        time=np.concatenate(times),
        signals={name: np.concatenate([signals[name] for _, signals in sampled]) for name in names},
        units={name: first.units[name] for name in names},
        origin=" and ".join(trace.origin for trace in traces),
        metadata=first.metadata,
        time_base=TimeBase(period, resampled=any(_apart(trace, period) for trace in traces)),
        notes=(
            *(f"{trace.origin}: {note}" for trace in traces for note in trace.notes),
            *(f"{trace.origin} taken every {period:g} s, as others are" for trace in traces if _apart(trace, period)),
            *([f"{', '.join(left_out)}: left out, not every recording holds it"] if left_out else []),
        ),
        joined=tuple(zip(starts, (trace.origin for trace in traces), strict=True)),
    )


def _require_alike(traces: Sequence[Trace]) -> None:
    for index, other in enumerate(traces):
        for one in traces[:index]:
            for name in set(one.signals) & set(other.signals):
                if one.units[name] != other.units[name]:
                    found = f"found {other.units[name]}, in {one.origin} {one.units[name]}"
                    raise InputError(f"{other.origin}: {name}", found, "allowed: one unit in all recordings")
            alike = set(one.signals) == set(other.signals)
            if alike and all(np.array_equal(one[name], other[name]) for name in one.signals):
                found = f"found the same recording as {one.origin}"
                raise InputError(other.origin, found, "allowed: each recording once; twice would count as two")


def _apart(trace: Trace, period: float) -> bool:
    return abs(trace.sample_period / period - 1.0) > SAME


def _sampled(trace: Trace, names: Sequence[str], period: float) -> tuple[Array, dict[str, Array]]:
    """Times and signals of a recording at a sample period, stretch by stretch; as they are where it has that period."""
    if not _apart(trace, period):
        return trace.time, {name: trace[name] for name in names}
    times: list[Array] = []
    signals: dict[str, list[Array]] = {name: [] for name in names}
    for part in trace.segments:
        time = trace.time[part]
        times.append(time[0] + period * np.arange(int((time[-1] - time[0]) / period * (1.0 + 1e-12)) + 1))
        for name in names:
            signals[name].append(interpolate(times[-1], time, trace[name][part]))
    return np.concatenate(times), {name: np.concatenate(values) for name, values in signals.items()}
