"""The recordings of a diagnosis, laid out: one that is fitted, and one that is not."""

from __future__ import annotations

from dataclasses import dataclass

from bench.diagnose.decidable import require_decidable, require_samples
from bench.diagnose.holdout import require_another
from bench.diagnose.sensing import VelocityLag, unlagged, velocity_lag
from bench.diagnose.workbench import Workbench
from bench.rig.rig import Rig
from bench.trace.trace import Trace


@dataclass(frozen=True)
class Recordings:
    """What a diagnosis reads.

    Attributes:
        rig: of the axis.
        trace: the recording.
        holdout: another one, not fitted; None without one.
        bench, other: both laid out.
        lag: of the reported speed behind position; None where there is none or it cannot be told.
    """

    rig: Rig
    trace: Trace
    holdout: Trace | None
    bench: Workbench
    other: Workbench | None
    lag: VelocityLag | None

    @classmethod
    def of(cls, trace: Trace, rig: Rig, holdout: Trace | None) -> Recordings:
        """Lay out both recordings; a reported speed that lags its position is taken back to where it would have been.

        Raises:
            UndeterminedError: the recording is too short, too slow or too quiet to decide.
            InputError: rig and recording do not fit together, or the holdout is the recording itself.
        """
        require_samples(trace)
        if holdout is not None:
            require_samples(holdout)
            require_another(trace, holdout)
        bench = Workbench.of(trace, rig)
        require_decidable(trace, rig, bench)
        lag, seen, unseen = velocity_lag(trace, bench), trace, holdout
        if lag is not None and bench.conditioning.source == "velocity":
            seen, unseen = unlagged(trace, lag), unlagged(holdout, lag) if holdout is not None else None
            bench = Workbench.of(seen, rig)
            require_decidable(seen, rig, bench)
        other = Workbench.of(unseen, rig, bench.conditioning.filter.width) if unseen is not None else None
        return cls(rig, trace, holdout, bench, other, lag)

    @property
    def unit(self) -> str:
        """Unit of the effort: N*m, N, or what the rig allows."""
        return self.rig.net_effort(self.trace)[1]
