"""From a recording to a trace: which channel is which signal, in SI units, on one regular time base."""

from __future__ import annotations

from collections.abc import Mapping

from bench.trace.channel import Recording
from bench.trace.choose import Chosen, choose
from bench.trace.in_si import in_si
from bench.trace.reading_options import ReadingOptions, reading_options
from bench.trace.time_base import regular
from bench.trace.trace import Trace


def assemble(recording: Recording, given: Mapping[str, str] | ReadingOptions | None = None) -> Trace:
    """Trace of a recording.

    Args:
        recording: as a reader returned it.
        given: signal (or `time`) -> column of the file with unit, e.g. `{"velocity": "-Axis1.ActVel [mm/s]"}`, where a
            leading `-` inverts the sign; or a rig's `[trace]`. Other signals are taken from columns with well-known
            names.

    Raises:
        InputError: a column missing, ambiguous, without unit or of the wrong dimension; no time; values that are not
            finite; times that run backwards or stand twice too often.
    """
    how = reading_options(given)
    chosen, notes = choose(recording, how)
    found = in_si(chosen, recording, how)
    dropped = unused(chosen, recording)
    used = regular(found.signals)
    metadata = {**recording.metadata, "format": recording.format}
    if dropped:
        metadata["dropped_columns"] = ", ".join(dropped)
    return Trace(
        time=used.time,
        signals=used.signals,
        units=found.units,
        origin=recording.origin,
        metadata=metadata,
        time_base=used.time_base,
        notes=(*recording.notes, *notes, *found.notes, *used.notes),
        wraps=found.wraps,
    )


def unused(chosen: Mapping[str, Chosen], recording: Recording) -> list[str]:
    """Names of the channels that are no signal of the trace."""
    used = {id(choice.channel) for choice in chosen.values()}
    return [channel.label for channel in recording.channels if id(channel) not in used]
