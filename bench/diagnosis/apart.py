"""Differences between several recordings of a diagnosis: the model found, fitted to each of them alone."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bench.comparison.spread import ALARM, Between, Excess, between, excess, spread_warning
from bench.diagnosis.recordings import Recordings
from bench.errors import UndeterminedError
from bench.fit.determined import left_open, require_determined
from bench.fit.estimate import Alone, load_inertia
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis
from bench.fit.layout import lay_out
from bench.fit.parameter import Parameter
from bench.fit.quantities import uncertain
from bench.fit.solution import equations_of


@dataclass(frozen=True)
class Apart:
    """How recordings differ.

    Attributes:
        parameters: of all together, with intervals that count it.
        recordings: J, K_w and K_0 of each alone, beside the effects that were found; () of one.
        between: their spread, of what at least two tell.
        warnings: in what they differ.
    """

    parameters: dict[str, Parameter]
    recordings: tuple[Alone, ...] = ()
    between: Mapping[str, Between] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def apart(recordings: Recordings, whole: Fit, parameters: Mapping[str, Parameter]) -> Apart:
    """Compare the recordings.

    Args:
        recordings: laid out.
        whole: the model with all effects.
        parameters: of it.
    """
    found = dict(parameters)
    if not recordings.trace.joined:
        return Apart(found)
    alone = _each(recordings, whole)
    warnings, spread = [], {}
    for name in recordings.base_units:
        own = [one.parameters[name] for one in alone if name in one.parameters]
        if len(own) < 2:
            continue
        differ = excess([own])
        found[name] = widened(found[name], differ, own)
        spread[name] = between(own)
        if differ.chance < ALARM / len(recordings.base_units):
            warnings.append(spread_warning(name, own))
    found |= load_inertia(found, recordings.rig)
    return Apart(found, alone, spread, tuple(warnings))


def widened(found: Parameter, differ: Excess, own: Sequence[Parameter]) -> Parameter:
    """A joint value whose interval includes the spread between recordings, as far as averaging leaves it.

    Args:
        found: with its interval from the recordings' own errors.
        differ: spread of the recordings beyond these.
        own: estimate by each recording alone.
    """
    more = differ.of_joint(own)
    if not more:
        return found
    reach = math.hypot(found.half_width, differ.reach * more)
    interval = (found.value - reach, found.value + reach)
    return replace(found, std_error=math.hypot(found.std_error, more), ci95=interval)


def _each(recordings: Recordings, whole: Fit) -> tuple[Alone, ...]:
    kind, first = recordings.rig.axis_kind, float(recordings.trace.time[0])
    joined = recordings.trace.joined
    ends = [start - first for start, _ in joined[1:]] + [np.inf]
    found = []
    for (begun, origin), end in zip(joined, ends, strict=True):
        start = begun - first
        rows = whole.rows.selected(lambda time, start=start, end=end: (time >= start) & (time < end))
        equations = equations_of(rows, lay_out(rows, Hypothesis())) if rows.effort.size else None
        if equations is None:
            found.append(Alone(origin, {}, f"no filtered sample of {origin} moves clearly in one direction"))
            continue
        try:
            reason = ""
            require_determined(equations, kind)
        except UndeterminedError as refusal:
            reason = str(refusal)
        found_alone = uncertain(fit(rows, whole.hypothesis)).base(recordings.base_units)
        unknown = {kind.parameter(term) for term in left_open(equations, kind)}
        found.append(Alone(origin, {name: one for name, one in found_alone.items() if name not in unknown}, reason))
    return tuple(found)
