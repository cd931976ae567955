"""Motion by which additions are judged and that no judged fit uses: a holdout, or a third of the recording.

Cut by time, a third may go one way where the rest goes the other: an axis may stand for half a recording. So the moving
rows are cut into blocks, each long beside the filter and what it correlates, and a block is held out if that
brings the part nearer to a third of each regime: in each direction of slow, middle and fast rows, and of those at low,
middle and high positions (minimisation: S. J. Pocock, R. Simon, Biometrics 31, 1975, 103-115). Rows within the filter's
reach of a border are in neither part.

A part judges only what it determines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.diagnosis.model import HOLDOUT, RECORDING, Recorded
from bench.diagnosis.recordings import Recordings
from bench.effects.effect import Occasional
from bench.fit.determined import INDEPENDENT_SHARE
from bench.fit.fit import Fit
from bench.fit.layout import lay_out
from bench.fit.rows import Rows

#: Share of a recording that is held out if there is no holdout recording.
HELD_OUT = 1.0 / 3.0
#: Blocks that moving rows are cut into, and reaches of the filter that a block is long at least. Of 13 shared cases and
#: seven recordings of real axes the regime that is held out least keeps 0.20 of its rows in the median, 0.15 with 12
#: blocks, where it has none in two; borders take 3 % of the rows at 1 kHz, 10 to 18 % at 48 Hz.
BLOCKS, REACHES = 24, 8
#: Ranges of speed, and of position, of equally many rows each.
RANGES = 3
#: Share of its largest torque above which an event acts on a row.
ACTS = 1e-3
#: Names of the motion that simulations may be fitted to and of judging motion, if both are of one recording.
REST, THIRD = "rest of the recording", "third of the recording that was held out"


@dataclass(frozen=True)
class HeldOut:
    """Motion by which additions are judged; the judged fits do not use it.

    Attributes:
        fitted: rows that judged fits use.
        judge: rows they are judged by.
        recorded: the same for simulations.
        seen: motion that simulations may be fitted to.
    """

    fitted: Rows
    judge: Rows
    recorded: Recorded
    seen: Recorded

    @classmethod
    def of(cls, recordings: Recordings, trusted: bool, events: bool, whole: Fit) -> HeldOut:
        """A holdout that is `trusted` to be of this axis, with the recording's events or not; else a third.

        Args:
            whole: of the recording, whose events stay in the rest where that would lack one: of arbitrary size there,
                it would judge all else.
        """
        trace, rig, rows = recordings.trace, recordings.rig, recordings.rows
        if recordings.holdout is not None and recordings.holdout_rows is not None and trusted:
            recorded = Recorded(HOLDOUT, recordings.holdout, rig, events=events)
            return cls(rows, recordings.holdout_rows, recorded, Recorded(RECORDING, trace, rig))
        plain = cls.third(recordings)
        events_of = [k for k, term in enumerate(whole.terms) if isinstance(term.effect, Occasional)]
        lacked = [k for k in events_of if plain.lacks(whole, k)]
        if not lacked:
            return plain
        acts = np.abs(lay_out(rows, whole.hypothesis).columns[:, np.isin(whole.owners, lacked)])
        return cls.third(recordings, np.any(acts > ACTS * acts.max(axis=0), axis=1))

    @classmethod
    def third(cls, recordings: Recordings, kept: NDArray[np.bool_] | bool = False) -> HeldOut:
        """A third of every regime, in no block that holds one of the rows `kept` (m,), judges a fit to the rest."""
        trace, rig, rows = recordings.trace, recordings.rig, recordings.rows
        smooth, count = rows.conditioning.filter, rows.effort.size
        shortest = REACHES * smooth.margin // smooth.stride
        edges = np.linspace(0, count, int(np.clip(count // shortest, 3, BLOCKS)) + 1).astype(int)
        shown = np.add.reduceat(regimes(rows), edges[:-1], axis=0)
        free = ~np.logical_or.reduceat(np.broadcast_to(kept, count), edges[:-1])
        borders, out, reach = rows.time[edges[1:-1]], balanced(shown, free), smooth.margin * smooth.sample_period

        def held(time: Array) -> NDArray[np.bool_]:
            return out[np.searchsorted(borders, time, side="right")]

        def apart(part: bool) -> Rows:
            """Rows of one part, over all of the filter's reach."""
            reaches = (-reach, 0.0, reach)
            return rows.selected(lambda time: np.all([held(time + ahead) == part for ahead in reaches], axis=0))

        judging = held(trace.time - trace.time[0])
        recorded, seen = Recorded(THIRD, trace, rig, judging), Recorded(REST, trace, rig, ~judging)
        return cls(apart(False), apart(True), recorded, seen)

    def lacks(self, whole: Fit, index: int) -> bool:
        """Whether the fitted rows do not tell the strengths of a term of a fit to the recording."""
        own, columns = whole.owners == index, lay_out(self.fitted, whole.hypothesis).columns
        return not _information(columns, own) > INDEPENDENT_SHARE * _information(whole.columns, own)

    def determines(self, judged: Fit, whole: Fit, index: int) -> bool:
        """Whether fitted and judging rows both tell the strengths of a term that have a column.

        Args:
            judged: to the fitted rows.
            whole: the same hypothesis fitted to the recording, beside which a part may be ten times as uncertain.
            index: of the term.
        """
        own = whole.owners == index
        if not own.any():
            return True
        least = INDEPENDENT_SHARE * _information(whole.columns, own)
        parts = judged.columns, lay_out(self.judge, judged.hypothesis).columns
        return all(_information(columns, own) > least for columns in parts)


def _information(columns: Array, own: NDArray[np.bool_]) -> float:
    """Least information of columns (m, p) about a combination of some of them beside the others, in its noise power."""
    others = np.linalg.qr(columns[:, ~own])[0]
    left = columns[:, own] - others @ (others.T @ columns[:, own])
    return float(np.linalg.eigvalsh(left.T @ left)[0])


def regimes(rows: Rows) -> Array:
    """1 where a row is of a regime, else 0 (m, r): ranges of speed, and of position, in each direction."""
    forward = rows.values(lambda s: s.sign) > 0.0
    found = []
    for values in (np.abs(rows.values(lambda s: s.velocity)), rows.values(lambda s: s.position)):
        limits = np.quantile(values, np.arange(1, RANGES) / RANGES)
        found.append(np.searchsorted(limits, values) + RANGES * forward == np.arange(2 * RANGES)[:, None])
    return np.concatenate(found).T.astype(float)


def balanced(shown: Array, free: NDArray[np.bool_] | bool = True) -> NDArray[np.bool_]:
    """Which of the blocks that are `free` (b,) are held out, by how many rows of each regime each shows (b, r)."""
    lacks, out = np.zeros(shown.shape[1]), np.array(np.broadcast_to(free, shown.shape[0]))
    for block, own in enumerate(shown):
        lacks = lacks + HELD_OUT * own
        out[block] &= 2.0 * own @ lacks > own @ own  # it brings the part nearer to its third
        lacks = lacks - out[block] * own
    return out
