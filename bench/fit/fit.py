"""A hypothesis fitted to a recording by least squares, held against what noise alone would leave.

The shape of an effect - a Stribeck speed, a lag, a pitch - is searched for the least residual, the others held.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms, symmetric_inverse
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS
from bench.effects.catalogue import catalogue
from bench.effects.effect import Bristles, Columns, ColumnsOf, Contact, Coupling, Distortion, Effect, Proposal, TablesOf
from bench.effects.shape import Shapes
from bench.effects.signals import Axis, Scope, Signals
from bench.effects.torque import Friction
from bench.fit.dependence import Dependence, dependence
from bench.fit.hypothesis import (
    BASE,
    NOTHING,
    Found,
    Hypothesis,
    Layout,
    Name,
    Term,
    delays,
    depended_on,
    in_line,
    lay_out,
    not_reaching,
    rows_of_next,
    seen_by,
)
from bench.fit.rows import Rows
from bench.fit.solution import NOISE_ALONE, Floor, bounded, solved
from bench.names import percent, words
from bench.trace.filter import Column

#: Rounds in which levels of dry friction that multiply, and torque that is copied, are brought in line.
ROUNDS = 4
#: Change of what copies of torque miss, as share of it, at which they are in line with what is found.
IN_LINE = 0.01
#: Share of the noise floor by which a row's torque may depend on what is not determined, an impact's instant.
OPEN_SHARE = 0.3
#: Standard errors from which a strength is no longer chance: 3 of 1000 by a normal distribution.
SURE = 3.0
#: Share of the residual from which on an effect is suggested.
SUGGESTED = 0.25
#: How far a search of shapes may go, in units of a grid's reach: valleys without an end lead to numbers that overflow.
FURTHEST = 10.0
#: Of a search of shapes, in the same units: points to each side from which it may start, step of its derivatives and
#: least step; saving at which it ends, relative; steps at most.
ASIDE, SHAPE_STEP, SHAPE_NEAR, SHAPE_ENOUGH, MOST = 0.5, 1e-3, 1e-4, 1e-5, 20
#: Numbers of all shapes tried at once, which bounds memory: 8 bytes each, some four times over.
TOGETHER = 8_000_000


@dataclass(frozen=True)
class Fit:
    """A hypothesis fitted to a recording by least squares.

    Attributes:
        rows: the recording.
        hypothesis, layout: what was fitted, and its columns.
        theta: (p,): J, K_w, K_0, misalignment, last digit, sines and cosines of the mains, then the effects' strengths.
        held: places of strengths that are at a bound.
        determined: (m,) rows whose torque the recording determines: not those that depend on the instant of an impact.
    """

    rows: Rows
    hypothesis: Hypothesis
    layout: Layout
    theta: Array
    held: tuple[int, ...]
    determined: NDArray[np.bool_]

    @property
    def residual(self) -> Array:
        """Measured less modelled torque (m,), 0 at rows that are not determined - N*m (N)."""
        return self.left * self.determined

    @cached_property
    def left(self) -> Array:
        """Measured less modelled torque at all rows (m,) - N*m (N)."""
        return self.layout.left(self.theta)

    @cached_property
    def found(self) -> dict[Name, list[float]]:
        """Coefficients by the names of their columns."""
        return self.layout.by_name(self.theta)

    def found_for(self, hypothesis: Hypothesis) -> Found:
        """Coefficients of the axis, and of those effects of a hypothesis that are here too, by their places in it."""
        own = {each: self.found[index] for index, each in enumerate(_counted(self.terms)) if index in self.found}
        base: dict[Name, list[float]] = {name: self.found[name] for name in BASE}
        return base | {index: own[each] for index, each in enumerate(_counted(hypothesis.terms)) if each in own}

    @cached_property
    def missing(self) -> dict[int, Array]:
        """The part of the reported torque that its copying terms do not use."""
        return not_reaching(self.hypothesis, self.layout, self.theta)

    @cached_property
    def squares(self) -> float:
        """Sum of squared residuals - (N*m)**2 (N**2)."""
        residual = self.residual
        return float(residual @ residual)

    @cached_property
    def noise(self) -> Floor:
        """The residual of noise under this model."""
        return Floor(self.rows, self.hypothesis, self.layout, self.theta, self.left)

    @property
    def floor(self) -> float:
        """RMS residual of sensor noise, its colour included - N*m (N)."""
        return self.noise.coloured

    @property
    def chance(self) -> float:
        """Squares that a number more hardly saves by chance, SURE standard errors of it - (N*m)**2 (N**2)."""
        return SURE**2 * self.rows.correlation * self.floor**2

    @property
    def count(self) -> int:
        """Rows that are determined."""
        return int(np.count_nonzero(self.determined))

    @property
    def rms(self) -> float:
        """RMS residual - N*m (N)."""
        return float(np.sqrt(self.squares / self.count))

    @property
    def chi(self) -> float:
        """RMS residual over noise floor: 1 where the model explains all but noise."""
        return self.rms / self.floor

    @cached_property
    def depends(self) -> Dependence | None:
        """On what a residual depends whose RMS is that of noise; None where it is noise, or more than noise."""
        if self.chi > NOISE_ALONE or not self.determined.all():
            return None
        return dependence(self.rows, self.layout, self.theta)

    @property
    def excess(self) -> float:
        """Squares above the noise floor, summed over rows - (N*m)**2, not negative."""
        return max(self.squares - self.count * self.floor**2, 0.0)

    @property
    def base(self) -> Axis:
        """J, K_w and K_0."""
        return Axis(self.value(INERTIA), self.value(VISCOUS), self.value(COULOMB))

    def value(self, term: str) -> float:
        """Coefficient of a term of the equation of motion - SI."""
        return float(self.theta[self.owners == term][0])

    @property
    def shift(self) -> float:
        """By how much the torque is reported late - s."""
        return self.hypothesis.shift + self.value(MISALIGNMENT)

    @property
    def span(self) -> Array:
        """Orthonormal basis of the columns that were free (m, p), 0 at rows that are not determined."""
        return self._basis

    @cached_property
    def _basis(self) -> Array:
        free = np.delete(self.columns, self.held, 1) if self.held else self.columns
        return np.linalg.qr(free if self.determined.all() else free * self.determined[:, None])[0]

    def strengths(self, index: int) -> list[float]:
        """Strengths of one term."""
        return self.theta[self.owners == index].tolist()

    # What effects ask of it, see `bench.effects.effect.Fitted`.

    @property
    def scope(self) -> Scope:
        """What the recording is able to show."""
        return self.rows.scope

    @property
    def terms(self) -> tuple[Term, ...]:
        """Of the hypothesis."""
        return self.hypothesis.terms

    @property
    def columns(self) -> Array:
        """(m, p)."""
        return self.layout.columns

    @property
    def owners(self) -> NDArray[np.object_]:
        """(p,) name of a column, or index of the term it belongs to."""
        return self.layout.owners

    @property
    def effort(self) -> Array:
        """What the columns are to explain (m,) - N*m (N)."""
        return self.layout.effort

    def places(self, true_of: Callable[[Effect], bool]) -> NDArray[np.intp]:
        """Places among the columns of the strengths of effects of which something is true (k,)."""
        return np.flatnonzero(np.isin(self.owners, self.hypothesis.having(true_of)))

    @property
    def time(self) -> Array:
        """Of the rows (m,) - s."""
        return self.rows.time

    @cached_property
    def next_rows(self) -> Rows:
        """The recording as one more term would read it."""
        return rows_of_next(self.rows, self.hypothesis, self.residual, self.found)

    @property
    def stretches(self) -> list[Signals]:
        """Raw signals as one term more would see them."""
        return [part.signals for part in self.next_rows.stretches]

    def seen(self, columns: ColumnsOf, of_motion: bool) -> Array:
        """Columns (m, k) of raw signals as one term more would see them; `of_motion`: accelerations or speeds."""
        return self.next_rows.table(columns, delays(self.rows, self.hypothesis)[0 if of_motion else 1])

    def behind(self, tables: TablesOf, shapes: Shapes) -> Array:
        """Columns (m, k) of what follows only the motion behind couplings of shapes (k, s), made once."""
        lag = delays(self.rows, self.hypothesis)[0]
        made_of = tables, tuple(map(tuple, shapes)), lag, self.next_rows.motion
        return self.rows.memory.get(made_of, lambda: self.next_rows.table(tables(self.stretches, shapes), lag))

    def gains(self, columns: Array, width: int) -> Array:
        """Squares that groups of columns (m, groups*width) would take beyond what is fitted (groups,)."""
        sure = columns if self.determined.all() else columns * self.determined[:, None]
        return _taken(_own(sure, width), sure.T @ self._targets, self._targets)

    def worth(self, effects: Sequence[Columns]) -> list[float]:
        """Squares that effects without shapes would each take - (N*m)**2 (N**2)."""
        made = [self.next_rows.columns_of(effect, [()]) for effect in effects]
        widths, found = np.array([len(columns) for columns in made]), np.zeros(len(effects))
        for width in set(widths.tolist()):
            alike = np.flatnonzero(widths == width)
            columns = [column for index in alike.tolist() for column in made[index]]
            found[alike] = self.gains(self.seen([columns], False), width)
        return found.tolist()

    def tried(self, effect: Effect, shapes: Sequence[tuple[float, ...]]) -> list[Proposal]:
        """Shapes of an effect with what each would explain: by its columns, or fitted again where it has none."""
        if not isinstance(effect, Columns):
            tried = [fit(self.rows, self.hypothesis.plus(Term(effect, shape)), self) for shape in shapes]
            return [Proposal(shape, self.squares - one.squares) for shape, one in zip(shapes, tried, strict=True)]
        few = max(1, TOGETHER // (8 * self.time.size))
        parts = [shapes[k : k + few] for k in range(0, len(shapes), few)]
        return [proposal for part in parts for proposal in self._by_columns(effect, part)]

    def _by_columns(self, effect: Columns, shapes: Sequence[tuple[float, ...]]) -> list[Proposal]:
        rows, (_, resting, _) = seen_by(self.rows, self.hypothesis), delays(self.rows, self.hypothesis)
        known = effect.columns_of, tuple(shapes)
        if isinstance(effect, Coupling):  # of the motion alone, which most terms leave as it is
            columns = self.behind(effect.tables_of, shapes)
            worth = self.gains(columns, 1) * (self.residual @ columns > 0.0)  # none without a load behind it
        elif isinstance(effect, Friction | Bristles) or effect.copies_torque or not self.determined.all():
            columns = self.seen([self.next_rows.columns_of(effect, shapes)], False)
            worth = self.gains(columns, columns.shape[1] // len(shapes))
        else:  # their products with each other are kept, those with what is fitted need none of them filtered
            tables: list[Array] = []

            def own() -> Array:
                tables.append(rows.table([rows.columns_of(effect, shapes)], resting))
                return _own(tables[0], tables[0].shape[1] // len(shapes))

            grams = rows.memory.get((*known, resting, rows.made_by), own)
            targets = self._targets
            products = tables[0].T @ targets if tables else self._against(self.next_rows.columns_of(effect, shapes))
            worth = _taken(grams, products, targets)
        return [Proposal(shape, float(gain)) for shape, gain in zip(shapes, worth, strict=True)]

    @cached_property
    def _targets(self) -> Array:
        """What columns are held against: the basis of what is fitted, and the residual (m, p + 1)."""
        return np.column_stack([self.span, self.residual])

    @cached_property
    def _against(self) -> Callable[[Sequence[Column]], Array]:
        return self.next_rows.against(self._targets, delays(self.rows, self.hypothesis)[1])


def fit(rows: Rows, hypothesis: Hypothesis, start: Fit | None = None) -> Fit:
    """Least squares of a hypothesis, whose strengths start from a fit of some of its effects.

    Columns that depend on the strengths of other terms, or on what their copies of torque miss, are made again until
    both are in line with what is found.
    """
    before = NOTHING if start is None else start.found_for(hypothesis)
    layout = lay_out(rows, hypothesis, before)
    missing = _without_copies(layout, hypothesis)
    if missing:
        layout = lay_out(rows, hypothesis, before, missing)
    every = np.ones(layout.effort.size, dtype=bool)
    fitted = Fit(rows, hypothesis, layout, *_balanced(layout), every)
    for _ in range(ROUNDS):
        depends = depended_on(hypothesis, fitted.found), depended_on(hypothesis, before)
        if _misses_alike(fitted.missing, missing) and in_line(*depends):
            break
        before, missing = fitted.found, fitted.missing
        layout = lay_out(rows, hypothesis, before, missing)
        fitted = Fit(rows, hypothesis, layout, *_balanced(layout), every)
    determined = _determined(fitted)
    if determined.all():
        return fitted
    return Fit(rows, hypothesis, layout, *_balanced(layout, determined), determined)


def _counted(terms: Sequence[Term]) -> list[tuple[Effect, int]]:
    """Effects of terms, each with how many before it are the same."""
    effects = [term.effect for term in terms]
    return [(effect, effects[:index].count(effect)) for index, effect in enumerate(effects)]


def _misses_alike(now: Mapping[int, Array], before: Mapping[int, Array]) -> bool:
    """Whether what copies of torque miss changed by a small share of it only."""
    least = IN_LINE * min(map(rms, now.values()), default=0.0)
    return all(rms(missing - before[index]) <= least for index, missing in now.items())


def _determined(fitted: Fit) -> NDArray[np.bool_]:
    """Rows whose modelled torque would be the same within what the recording does not determine (m,)."""
    determined = fitted.determined
    for index, term in enumerate(fitted.terms):
        if isinstance(term.effect, Contact):
            torque, lags = term.effect.open_torque, delays(fitted.rows, fitted.hypothesis)
            made_of = (torque, term.shape, lags, fitted.next_rows.motion)
            moved = fitted.rows.memory.get(made_of, partial(torque, fitted, term.shape))
            determined = determined & (moved * abs(fitted.strengths(index)[0]) < OPEN_SHARE * fitted.floor)
    return determined


def _without_copies(layout: Layout, hypothesis: Hypothesis) -> dict[int, Array]:
    """The torque that remains without the effects that copy it, by the place of each (m,) - N*m (N)."""
    copies = hypothesis.having(lambda effect: effect.copies_torque)
    if not copies:
        return {}
    kept = ~np.isin(layout.owners, copies)
    noise = layout.noise[np.ix_(kept, kept)]
    left = layout.effort - layout.columns[:, kept] @ least_squares(layout.columns[:, kept], layout.effort, noise)
    return dict.fromkeys(copies, left)


def _balanced(layout: Layout, determined: NDArray[np.bool_] | slice = slice(None)) -> tuple[Array, tuple[int, ...]]:
    """Least squares (p,) within bounds, and the places of what is held at one.

    Torque and speed differ in time by no more than the time of latching: a larger shift is a lag, which is an effect.
    """
    columns, effort = layout.columns[determined], layout.effort[determined]
    noise = columns.shape[0] * layout.noise
    return bounded(columns.T @ columns, columns.T @ effort + layout.known * noise[:, 0], noise, layout.bounds)


def least_squares(columns: Array, effort: Array, noise: Array) -> Array:
    """Strengths (p,) of columns (m, p) that hold noise of a covariance (p, p) in each row."""
    return solved(columns.T @ columns, columns.T @ effort, columns.shape[0] * noise)[0]


def explained(before: Fit, after: Fit) -> float:
    """Squares that a fit saves, less the noise that it damps - (N*m)**2 (N**2).

    An effect that filters speed or copies torque lowers its own noise, and what it damps of noise it does not explain.
    """
    damped = before.count * max(before.noise.white**2 - after.noise.white**2, 0.0)
    return before.squares - after.squares - damped


def _own(columns: Array, width: int) -> Array:
    """Inner products of the columns (m, groups*width) of each group (groups, width, width)."""
    groups = np.ascontiguousarray(columns.T).reshape(-1, width, columns.shape[0])
    return groups @ groups.transpose(0, 2, 1)


def _taken(own: Array, products: Array, targets: Array) -> Array:
    """Squares that groups of columns take from a residual beyond what an orthonormal basis spans (groups,).

    Args:
        own: inner products of each group's columns (groups, width, width).
        products: of all columns, group by group, with the targets (groups*width, p + 1).
        targets: the basis and, last, the residual (m, p + 1), in whose unit squared the squares are.
    """
    beside, left = np.split(products.reshape(*own.shape[:2], -1), [-1], axis=2)
    full = np.sqrt(np.einsum("gii->gi", own))
    own = own - beside @ beside.transpose(0, 2, 1)
    scale = np.sqrt(np.maximum(np.einsum("gii->gi", own), 0.0))
    weight = np.where(scale > 1e-4 * np.maximum(full, 1e-300), 1.0 / np.maximum(scale, 1e-300), 0.0)
    shared = (left[:, :, 0] - beside @ (targets[:, :-1].T @ targets[:, -1])) * weight
    inverse = symmetric_inverse(own * weight[:, :, None] * weight[:, None, :], 1e-8)
    return np.einsum("gi,gij,gj->g", shared, inverse, shared)


def hint(fitted: Fit, effects: Iterable[Effect]) -> Fit | None:
    """The fit with one more effect, the one that explains most, if that is more than chance does; else None.

    Of the effects those count that are linear in all their quantities, so that no search makes them fit. It is too weak
    to be named, and yet an estimate may be off by it: a torque constant that drifts by 1 % moves J by 0.8 %, a drag
    that takes 4 % of the torque at top speed moves K_w by a third, while each takes no more of the residual than some
    tenths of a per cent. What it would move is not known better.
    """
    linear = [
        effect
        for effect in effects
        if isinstance(effect, Columns) and not effect.shapes
        if effect.sought(fitted.scope) and fitted.hypothesis.admits(effect)
    ]
    gains = dict(zip(linear, fitted.worth(linear), strict=True))
    if max(gains.values(), default=0.0) <= SURE**2 * fitted.rows.correlation * fitted.noise.white**2:
        return None  # a floor in colour, which takes long, is no lower
    least = fitted.chance
    for effect in sorted((effect for effect in linear if gains[effect] > least), key=lambda effect: -gains[effect]):
        extended = fit(fitted.rows, fitted.hypothesis.plus(Term(effect)), fitted)
        strengths = extended.strengths(len(fitted.terms))
        physical = effect.physical(strengths, (), extended.base) and effect.plausible([strengths], [()], fitted.scope)
        if physical and extended.base.inertia > 0.0 and explained(fitted, extended) > least:
            return extended
    return None


def by_hint(rows: Rows, hypothesis: Hypothesis, offset: bool) -> tuple[str, dict[str, float]]:
    """The effect that a recording hints at: what share of the residual it explains, as text where that is much, and by
    how much it would move J, K_w and K_0; empty without one. With `offset` a constant is fitted anyway.
    """
    effects = catalogue().values()
    constants = [Term(effect) for effect in effects if effect.constant] if offset else []
    fitted = fit(rows, replace(hypothesis, terms=(*hypothesis.terms, *constants)))
    hinted = hint(fitted, effects)
    if hinted is None:
        return "", {}
    moves = {term: hinted.value(term) - fitted.value(term) for term in (INERTIA, VISCOUS, COULOMB)}
    share = max(1.0 - hinted.squares / max(fitted.squares, 1e-300), 0.0)
    return f"{words(hinted.terms[-1].effect.name)} would explain {percent(share)} of it" * (share > SUGGESTED), moves


def shaped(start: Fit, hypothesis: Hypothesis, index: int, over_noise: bool = False) -> Fit:
    """Search one term's shape for the least residual, the others held; `over_noise`: the least over its noise.

    Strengths start from those of a fit of the same recording.
    """
    return _projected(start, hypothesis, [index], over_noise)


def together(fitted: Fit) -> Fit:
    """Search the shapes of all terms at once: in a valley of two, a search of one makes no progress."""
    found = _projected(fitted, fitted.hypothesis, range(len(fitted.terms)))
    return found if found.squares < fitted.squares else fitted


def _projected(start: Fit, hypothesis: Hypothesis, indices: Sequence[int], over_noise: bool = False) -> Fit:
    """Search shapes of terms, strengths solved for at each: Gauss and Newton's steps by variable projection.

    G. H. Golub, V. Pereyra, SIAM Journal on Numerical Analysis 10, 1973, 413-432. The shape of one term starts from the
    best of points to each side, as it comes from a grid. One without a derivative, as of an instant between two rows,
    is held.
    """
    rows, scope, terms = start.rows, start.scope, [hypothesis.terms[index] for index in indices]
    counts = [len(term.searched(scope)) for term in terms]
    if not any(counts):
        return fit(rows, hypothesis, start)
    from scipy.optimize import least_squares  # 0.3 s, which only a shape that is searched has to pay

    rows_tried = _kept_behind(start, hypothesis, terms)

    def at(offset: Array) -> Hypothesis:
        moved = hypothesis
        for index, term, own in zip(indices, terms, np.split(offset, np.cumsum(counts)[:-1]), strict=True):
            moved = moved.with_term(index, term.moved(own, scope))
        return moved

    @cache
    def residual_at(place: tuple[float, ...]) -> Array:
        found = fit(rows_tried, at(np.array(place)), start) if any(place) else first
        return found.residual / (found.noise.white if over_noise else scale)

    def residual(offset: Array) -> Array:
        return residual_at(tuple(offset.tolist()))

    def slopes(offset: Array) -> Array:
        steps = SHAPE_STEP * np.eye(offset.size)
        return np.stack([(residual(offset + step) - residual(offset)) / SHAPE_STEP for step in steps], axis=1)

    first, starts = fit(rows_tried, hypothesis, start), np.zeros((1, sum(counts)))
    scale = first.rms or 1.0
    if len(terms) == 1:
        starts = np.concatenate([starts, ASIDE * np.eye(counts[0]), -ASIDE * np.eye(counts[0])])
    begun = min(starts, key=lambda offset: float(np.sum(residual(offset) ** 2)))
    found = least_squares(
        residual,
        begun,
        slopes,  # pyright: ignore[reportArgumentType] - its stub knows names only
        (-FURTHEST, FURTHEST),
        x_scale=1.0,
        ftol=SHAPE_ENOUGH,
        xtol=SHAPE_NEAR,
        max_nfev=MOST,
    )
    return fit(rows, at(found.x), start)


def _kept_behind(start: Fit, hypothesis: Hypothesis, terms: Sequence[Term]) -> Rows:
    """The recording in which terms are searched: what follows behind a coupling stays while they correct the motion."""
    if hypothesis.coupling is None or not any(isinstance(term.effect, Distortion) for term in terms):
        return start.rows
    held = start.rows.held
    fit(held, hypothesis, start)  # which makes it
    return held


def unbiased(fitted: Fit) -> Fit:
    """The shapes through which the noise of the motion passes searched again, for the least residual over that noise.

    Squares alone choose the shape that damps noise, not the one that the axis has: three to five times the damping of
    couplings above the filter's band, at 75 to 102 Hz. Over noise the estimate is consistent (errors in the variables),
    but it scatters, and goes astray where the noise is not as white as it is taken for.
    """
    for index, term in enumerate(fitted.terms):
        if term.effect.filters_motion:
            fitted = shaped(fitted, fitted.hypothesis, index, over_noise=True)
    return fitted
