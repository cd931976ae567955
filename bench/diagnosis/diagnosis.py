"""Diagnosis in five steps: fit, where, name, add, show."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from pathlib import Path

from bench.diagnosis.add import add
from bench.diagnosis.name import name
from bench.diagnosis.policy import POLICY, Policy
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.show import Diagnosis, show
from bench.diagnosis.where import where
from bench.effects.present import named
from bench.gate.gate import joined, passed
from bench.rig.given import Given, recordings_of, rig_of, trace_of
from bench.rig.rig import Rig

Progress = Callable[[float], None]


def diagnose(
    trace: Given | Sequence[Given],
    rig: Rig | str | Path,
    holdout: Given | None = None,
    excluded: Collection[str] = (),
    progress: Progress = lambda share: None,
    policy: Policy = POLICY,
) -> Diagnosis:
    """Find what is missing, name it, add it, and show the gap shrink.

    Args:
        trace: the recording, or its file, arrays by their names or a data frame; or a list of several of one axis,
            which are joined (`bench.trace.trace.join`).
        rig: of the axis, or its file, or a shipped rig's name.
        holdout: another recording of it, not used to fit.
        excluded: names of effects that are not tried, or of one.
        progress: called with the share done.
        policy: numbers that decide on names.

    Raises:
        UndeterminedError: the recording is too short, too slow or too quiet to decide.
        InputError: rig and recording do not fit together, or a check of a recording fails.
    """
    rig = rig_of(rig)
    left_out = frozenset(named(one, "excluded").name for one in ([excluded] if isinstance(excluded, str) else excluded))
    gated = [passed(each, rig) for each in recordings_of(trace, rig)]
    unseen = passed(trace_of(holdout, rig), rig).trace if holdout is not None else None
    recordings = Recordings.of([each.trace for each in gated], rig, unseen)
    bare = fit_bare(recordings.rows)
    suspects = name(recordings, bare, left_out, policy)
    recordings, moves = recordings.steady(suspects.searched.last)
    if recordings.rows is not bare.rows:
        bare = fit_bare(recordings.rows)
        suspects = replace(suspects, searched=suspects.searched.through(recordings.rows))
    located = where(bare, rig.axis_kind, recordings.unit, recordings.current)
    progress(0.6)
    added = add(recordings, suspects)
    progress(0.9)
    shown, checks = show(recordings, bare, located, suspects, added), joined([each.checks for each in gated])
    return replace(shown, checks=checks, warnings=[*shown.warnings, *moves])
