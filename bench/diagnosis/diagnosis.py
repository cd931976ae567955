"""Diagnosis in five steps: fit, where, name, add, show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from bench.diagnosis.add import add
from bench.diagnosis.name import name
from bench.diagnosis.policy import POLICY, Policy
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.show import Diagnosis, show
from bench.diagnosis.where import where
from bench.gate.gate import joined, passed
from bench.rig.rig import Rig
from bench.trace.trace import Trace

Progress = Callable[[float], None]


def diagnose(
    trace: Trace | Sequence[Trace],
    rig: Rig,
    holdout: Trace | None = None,
    excluded: frozenset[str] = frozenset(),
    progress: Progress = lambda share: None,
    policy: Policy = POLICY,
) -> Diagnosis:
    """Find what is missing, name it, add it, and show the gap shrink.

    Args:
        trace: the recording, or a list of several of one axis, which are joined (`bench.trace.join`).
        rig: of the axis.
        holdout: another recording of it, not used to fit.
        excluded: effects that are not tried.
        progress: called with the share done.
        policy: numbers that decide on names.

    Raises:
        UndeterminedError: the recording is too short, too slow or too quiet to decide.
        InputError: rig and recording do not fit together, or a check of a recording fails.
    """
    gated = [passed(each, rig) for each in ([trace] if isinstance(trace, Trace) else trace)]
    unseen = passed(holdout, rig).trace if holdout is not None else None
    recordings = Recordings.of([each.trace for each in gated], rig, unseen)
    bare = fit_bare(recordings.rows)
    located = where(bare, rig.axis_kind, recordings.unit, recordings.current)
    suspects = name(recordings, bare, excluded, policy)
    progress(0.6)
    added = add(recordings, suspects)
    progress(0.9)
    return replace(show(recordings, bare, located, suspects, added), checks=joined([each.checks for each in gated]))
