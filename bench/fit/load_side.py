"""On which side of a soft coupling an outer load acts: drag, a spring, an unbalance, an event.

On the motor it stands in the balance as it is; on the load it shakes the coupling first. Its strength then also drives
the load's motion, so a fit brings the two in line.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.effect import Load, OuterTorque
from bench.fit.hypothesis import Hypothesis, Term


def outer_loads(hypothesis: Hypothesis) -> list[int]:
    """Indices of the terms that may act on the load of a coupling; none without one."""
    if hypothesis.coupling is None:
        return []
    return [index for index, term in enumerate(hypothesis.terms) if isinstance(term.effect, OuterTorque)]


def on_other_side(hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis with its outer loads on the load instead of on the motor, or the other way round."""
    outer = outer_loads(hypothesis)
    onto = None if any(hypothesis.terms[index].load is not None for index in outer) else ()
    return hypothesis.with_terms(
        replace(term, load=onto) if index in outer else term for index, term in enumerate(hypothesis.terms)
    )


def loads_of(hypothesis: Hypothesis) -> tuple[Load, ...]:
    """What acts on the load, as far as its strengths are known."""
    outer = [(term.effect, term.shape, term.load) for term in hypothesis.terms if term.load]
    return tuple((effect, shape, load) for effect, shape, load in outer if isinstance(effect, OuterTorque))


def with_loads(hypothesis: Hypothesis, theta: Array, owners: NDArray[np.object_]) -> Hypothesis:
    """The hypothesis with the strengths over load inertia that a fit found of what acts on the load."""
    index = hypothesis.coupling
    inertia = 0.0 if index is None else float(theta[owners == index][0])

    def moved(k: int, term: Term) -> Term:
        if term.load is None:
            return term
        return replace(term, load=tuple((theta[owners == k] / inertia).tolist()) if inertia > 0.0 else ())

    return hypothesis.with_terms(moved(k, term) for k, term in enumerate(hypothesis.terms))
