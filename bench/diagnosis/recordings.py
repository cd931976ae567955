"""The recordings of a diagnosis as rows of the torque balance: one that is fitted, and a holdout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.arrays import Array
from bench.diagnosis.decidable import require_another, require_decidable, require_samples
from bench.effects.acting import FilteredSignal
from bench.effects.catalogue import catalogue
from bench.effects.effect import Detectable, Detected, Effect
from bench.fit.fit import Fit, fit
from bench.fit.rows import Rows
from bench.rig.rig import Rig
from bench.trace.join import join
from bench.trace.trace import Trace


@dataclass(frozen=True)
class Recordings:
    """Input of a diagnosis.

    Attributes:
        rig: of the axis.
        trace: the recording, or several joined.
        corrected: the same with faults of its sensors corrected, as it is fitted.
        holdout: another recording, not fitted; None without one.
        rows, holdout_rows: rows of both, without those faults.
        detected: effects outside the torque balance that the signals show directly.
    """

    rig: Rig
    trace: Trace
    corrected: Trace
    holdout: Trace | None
    rows: Rows
    holdout_rows: Rows | None
    detected: Mapping[Effect, Detected]

    @classmethod
    def of(cls, trace: Trace | Sequence[Trace], rig: Rig, holdout: Trace | None) -> Recordings:
        """Rows of the recordings and of the holdout, after faults that the signals show directly are corrected.

        Raises:
            UndeterminedError: the recording is too short, too slow or too quiet to decide.
            InputError: rig and recording do not fit together, or the holdout is the recording itself.
        """
        traces = [trace] if isinstance(trace, Trace) else trace
        for each in (*traces, *([] if holdout is None else [holdout])):
            require_samples(each)
        trace = join(traces)
        if holdout is not None:
            for each in traces:
                require_another(each, holdout)
        rows = Rows.of(trace, rig)
        require_decidable(trace, rig, rows)
        width = rows.conditioning.filter.width
        shown = [effect for effect in catalogue().values() if isinstance(effect, Detectable)]
        found: dict[Effect, Detected | None] = {effect: effect.detect(trace, rig, width) for effect in shown}
        detected = {effect: those for effect, those in found.items() if those is not None}
        corrected, unseen = trace, holdout
        for effect, those in detected.items():
            if isinstance(effect, FilteredSignal) and effect.signal == rows.conditioning.source:
                corrected = _corrected(corrected, rig, effect, those)
                unseen = None if unseen is None else _corrected(unseen, rig, effect, those)
        if corrected is not trace:
            rows = Rows.of(corrected, rig)
            require_decidable(corrected, rig, rows)
        width, peak = rows.conditioning.filter.width, rows.scope.peak_effort
        holdout_rows = None if unseen is None else Rows.of(unseen, rig, width=width, peak_effort=peak)
        return cls(rig, trace, corrected, holdout, rows, holdout_rows, detected)

    def within_tolerance(self, fitted: Fit) -> list[Fit]:
        """A balance of the whole recording, refitted with each of the rig's values at the end of its tolerance."""
        if fitted.rows is not self.rows:
            return []
        same = self.rows.conditioning
        rigs = self.rig.within_tolerance()
        return [fit(Rows.of(self.corrected, rig, conditioning=same), fitted.hypothesis) for rig in rigs]

    @property
    def unit(self) -> str:
        """Unit of the effort: N*m, N, or what the rig allows."""
        return self.rig.net_effort(self.trace)[1]

    @property
    def current(self) -> Array | None:
        """Recorded current at the rows - A - (m,); None if another effort was recorded."""
        return self.corrected["current"][self.rows.samples()] if "current" in self.corrected else None

    @property
    def base_units(self) -> dict[str, str]:
        """Names of J, K_w and K_0 on this kind of axis, with their units."""
        return self.rig.axis_kind.base_parameters(self.unit)


def _corrected(trace: Trace, rig: Rig, effect: FilteredSignal, found: Detected) -> Trace:
    """A recording with a fault of its sensor corrected; without the faulty signal if that cannot be corrected."""
    if found.mends or rig.needs_speed(trace):
        return effect.corrected(trace, found.values)
    return trace.without(effect.signal)
