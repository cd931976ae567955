"""Held-out motion, by which additions are judged; the judged fits do not use it."""

from __future__ import annotations

from dataclasses import dataclass

from bench.diagnosis.add.tracking import Recorded
from bench.diagnosis.recordings import Recordings
from bench.fit.rows import Rows

#: Share of a recording, at its end, that is held out if there is no holdout recording.
HELD_OUT = 1.0 / 3.0
#: Names of fitted and of judging motion.
RECORDING, FIRST_PART = "recording", "first two thirds of the recording"
HOLDOUT, LAST_THIRD = "holdout", "last third of the recording"


@dataclass(frozen=True)
class HeldOut:
    """Held-out motion.

    Attributes:
        fitted: rows that judged fits use.
        rows: their name.
        judge: rows they are judged by.
        recorded: the same for simulations.
        seen: motion that simulations may be fitted to.
    """

    fitted: Rows
    rows: str
    judge: Rows
    recorded: Recorded
    seen: Recorded

    @classmethod
    def of(cls, recordings: Recordings, trusted: bool, events: bool) -> HeldOut:
        """The holdout, or the last third of the recording.

        Args:
            recordings: of the diagnosis.
            trusted: whether the holdout is of this axis.
            events: whether the recording's events happen in the holdout too.
        """
        if recordings.holdout is not None and recordings.other is not None and trusted:
            recorded = Recorded.of(HOLDOUT, recordings.holdout, recordings.rig, events=events)
            seen = Recorded.of(RECORDING, recordings.trace, recordings.rig)
            return cls(recordings.rows, RECORDING, recordings.other, recorded, seen)
        time = recordings.trace.time
        split = float(time[0] + (1.0 - HELD_OUT) * (time[-1] - time[0]))
        recorded = Recorded.of(LAST_THIRD, recordings.trace, recordings.rig, split)
        fitted, judge = (_part(recordings.rows, split - time[0], late) for late in (False, True))
        seen = Recorded.of(FIRST_PART, recordings.trace, recordings.rig, until=split)
        return cls(fitted, FIRST_PART, judge, recorded, seen)


def _part(rows: Rows, split: float, late: bool) -> Rows:
    """The rows before or after a time, without those where the filter mixes both sides."""
    smooth = rows.conditioning.filter
    away = smooth.margin * smooth.sample_period
    return rows.selected(lambda time: time >= split + away if late else time < split - away)
