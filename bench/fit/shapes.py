"""The shape of one effect - a Stribeck speed, a lag, a pitch - searched for the least residual, the others held."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array
from bench.effects.effect import Distortion, FiltersMotion, is_pitch
from bench.effects.signals import Scope
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.rows import Rows

#: How far a search of several shapes may wander, in units of how far a grid's shape reaches: along a valley without an
#: end, as of a coupling that damps everything, it went on until numbers overflowed.
FURTHEST = 10.0
#: Of a search of all shapes at once: step of its derivatives, in the same units; saving at which it ends, relative; and
#: steps at most.
JOINT_STEP, JOINT_ENOUGH, JOINT_MOST = 1e-3, 1e-3, 8


def free_shapes(term: Term, scope: Scope) -> list[int]:
    """Places of the shape quantities that vary continuously and are searched so."""
    return [
        k
        for k, shape in enumerate(term.effect.shapes)
        if term.effect.reach(term.shape, k) and (not shape.whole or is_pitch(shape, scope))
    ]


def shaped(rows: Rows, hypothesis: Hypothesis, index: int, over_noise: bool = False) -> Fit:
    """Search one term's shape for the least residual, the others held; `over_noise`: the least over its noise."""
    from scipy.optimize import fminbound, minimize  # 0.2 s, which only a named effect has to pay

    term, scope = hypothesis.terms[index], rows.scope
    free = free_shapes(term, scope)
    if not free:
        return fit(rows, hypothesis)
    if isinstance(term.effect, Distortion) and hypothesis.coupling is not None:
        rows_tried = rows.held  # what follows behind the coupling is kept while the motion is corrected a little
        fit(rows_tried, hypothesis)
    else:
        rows_tried = rows

    def at(offset: Array) -> Hypothesis:
        return hypothesis.reshaped(index, _moved(term, free, offset, scope))

    def misfit(offset: Array) -> float:
        tried = fit(rows_tried, at(offset))
        return float(np.log(max(tried.squares / tried.noise.white**2 if over_noise else tried.squares, 1e-300)))

    if len(free) == 1:
        best = np.atleast_1d(fminbound(lambda x: misfit(np.array([x])), -1.0, 1.0, xtol=4e-3))
        return fit(rows, at(np.asarray(best, dtype=np.float64)))
    simplex = np.vstack([np.zeros(len(free)), 0.5 * np.eye(len(free))])
    best = minimize(
        misfit,
        np.zeros(len(free)),
        method="Nelder-Mead",
        bounds=[(-FURTHEST, FURTHEST)] * len(free),
        options={"initial_simplex": simplex, "xatol": 3e-3, "fatol": 1e-4, "maxfev": 120},
    )
    return fit(rows, at(np.asarray(best.x)))


def together(fitted: Fit) -> Fit:
    """Search the shapes of all terms at once for the least residual: in a valley between two, one alone stands still.

    Gauss and Newton's steps over the shapes, strengths solved for at each (G. H. Golub, V. Pereyra, SIAM Journal on
    Numerical Analysis 10, 1973, 413-432). Shapes without a derivative, as of an instant between two rows, are held.
    """
    from scipy.optimize import least_squares  # 0.2 s, which only several named effects have to pay

    scope, terms = fitted.scope, fitted.terms
    free = [[k for k in free_shapes(term, scope) if term.effect.shapes[k].step] for term in terms]
    ends = np.cumsum([len(places) for places in free])
    if not any(free):
        return fitted

    def at(offset: Array) -> Fit:
        moved = fitted.hypothesis
        for index, (term, places, own) in enumerate(zip(terms, free, np.split(offset, ends[:-1]), strict=True)):
            moved = moved.reshaped(index, _moved(term, places, own, scope))
        return fit(fitted.rows, moved)

    best = least_squares(
        lambda offset: at(offset).residual / fitted.floor,
        np.zeros(int(ends[-1])),
        diff_step=JOINT_STEP,
        x_scale=1.0,
        ftol=JOINT_ENOUGH,
        max_nfev=JOINT_MOST,
    )
    found = at(best.x)
    return found if found.squares < fitted.squares else fitted


def unbiased(fitted: Fit) -> Fit:
    """The shapes through which the noise of the motion passes searched again, for the least residual over that noise.

    Squares alone choose the shape that damps noise, not the one that the axis has: three to five times the damping of
    couplings above the filter's band, at 75 to 102 Hz. Over noise the estimate is consistent (errors in the variables),
    but it scatters, and goes astray where the noise is not as white as it is taken for.
    """
    for index, term in enumerate(fitted.terms):
        if isinstance(term.effect, FiltersMotion):
            fitted = shaped(fitted.rows, fitted.hypothesis, index, over_noise=True)
    return fitted


def _moved(term: Term, free: list[int], offset: Array, scope: Scope) -> tuple[float, ...]:
    """The shape an offset away, in units of how far a search goes."""
    shape = list(term.shape)
    for k, step in zip(free, offset.tolist(), strict=True):
        slot = term.effect.shapes[k]
        if is_pitch(slot, scope):
            shape[k] += step * scope.spacing
        elif slot.additive:
            shape[k] += step * term.effect.reach(term.shape, k)
        else:
            shape[k] *= float(np.exp(step * term.effect.reach(term.shape, k)))
    return tuple(shape)
