"""Whether the holdout is a recording of the same axis; where it is not, it proves nothing."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array, rms
from bench.balance.fit import Fit, fit
from bench.balance.quantities import uncertain
from bench.balance.rows import Rows
from bench.statistics import NORMAL95

#: What one axis may differ by from day to day, as factor: inertia by the motor's constant, a few percent between cold
#: and warm magnets; dry and viscous friction by the lubricant's temperature. On the shared cases J of the two
#: recordings of an axis agrees within 0.6 %, K_0 within 15 %; of two axes only one pair in 39 within 2 %.
INERTIA, VISCOUS, COULOMB = 1.03, 3.0, 1.5
#: Standard errors beyond that.
SURE = 3.0
#: Share of the holdout's torque, and multiple of the recording's, that the found model may leave however it is fitted.
LEFT, MORE = 0.2, 3.0


def foreign(fitted: Fit, other: Rows | None) -> list[str]:
    """Warnings that the holdout is of another axis: J, K_w or K_0 differ, or the found model does not fit it.

    The found effects are fitted to both recordings; an event belongs to one of them and is left out.

    Args:
        fitted: what was found in the recording.
        other: the holdout.
    """
    if other is None:
        return []
    lasting = fitted.hypothesis.with_terms(term for term in fitted.terms if not term.effect.occasional)
    here, there = fit(fitted.rows, lasting), fit(other, lasting)
    own, foreigns = _relative_errors(here), _relative_errors(there)
    apart = []
    for k, (name, factor) in enumerate(
        (("inertia", INERTIA), ("viscous friction", VISCOUS), ("Coulomb friction", COULOMB))
    ):
        ratio = float(there.theta[k] / here.theta[k])
        error = float(np.hypot(own[k], foreigns[k] * abs(ratio)))
        if here.theta[k] > 0.0 and not 1.0 / factor - SURE * error < ratio < factor + SURE * error:
            apart.append(f"{ratio:.3g} times the {name} (± {NORMAL95 * error:.2g})")
    left, least = _left(there), _left(here)
    if left > max(LEFT, MORE * least):
        apart.append(f"{left:.0%} of its torque unexplained by the effects found, {least:.1%} of the recording's")
    if not apart:
        return []
    return [f"the holdout recording has {' and '.join(apart)}: another axis? It was not used as proof"]


def _relative_errors(fitted: Fit) -> Array:
    """Standard errors of J, K_w and K_0 over their values (3,)."""
    variance = np.diag(uncertain(fitted).covariance)[:3]
    return np.sqrt(np.maximum(variance, 0.0)) / np.maximum(np.abs(fitted.theta[:3]), 1e-300)


def _left(fitted: Fit) -> float:
    return fitted.rms / rms(fitted.effort)
