"""Whether the holdout is a recording of the same axis; where it is not, it proves nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.candidates import EVENT
from bench.diagnose.fit import Fit, fit
from bench.diagnose.quantities import uncertain
from bench.diagnose.workbench import Workbench
from bench.errors import InputError
from bench.trace.trace import Trace

Array = NDArray[np.float64]

#: What one axis may differ by from day to day, as factor: inertia by the motor's constant, a few percent between cold
#: and warm magnets; dry and viscous friction by the lubricant's temperature. On the shared cases J of the two
#: recordings of an axis agrees within 0.6 %, K_0 within 15 %; of two axes only one pair in 39 within 2 %.
INERTIA, VISCOUS, COULOMB = 1.03, 3.0, 1.5
#: Standard errors beyond that.
SURE = 3.0
#: Share of the holdout's torque, and multiple of the recording's, that the found model may leave however it is fitted.
LEFT, MORE = 0.2, 3.0


def require_another(trace: Trace, holdout: Trace) -> None:
    """InputError where the holdout is the recording itself."""
    if len(trace) == len(holdout) and all(
        name in holdout and np.array_equal(values, holdout[name]) for name, values in trace.signals.items()
    ):
        raise InputError("--holdout", f"found the recording itself ({holdout.origin})", "allowed: another recording")


def foreign(bench: Workbench, fitted: Fit, other: Workbench | None) -> list[str]:
    """Warnings that the holdout is of another axis: J, K_w or K_0 differ, or the found model does not fit it.

    The found effects are fitted to both recordings; an event belongs to one of them and is left out.

    Args:
        bench: the recording.
        fitted: what was found in it.
        other: the holdout.
    """
    if other is None:
        return []
    effects = tuple(effect for effect in fitted.hypothesis.effects if effect.name != EVENT)
    hypothesis = replace(fitted.hypothesis, effects=effects)
    here, there = fit(bench, hypothesis), fit(other, hypothesis)
    own, foreigns = _relative_errors(bench, here), _relative_errors(other, there)
    told = []
    for k, (name, factor) in enumerate(
        (("inertia", INERTIA), ("viscous friction", VISCOUS), ("Coulomb friction", COULOMB))
    ):
        ratio = float(there.theta[k] / here.theta[k])
        error = float(np.hypot(own[k], foreigns[k] * abs(ratio)))
        if here.theta[k] > 0.0 and not 1.0 / factor - SURE * error < ratio < factor + SURE * error:
            told.append(f"{ratio:.3g} times the {name} (± {1.96 * error:.2g})")
    left, least = _left(other, there), _left(bench, here)
    if left > max(LEFT, MORE * least):
        told.append(f"{left:.0%} of its torque unexplained by the effects found, {least:.1%} of the recording's")
    if not told:
        return []
    return [f"the holdout recording has {' and '.join(told)}: another axis? It was not used as proof"]


def _relative_errors(bench: Workbench, fitted: Fit) -> Array:
    """Standard errors of J, K_w and K_0 over their values (3,)."""
    variance = np.diag(uncertain(bench, fitted).covariance)[:3]
    return np.sqrt(np.maximum(variance, 0.0)) / np.maximum(np.abs(fitted.theta[:3]), 1e-300)


def _left(bench: Workbench, fitted: Fit) -> float:
    return fitted.rms / float(np.sqrt(np.mean(bench.effort**2)))
