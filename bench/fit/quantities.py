"""Quantities of a fit with their intervals, which count correlated residuals and what no residual shows.

Every free number of the fit, strengths and continuous shapes alike, is one column of the Jacobian of the modelled
torque; covariance by long-run scores; quantities by the delta method.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bench.arrays import NORMAL95, Array, rms
from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.effects.effect import Contact, Effect
from bench.effects.signals import Axis, Signals
from bench.fit.fit import Fit, least_squares
from bench.fit.hypothesis import Layout, depended_on, lay_out
from bench.fit.rows import Rows
from bench.fit.solution import NOISE_ALONE, block_edges, estimated, misfit, solved
from bench.parameter import Parameter

#: Step of a numerical derivative, relative.
STEP = 1e-4
#: Residual in noise floors beyond which a row counts less and less, where some rows are not determined.
SCALE = 3.0
#: Logarithm of the largest factor within which something is known.
FURTHEST = 10.0


@dataclass(frozen=True)
class Uncertain:
    """The free numbers of a fit - strengths, then continuous shapes - and their covariance.

    Attributes:
        fitted: the fit.
        values: (p + s,).
        covariance: (p + s, p + s).
        reach: of an interval of 95 % in standard errors.
        slots: (term, place in its shape) of each free shape.
    """

    fitted: Fit
    values: Array
    covariance: Array
    reach: float
    slots: tuple[tuple[int, int], ...]

    def parameter(self, value: float, deviation: float, unit: str, positive: bool = False) -> Parameter:
        """A value with its interval, which is one of its logarithm if there is none of it that is 0."""
        reach, value = self.reach * deviation, float(value)
        between = (value - reach, value + reach)
        if positive and value > 0.0:
            factor = float(np.exp(min(reach / value, FURTHEST)))
            between = (value / factor, value * factor)
        return Parameter(value, unit, deviation, between)

    def base(self, units: Mapping[str, str]) -> dict[str, Parameter]:
        """J, K_w and K_0 with their intervals; `units` by their names, in this order."""
        deviation = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))[: self.fitted.theta.size]
        return {
            name: self.parameter(self.fitted.value(term), float(deviation[self.fitted.owners == term][0]), unit)
            for term, (name, unit) in zip((INERTIA, VISCOUS, COULOMB), units.items(), strict=True)
        }

    def quantities(self, index: int, unit_of: Callable[[Effect, str], str]) -> dict[str, Parameter]:
        """Quantities of one term with their intervals; `unit_of` gives the unit of an effect's quantity by its name."""
        term, size, owners = self.fitted.terms[index], self.fitted.theta.size, self.fitted.owners

        def values(point: Array) -> Mapping[str, float]:
            shape = list(term.shape)
            for slot, (owner, k) in enumerate(self.slots):
                if owner == index:
                    shape[k] = float(point[size + slot])
            j, k_w, k_0 = (float(point[:size][owners == name][0]) for name in (INERTIA, VISCOUS, COULOMB))
            axis = Axis(j, k_w, k_0)
            return term.effect.report(point[:size][owners == index].tolist(), tuple(shape), axis)

        steps, found = STEP * np.maximum(np.abs(self.values), 1e-9), {}
        sides = [(values(self.values + step), values(self.values - step)) for step in np.diag(steps)]
        for name, value in values(self.values).items():
            slopes = np.array([high[name] - low[name] for high, low in sides]) / (2.0 * steps)
            deviation = float(np.sqrt(max(slopes @ self.covariance @ slopes, 0.0)))
            found[name] = self.parameter(value, deviation, unit_of(term.effect, name), name in term.effect.positive)
        return found


def uncertain(fitted: Fit) -> Uncertain:
    """Free numbers of a fit with their covariance; where not all rows are determined, as in a robust search."""
    place = fitted.theta.size
    slots = tuple((index, k) for index, term in enumerate(fitted.terms) for k in term.fitted(fitted.scope))
    known = _known(fitted, slots)
    jacobian = _jacobian(fitted.rows, fitted, slots)
    covariance, reach = _by_residual(fitted, slots, known, jacobian)
    covariance[place:, place:] += np.diag(known**2)
    for index, term in enumerate(fitted.terms):
        own = [place + slot for slot, (owner, _) in enumerate(slots) if owner == index]
        if own and isinstance(term.effect, Contact):
            spread, made_of = term.effect.spread, (term.effect.spread, fitted.hypothesis)
            covariance[np.ix_(own, own)] += fitted.rows.memory.get(made_of, partial(spread, fitted, term.shape))
    for moved in (*_misplaced(fitted), *_louder(fitted, slots), *_at_bounds(fitted, jacobian)):
        covariance[: moved.size, : moved.size] += np.outer(moved, moved)
    shapes = np.array([fitted.terms[index].shape[k] for index, k in slots])
    return Uncertain(fitted, np.concatenate([fitted.theta, shapes]), covariance, reach, slots)


def strengths_are_sure(fitted: Fit) -> NDArray[np.bool_]:
    """Whether each strength surely differs from 0 at the shapes and levels of friction that were found (p,).

    An effect that is absent has no shape, so that of its shape is no error of its presence: friction that decays over
    as long as the recording lasts is there, though not how far.
    """
    covariance, reach = _by_residual(fitted, (), np.empty(0), fitted.columns)
    return np.abs(fitted.theta) > reach * np.sqrt(np.maximum(np.diag(covariance), 0.0))


def _by_residual(fitted: Fit, slots: tuple[tuple[int, int], ...], known: Array, jacobian: Array) -> tuple[Array, float]:
    """Covariance (p + s, p + s) from the residual, what exceeds noise included, and the reach of intervals."""
    conditioning = fitted.rows.conditioning
    acting = fitted.layout.acting(fitted.theta)
    left, floor = acting * fitted.left, acting * fitted.floor
    weight = np.ones(left.size)
    if not fitted.determined.all():  # a row with a residual above noise counts less and less
        weight = 1.0 / (1.0 + (left / (SCALE * floor)) ** 2)
    noise = np.pad(fitted.layout.noise, (0, len(slots)))
    numbers = np.concatenate([fitted.theta, np.zeros(len(slots))])
    edges = block_edges(fitted.time, conditioning.filter.width)
    count = np.diff(edges)
    scores = np.add.reduceat(jacobian * (weight * left)[:, None], edges[:-1])
    scores += np.outer(count, noise @ numbers + fitted.layout.known * noise[:, 0])
    shown = np.linalg.norm(jacobian, axis=0) >= np.pad(_least(fitted, slots, known), (fitted.theta.size, 0))
    shown[_between(fitted)] = False  # see `_at_bounds`
    both = np.ix_(shown, shown)
    inverse = np.zeros(noise.shape)
    inverse[both] = solved(((jacobian.T * weight) @ jacobian)[both], numbers[shown], count.sum() * noise[both])[1]
    covariance, reach = estimated(scores, inverse, conditioning.effort_noise**2 / conditioning.filter.stride)
    heavy = np.sqrt(weight)
    # with a name from the floor on: what is too weak for one has 1.05 to 1.2 and bends the values
    least = floor / NOISE_ALONE if fitted.terms else floor
    reaches = misfit(jacobian[:, shown] * heavy[:, None], left * heavy, least)
    covariance[both] += np.diag((reaches / reach) ** 2)
    return covariance, reach


def _least(fitted: Fit, slots: tuple[tuple[int, int], ...], known: Array) -> Array:
    """Norm of a shape's derivative (s,) below which noise hides it: of an instant that is known by itself; else 0.

    None shows one between rows that are not determined: it moves the impacts behind it, which are not there.
    """
    instants = np.array([fitted.terms[index].effect.shapes[k].quantity.instant for index, k in slots], dtype=bool)
    least = np.divide(fitted.floor, known, out=np.zeros(known.size), where=instants & (known > 0.0))
    after = np.clip(np.searchsorted(fitted.time, [fitted.terms[i].shape[k] for i, k in slots]), 1, fitted.time.size - 1)
    return np.where(instants & ~(fitted.determined[after] & fitted.determined[after - 1]), np.inf, least)


def _known(fitted: Fit, slots: tuple[tuple[int, int], ...]) -> Array:
    """Standard errors of the shapes (s,) that no noise shows, as of an instant between two rows that are determined.

    An instant that within its own changes the torque by less than noise does is known by it alone, as no row moves with
    it. What it is of another shape, the tick of a lag or the drift of a position, is added to its noise.
    """
    sure = fitted.time[fitted.determined]
    errors = [term.effect.shape_errors(term.shape, fitted.scope, sure) for term in fitted.terms]
    return np.array([errors[index][k] for index, k in slots])


def _jacobian(rows: Rows, fitted: Fit, slots: tuple[tuple[int, int], ...]) -> Array:
    """Derivative of the modelled torque by strengths and shapes (m, p + s), what columns take from a fit held."""
    here = lay_out(rows, fitted.hypothesis, fitted.found, fitted.missing) if slots else fitted.layout
    columns = [fitted.columns + _by_others(rows, fitted, here)]
    for index, k in slots:
        term = fitted.terms[index]
        step = term.effect.shapes[k].step * max(abs(term.shape[k]), 1e-3)
        moved = tuple(value + step * (j == k) for j, value in enumerate(term.shape))
        other = lay_out(rows, fitted.hypothesis.reshaped(index, moved), fitted.found, fitted.missing)
        modelled = (other.columns - here.columns) @ fitted.theta - (other.effort - here.effort)
        columns.append(modelled[:, None] / step)
    return np.concatenate(columns, axis=1)


def _by_others(rows: Rows, fitted: Fit, here: Layout) -> Array:
    """What a strength changes in the columns of others, where dry frictions multiply or one follows a load (m, p)."""
    columns, depends = np.zeros_like(here.columns), depended_on(fitted.hypothesis, fitted.found)
    for k in range(fitted.theta.size if depends else 0):
        moved = fitted.theta.copy()
        moved[k] += (step := STEP * rms(here.effort) / max(rms(here.columns[:, k]), 1e-300))
        found = here.by_name(moved)
        if depended_on(fitted.hypothesis, found) != depends:
            other = lay_out(rows, fitted.hypothesis, found, fitted.missing)
            columns[:, k] = (other.columns - here.columns) @ fitted.theta / step
    return columns


def _misplaced(fitted: Fit) -> Iterator[Array]:
    """Standard changes of the strengths (p,) were what effects see half a tick older, or a drift further on.

    A drive latches its signals within one tick: the alignment of torque is fitted, that of a wave of position is not.
    """
    if not fitted.terms or not fitted.determined.all():
        return
    here = lay_out(fitted.rows, fitted.hypothesis, fitted.found, fitted.missing)
    plain, scope = least_squares(here.columns, here.effort, here.noise), fitted.scope

    def refitted(change: Callable[[Signals], Signals]) -> Array:
        layout = lay_out(fitted.rows.with_signals(change), fitted.hypothesis, fitted.found, fitted.missing)
        columns = np.where([isinstance(owner, int) for owner in layout.owners], layout.columns, here.columns)
        return least_squares(columns, here.effort, layout.noise) - plain

    def older(s: Signals) -> Signals:
        position, velocity = (
            values + 0.5 * scope.latched * np.gradient(values, s.sample_period) for values in (s.position, s.velocity)
        )
        return replace(s, position=position, velocity=velocity)

    yield refitted(older) / NORMAL95
    if scope.drift:
        yield refitted(lambda s: replace(s, position=s.position + scope.drift))


def _at_bounds(fitted: Fit, jacobian: Array) -> Iterator[Array]:
    """Standard changes of strengths and shapes (p + s,) were a strength that is at a bound anywhere between its bounds.

    The residual does not show where, as it is least outside of them: it is evenly distributed between them, with a
    deviation of their distance over sqrt(12).
    """
    free = np.delete(np.arange(jacobian.shape[1]), _between(fitted))
    noise = np.pad(fitted.layout.noise, (0, jacobian.shape[1] - fitted.theta.size))[np.ix_(free, free)]
    for place in _between(fitted):
        moved, (low, high) = np.zeros(jacobian.shape[1]), fitted.layout.bounds[place]
        moved[place] = 1.0
        moved[free] = -least_squares(jacobian[:, free], jacobian[:, place], noise)
        yield moved * (high - low) / np.sqrt(12.0)


def _between(fitted: Fit) -> list[int]:
    """Places of strengths at one of two bounds; one that is bounded to one side only is as uncertain as a free one."""
    return [place for place in fitted.held if np.isfinite(np.subtract(*fitted.layout.bounds[place]))]


def _louder(fitted: Fit, slots: tuple[tuple[int, int], ...]) -> Iterator[Array]:
    """Change of strengths and shapes were noise twice as strong, by one step of Gauss and Newton.

    The column of a coupling is made from noisy motion, so noise biases it; that of the noise itself is as large.
    J. R. Cook, L. A. Stefanski, Journal of the American Statistical Association 89, 1994, 1314-1328.
    """
    if not any(term.effect.filters_motion for term in fitted.terms) or not fitted.determined.all():
        return
    rng, conditioning = np.random.default_rng(0), fitted.rows.conditioning

    def louder(s: Signals) -> Signals:
        noise = conditioning.source_noise * rng.standard_normal(s.time.size)
        effort = s.effort + conditioning.effort_noise * rng.standard_normal(s.time.size)
        s = replace(s, effort=effort, torque=effort)
        if conditioning.source == "velocity":
            return replace(s, velocity=s.velocity + noise)
        return replace(s, position=s.position + noise, velocity=s.velocity + np.gradient(noise, s.sample_period))

    loud = fitted.rows.with_signals(louder)
    layout = lay_out(loud, fitted.hypothesis, fitted.found, fitted.missing)
    jacobian = _jacobian(loud, replace(fitted, rows=loud, layout=layout), slots)
    left, moved = layout.effort - layout.columns @ fitted.theta, np.zeros(jacobian.shape[1])
    free = np.delete(np.arange(moved.size), _between(fitted))
    moved[free] = least_squares(jacobian[:, free], left, np.zeros((free.size, free.size)))
    yield moved
