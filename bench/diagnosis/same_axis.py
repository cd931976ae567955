"""How recordings of one axis differ: a holdout, which else validates nothing, and several that are joined."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from bench.arrays import NORMAL95, rms
from bench.comparison.difference import Difference
from bench.comparison.spread import ALARM, Between, Excess, between, excess, spread_warning
from bench.diagnosis.recordings import Recordings
from bench.effects.effect import Occasional
from bench.fit.determined import left_open, refusals
from bench.fit.estimate import Alone, load_inertia
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis, lay_out
from bench.fit.quantities import uncertain
from bench.fit.rows import Rows
from bench.fit.solution import equations_of
from bench.names import percent
from bench.parameter import Parameter

#: Factors by which J, K_w and K_0 of one axis may differ between recordings without a warning.
REPORTED = (1.01, 1.3, 1.1)
#: Factors beyond which it is another axis: magnets warm by a few percent of inertia, lubricants change friction.
FOREIGN = (1.03, 3.0, 1.5)
#: Standard errors in addition to these factors.
SURE = 3.0
#: Largest residual of the model refitted to the holdout: as share of its torque, and as multiple of the recording's.
LEFT, MORE = 0.2, 3.0
#: Standard error of the ratio of inertias above which the comparison is inconclusive.
VAGUE = 0.1


@dataclass(frozen=True)
class SameAxis:
    """Whether the holdout is of the same axis.

    Attributes:
        same: None if unknown: without a holdout, with an inconclusive one, or if only friction differs, which other
            conditions may explain.
        differs: names of quantities that differ by more than errors and daily variation, each with its estimate from
            the recording and from the holdout, with the effects that were found.
        warnings: about another axis.
    """

    same: bool | None
    differs: Mapping[str, tuple[Parameter, Parameter]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def same_axis(fitted: Fit, other: Rows | None, units: Mapping[str, str]) -> SameAxis:
    """Compare J, K_w and K_0 - units - of a recording's fit and of the holdout, with the effects that last."""
    if other is None:
        return SameAxis(None)
    lasting = fitted.hypothesis.with_terms(term for term in fitted.terms if not isinstance(term.effect, Occasional))
    here, there = fit(fitted.rows, lasting, fitted), fit(other, lasting, fitted)
    own, others = uncertain(here).base(units), uncertain(there).base(units)
    differs, apart, vague = dict[str, tuple[Parameter, Parameter]](), list[str](), True
    for k, (name, label) in enumerate(zip(units, ("inertia", "viscous friction", "Coulomb friction"), strict=True)):
        if not own[name].value > 0.0:
            continue
        found = Difference.relative(own[name], others[name])
        vague = vague and not (k == 0 and found.std_error < VAGUE)
        if _beyond(REPORTED[k], found):
            differs[name] = own[name], others[name]
        if _beyond(FOREIGN[k], found):
            apart.append(f"{1.0 + found.value:.3g} times the {label} (± {NORMAL95 * found.std_error:.2g})")
    left, least = (found.rms / rms(found.effort) for found in (there, here))
    if left > max(LEFT, MORE * least):
        apart.append(
            f"{percent(left)} of its torque unexplained by the effects found, {percent(least)} of the recording's"
        )
    if apart:
        message = f"the holdout recording has {' and '.join(apart)}: another axis? It was not used as proof"
        return SameAxis(False, differs, (message,))
    return SameAxis(None if vague or differs else True, differs)


def _beyond(factor: float, found: Difference) -> bool:
    return found.outside(1.0 / factor - 1.0, factor - 1.0, SURE)


def between_recordings(
    recordings: Recordings, whole: Fit, parameters: Mapping[str, Parameter]
) -> tuple[dict[str, Parameter], tuple[Alone, ...], dict[str, Between], list[str]]:
    """The model with all effects, and its parameters, compared to it fitted to each of several recordings alone.

    Returns its parameters, with intervals that count how recordings differ; J, K_w and K_0 of each recording, with the
    effects that were found, () of one; their spread, of what at least two determine; and warnings.
    """
    found = dict(parameters)
    if not recordings.trace.joined:
        return found, (), {}, []
    alone = _each(recordings, whole)
    warnings, spread = list[str](), dict[str, Between]()
    for name in filter(found.__contains__, recordings.base_units):
        own = [one.parameters[name] for one in alone if name in one.parameters]
        if len(own) < 2:
            continue
        differ = excess([own])
        found[name] = widened(found[name], differ, own)
        spread[name] = between(own)
        if differ.chance < ALARM / len(recordings.base_units):
            warnings.append(spread_warning(name, own))
    found |= load_inertia(found, recordings.rig)
    return found, alone, spread, warnings


def widened(found: Parameter, differ: Excess, own: Sequence[Parameter]) -> Parameter:
    """A joint value whose interval includes the spread between recordings, as far as averaging does not reduce it.

    `own`: the estimates by each recording alone, which differ so beyond their own errors.
    """
    more = differ.of_joint(own)
    if not more:
        return found
    reach = math.hypot(found.half_width, differ.reach * more)
    return Parameter.around(found.value, found.unit, math.hypot(found.std_error, more), reach)


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
        found_alone = uncertain(fit(rows, whole.hypothesis, whole)).base(recordings.base_units)
        unknown = {kind.parameter(term) for term in left_open(equations, kind)}
        known = {name: one for name, one in found_alone.items() if name not in unknown}
        found.append(Alone(origin, known, str(next(iter(refusals(equations, kind).values()), ""))))
    return tuple(found)
