"""Whether the holdout is a recording of the same axis; if not, it cannot validate the model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from bench.arrays import NORMAL95, rms
from bench.comparison.difference import Difference
from bench.effects.effect import Occasional
from bench.fit.fit import Fit, fit
from bench.fit.parameter import Parameter
from bench.fit.quantities import uncertain
from bench.fit.rows import Rows

#: Factors by which J, K_w and K_0 of one axis may differ between recordings without a warning.
REPORTED = (1.01, 1.3, 1.1)
#: Factors beyond which it is another axis. From day to day inertia varies with the torque constant, by a few percent
#: between cold and warm magnets, dry and viscous friction with the temperature of the lubricant. On the shared cases J
#: of two recordings of an axis agrees within 0.6 %, K_0 within 15 %; of two axes only one pair in 39 within 2 %.
FOREIGN = (1.03, 3.0, 1.5)
#: Standard errors in addition to these factors.
SURE = 3.0
#: Largest residual of the model refitted to the holdout: as share of its torque, and as multiple of the recording's.
LEFT, MORE = 0.2, 3.0
#: Standard error of the ratio of inertias above which the comparison is inconclusive.
VAGUE = 0.1


@dataclass(frozen=True)
class Disagreement:
    """A quantity that differs between recording and holdout by more than errors and daily variation.

    Attributes:
        quantity: its name.
        recording, holdout: its estimate from each, with the effects that were found.
    """

    quantity: str
    recording: Parameter
    holdout: Parameter


@dataclass(frozen=True)
class SameAxis:
    """Whether the holdout is of the same axis.

    Attributes:
        same: None if unknown: without a holdout, with an inconclusive one, or if only friction differs, which other
            conditions may explain.
        differs: quantities that differ.
        warnings: about another axis.
    """

    same: bool | None
    differs: tuple[Disagreement, ...] = ()
    warnings: tuple[str, ...] = ()


def same_axis(fitted: Fit, other: Rows | None, units: Mapping[str, str]) -> SameAxis:
    """Compare J, K_w and K_0 of recording and holdout, and test whether the model fits both.

    Its effects are fitted to both recordings; events belong to one of them and are left out.

    Args:
        fitted: the model of the recording.
        other: the holdout.
        units: of J, K_w and K_0 by their names.
    """
    if other is None:
        return SameAxis(None)
    lasting = fitted.hypothesis.with_terms(term for term in fitted.terms if not isinstance(term.effect, Occasional))
    here, there = fit(fitted.rows, lasting), fit(other, lasting)
    own, others = uncertain(here).base(units), uncertain(there).base(units)
    differs, apart, vague = [], [], True
    for k, (name, label) in enumerate(zip(units, ("inertia", "viscous friction", "Coulomb friction"), strict=True)):
        if not own[name].value > 0.0:
            continue
        found = Difference.relative(own[name], others[name])
        vague = vague and not (k == 0 and found.std_error < VAGUE)
        if _beyond(REPORTED[k], found):
            differs.append(Disagreement(name, own[name], others[name]))
        if _beyond(FOREIGN[k], found):
            apart.append(f"{1.0 + found.value:.3g} times the {label} (± {NORMAL95 * found.std_error:.2g})")
    left, least = _left(there), _left(here)
    if left > max(LEFT, MORE * least):
        apart.append(f"{left:.0%} of its torque unexplained by the effects found, {least:.1%} of the recording's")
    if apart:
        message = f"the holdout recording has {' and '.join(apart)}: another axis? It was not used as proof"
        return SameAxis(False, tuple(differs), (message,))
    return SameAxis(None if vague or differs else True, tuple(differs))


def _beyond(factor: float, found: Difference) -> bool:
    return found.outside(1.0 / factor - 1.0, factor - 1.0, SURE)


def _left(fitted: Fit) -> float:
    return fitted.rms / rms(fitted.effort)
