"""Whether the holdout is a recording of the same axis; where it is not, it proves nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.arrays import rms
from bench.balance.fit import Fit, fit
from bench.balance.parameter import Parameter
from bench.balance.quantities import uncertain
from bench.balance.rows import Rows
from bench.statistics import NORMAL95

#: What J, K_w and K_0 of one axis may differ by from recording to recording, as factor, before that is told.
REPORTED = (1.01, 1.3, 1.1)
#: The same from day to day, before it is another axis: inertia by the motor's constant, a few percent between cold and
#: warm magnets; dry and viscous friction by the lubricant's temperature. On the shared cases J of the two recordings of
#: an axis agrees within 0.6 %, K_0 within 15 %; of two axes only one pair in 39 within 2 %.
FOREIGN = (1.03, 3.0, 1.5)
#: Standard errors beyond that.
SURE = 3.0
#: Share of the holdout's torque, and multiple of the recording's, that the found model may leave however it is fitted.
LEFT, MORE = 0.2, 3.0
#: Standard error of the ratio of inertias above which nothing can be said.
VAGUE = 0.1


@dataclass(frozen=True)
class Difference:
    """A quantity that differs between recording and holdout by more than errors and days make.

    Attributes:
        quantity: by the name of the contract.
        recording, holdout: what each tells of it, with the effects that were found.
    """

    quantity: str
    recording: Parameter
    holdout: Parameter


@dataclass(frozen=True)
class SameAxis:
    """What the holdout says of whose recording it is.

    Attributes:
        same: None where nobody can tell: without a holdout, with a vague one, or where friction is another but may be
            the axis' own in other conditions.
        differs: in which quantities.
        warnings: that it is of another axis.
    """

    same: bool | None
    differs: tuple[Difference, ...] = ()
    warnings: tuple[str, ...] = ()


def same_axis(fitted: Fit, other: Rows | None, units: Mapping[str, str]) -> SameAxis:
    """Hold J, K_w and K_0 of recording and holdout against each other, and whether the found model fits both.

    The found effects are fitted to both recordings; an event belongs to one of them and is left out.

    Args:
        fitted: what was found in the recording.
        other: the holdout.
        units: of J, K_w and K_0 by their names.
    """
    if other is None:
        return SameAxis(None)
    lasting = fitted.hypothesis.with_terms(term for term in fitted.terms if not term.effect.occasional)
    here, there = fit(fitted.rows, lasting), fit(other, lasting)
    own, others = uncertain(here).base(units), uncertain(there).base(units)
    differs, apart, vague = [], [], True
    for k, (name, label) in enumerate(zip(units, ("inertia", "viscous friction", "Coulomb friction"), strict=True)):
        if not own[name].value > 0.0:
            continue
        ratio = others[name].value / own[name].value
        error = float(np.hypot(own[name].std_error * ratio, others[name].std_error)) / own[name].value
        vague = vague and not (k == 0 and error < VAGUE)
        if not _within(REPORTED[k], ratio, error):
            differs.append(Difference(name, own[name], others[name]))
        if not _within(FOREIGN[k], ratio, error):
            apart.append(f"{ratio:.3g} times the {label} (± {NORMAL95 * error:.2g})")
    left, least = _left(there), _left(here)
    if left > max(LEFT, MORE * least):
        apart.append(f"{left:.0%} of its torque unexplained by the effects found, {least:.1%} of the recording's")
    if apart:
        message = f"the holdout recording has {' and '.join(apart)}: another axis? It was not used as proof"
        return SameAxis(False, tuple(differs), (message,))
    return SameAxis(None if vague or differs else True, tuple(differs))


def _within(factor: float, ratio: float, error: float) -> bool:
    return 1.0 / factor - SURE * error < ratio < factor + SURE * error


def _left(fitted: Fit) -> float:
    return fitted.rms / rms(fitted.effort)
