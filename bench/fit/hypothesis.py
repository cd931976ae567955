"""A hypothesis - which effects there are, of what shape, and what else is in the recording - and its columns.

Dry frictions of one axis multiply: what scales the level scales all that other effects add to it.

    M = (K_0 + sum of added levels)*(1 + w_1)*(1 + w_2)*...

Linear in the strengths only with the other strengths held, as share of K_0. So it is where friction follows the torque
of a load, which is a matter of other strengths. An outer load - drag, a spring, an unbalance, an event - on the motor
is in the balance as it is; on the load of a soft coupling it shakes the coupling first, and its strength also
drives the load's motion. A fit brings all of these in line.

Among the columns is the last digit of a current that is reported in coarse steps. A current that is rounded errs by up
to half a step, evenly; one whose fraction is cut off is half a step nearer to zero on average, which a balance of
torque takes for friction or saturation. So half a step at most, in the direction of the torque, is a nuisance of the
recording wherever a step could be seen. The rest is noise (see `bench.fit.solution`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS
from bench.effects.effect import Bristles, Columns, Coupling, Distortion, Effect, Lag, lagged
from bench.effects.shape import is_pitch
from bench.effects.signals import Scope, Signals
from bench.effects.torque import Friction
from bench.fit.rows import Rows, effort_of, known_of, slope_of
from bench.trace.filter import Column
from bench.trace.motion import SIGN_REACH, Conditioning

#: Name of a column: a term of the equation of motion, what else a recording has, or the index of an effect's term.
Name = str | int
#: Coefficients that a fit found, by the names of their columns.
Found = Mapping[Name, Sequence[float]]
#: Strengths by the places of their terms.
Strengths = dict[int, tuple[float, ...]]
#: Of no fit.
NOTHING: Mapping[Any, Any] = MappingProxyType({})
#: Names of columns that belong to no effect: of the axis and the shift of torque against speed, and what else a
#: recording has - sines and cosines of the mains, what the last digit of the effort cuts off, what varies slowly around
#: a short event, links of a robot off their encoder. Those of an effect are named by the index of its term.
BASE = (INERTIA, VISCOUS, COULOMB, MISALIGNMENT)
HUM, DIGIT, AROUND, LINKS = "hum", "last digit", "around", "links"
#: Frequencies at which noise is summed, up to REACH over the filter's width, where it passes 1e-7 of the power.
FREQUENCIES, REACH = 400, 4.0
#: Frequencies to each unit of asinh of the distance from a resonance in its half widths.
CLOSER = 20
#: Angle - rad (m) - by which links of a robot may be off their encoder: a degree of its zero and of the play of gears.
MISPLACED = np.pi / 180.0
#: Terms of the series of a shift.
SERIES = 4
#: Share of the filtered white noise below which half a step is not seen.
UNSEEN = 0.1


@dataclass(frozen=True)
class Term:
    """An effect of a shape.

    Attributes:
        effect: what it is.
        shape: its nonlinear quantities, in the effect's order.
        on_load: whether it acts on the load behind a coupling instead of on the motor.
        around: from when to when the remaining residual is taken for a parabola, a nuisance - s -; () for nowhere.
    """

    effect: Effect
    shape: tuple[float, ...] = ()
    on_load: bool = False
    around: tuple[float, ...] = ()

    @property
    def key(self) -> tuple[str, tuple[float, ...]]:
        """What distinguishes its columns from those of other terms."""
        return self.effect.name, self.shape

    def fitted(self, scope: Scope) -> list[int]:
        """Places of the shape quantities that are numbers of a fit: none that is whole, or that follows from others."""
        shapes = enumerate(self.effect.shapes)
        return [k for k, shape in shapes if shape.step and (not shape.whole or is_pitch(shape, scope))]

    def searched(self, scope: Scope) -> list[int]:
        """Those of them that are searched step by step, and not in a way of their own."""
        return [k for k in self.fitted(scope) if self.effect.reach(self.shape, k)]

    def moved(self, offset: Array, scope: Scope) -> Term:
        """With the quantities that are searched an offset away, in units of how far a search goes."""
        shape = list(self.shape)
        for k, step in zip(self.searched(scope), offset.tolist(), strict=True):
            slot = self.effect.shapes[k]
            if is_pitch(slot, scope):
                shape[k] += step * scope.spacing
            elif slot.additive:
                shape[k] += step * self.effect.reach(self.shape, k)
            else:
                shape[k] *= float(np.exp(step * self.effect.reach(self.shape, k)))
        return replace(self, shape=tuple(shape))

    def same(self, other: Term) -> bool:
        """Whether it is the same effect of the same shape."""
        return self.effect is other.effect and self.shape == other.shape


@dataclass(frozen=True)
class Hypothesis:
    """Effects beyond inertia, viscous and Coulomb friction, and nuisances: what a recording has that the axis has not.

    Attributes:
        terms: in the order in which they were added.
        hum: frequencies of the mains in this recording's sensors - Hz.
        step: between the values of the effort, if its last digit matters; else 0 - N*m (N).
        shift: by which the torque is taken late, in addition to the small one that is fitted - s.
        misplaced: whether links of a robot may be off where their encoder is.
    """

    terms: tuple[Term, ...] = ()
    hum: tuple[float, ...] = ()
    step: float = 0.0
    shift: float = 0.0
    misplaced: bool = False

    def plus(self, term: Term) -> Hypothesis:
        """This hypothesis and one term more."""
        return replace(self, terms=(*self.terms, term))

    def without(self, index: int) -> Hypothesis:
        """This hypothesis less one of its terms."""
        return replace(self, terms=(*self.terms[:index], *self.terms[index + 1 :]))

    def reshaped(self, index: int, shape: tuple[float, ...]) -> Hypothesis:
        """This hypothesis with another shape of one term."""
        return self.with_term(index, replace(self.terms[index], shape=shape))

    def with_term(self, index: int, term: Term) -> Hypothesis:
        """This hypothesis with another term in the place of one."""
        return replace(self, terms=(*self.terms[:index], term, *self.terms[index + 1 :]))

    def with_terms(self, terms: Iterable[Term]) -> Hypothesis:
        """This hypothesis with other terms."""
        return replace(self, terms=tuple(terms))

    def admits(self, effect: Effect) -> bool:
        """Whether an effect may be added to these: one coupling, one lag."""
        if any(term.effect is effect for term in self.terms) and not effect.repeatable:
            return False
        return not any(isinstance(effect, kind) and self.of_kind(kind) for kind in (Coupling, Lag))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(term.effect.name for term in self.terms)

    def of_kind(self, *kinds: type[Effect]) -> list[int]:
        """Indices of the terms whose effects are of one of some kinds."""
        return [index for index, term in enumerate(self.terms) if isinstance(term.effect, kinds)]

    def having(self, true_of: Callable[[Effect], bool]) -> list[int]:
        """Indices of the terms of whose effects something is true."""
        return [index for index, term in enumerate(self.terms) if true_of(term.effect)]

    @property
    def couplings(self) -> tuple[tuple[Coupling, tuple[float, ...]], ...]:
        """What joins motor and load, with its shape; () if they are one."""
        return tuple((term.effect, term.shape) for term in self.terms if isinstance(term.effect, Coupling))

    @property
    def coupling(self) -> int | None:
        """Index of the term that joins motor and load, None if they are one."""
        return next(iter(self.of_kind(Coupling)), None)


@dataclass(frozen=True)
class Layout:
    """A hypothesis in columns.

    Attributes:
        columns: (m, p): J, K_w, K_0, misalignment, the effort's last digit where it matters, waves of the mains,
            then the effects' in order, each followed by what varies around it.
        owners: (p,) index of the term a column belongs to, or one of the names of BASE, DIGIT, HUM, LINKS or AROUND.
        effort: (m,) what they are to explain - N*m (N).
        noise: (p, p) covariance of the columns due to the sensors' noise in a row.
        bounds: lowest and highest value of strengths that are not free, by their places.
        rescaling: places of strengths that rescale the reported torque.
        known: inertia by which the effort has the noise of the acceleration, too - kg*m**2 (kg).
    """

    columns: Array
    owners: NDArray[np.object_]
    effort: Array
    noise: Array
    bounds: Mapping[int, tuple[float, float]]
    rescaling: NDArray[np.intp]
    known: float = 0.0

    def by_name(self, theta: Array) -> dict[Name, list[float]]:
        """Coefficients (p,) by the names of their columns."""
        return {name: theta[self.owners == name].tolist() for name in dict.fromkeys(self.owners.tolist())}

    def acting(self, theta: Array) -> float:
        """Torque that acts per reported torque, by coefficients (p,): 1 unless a term rescales it."""
        return max(float(1.0 + theta[self.rescaling].sum()), 1e-9)

    def left(self, theta: Array) -> Array:
        """Measured less modelled torque (m,), as it would be reported: a scale alone does not reduce it - N*m (N)."""
        return (self.effort - self.columns @ theta) / self.acting(theta)


def plain(rows: Rows) -> Hypothesis:
    """The hypothesis without an effect: with the effort's last digit where half a step of it could be seen."""
    conditioning = rows.conditioning
    noise = conditioning.effort_noise * conditioning.filter.noise_gain(0)
    return Hypothesis(step=conditioning.effort_step if 0.5 * conditioning.effort_step > UNSEEN * noise else 0.0)


def lay_out(
    rows: Rows, hypothesis: Hypothesis, found: Found = NOTHING, missing: Mapping[int, Array] = NOTHING
) -> Layout:
    """Columns of a hypothesis of a recording.

    Args:
        found: coefficients of a fit before, on some of which columns depend: see `depended_on`.
        missing: what each term that copies torque does not use, see `not_reaching`.
    """
    seen, (moving, resting, late) = seen_by(rows, hypothesis), delays(rows, hypothesis)
    parts = [seen.kept(_axis, lag=(moving, moving, resting, resting + late))]
    owners: list[Name] = [*BASE]
    links = seen.stretches[0].signals
    bounds = {BASE.index(MISALIGNMENT): (-rows.scope.latched, rows.scope.latched)}
    if hypothesis.step:
        parts.append(seen.kept(_cut_off, lag=resting))
        bounds[len(owners)] = (0.0, 0.5 * hypothesis.step)
        owners.append(DIGIT)
    if hypothesis.misplaced:
        parts.append(seen.kept(slope_of, lag=moving))
        bounds[len(owners)] = (-MISPLACED, MISPLACED)
        owners.append(LINKS)
    if hypothesis.hum:
        parts.append(seen.kept(_of_hum, hypothesis.hum, rows.starts, lag=resting))
        owners += [HUM] * parts[-1].shape[1]
    for index, term in enumerate(hypothesis.terms):
        lag = moving if isinstance(term.effect, Coupling) else resting
        parts.append(_of_term(seen, hypothesis, index, lag, found, missing.get(index)))
        if isinstance(term.effect, Columns):
            bounds |= {len(owners) + place: most for place, most in term.effect.bounded.items()}
        if isinstance(term.effect, Coupling) and links.known and links.link_inertia > 0.0:
            bounds[len(owners)] = links.link_inertia, links.link_inertia  # what is behind it is the links
        owners += [index] * parts[-1].shape[1]
        if term.around:
            parts.append(_around(seen, term.around))
            owners += [AROUND] * parts[-1].shape[1]
    columns = np.concatenate(parts, axis=1) if len(parts) > 1 else parts[0]
    held_by = np.array(owners, dtype=object)
    effort = seen.kept(effort_of, lag=late)[:, 0] if late else seen.effort
    if (moving or late) and links.known:
        # as the motion shows it, whose lag is undone; all of it of an effort that was computed again
        known = seen.kept(known_of, lag=moving)[:, 0]
        effort = effort - (known if late else known - seen.kept(known_of)[:, 0])
    rescaling = np.flatnonzero(np.isin(held_by, hypothesis.having(lambda effect: effect.rescales_torque)))
    if hypothesis.shift:
        effort = effort + seen.kept(_moved, hypothesis.shift, lag=late)[:, 0]
    noise = _noise(rows, hypothesis, held_by, moving, late)
    return Layout(columns, held_by, effort, noise, bounds, rescaling, rows.known_inertia)


def _axis(signals: Signals) -> list[Column]:
    """Those of BASE."""
    source, order = (signals.position, 1) if signals.source == "position" else (signals.velocity, 0)
    return [[(source, order + 1)], [(source, order)], [(signals.sign, 0)], [(-(signals.effort + signals.of_motion), 1)]]


def _moved(signals: Signals, shift: float) -> list[Column]:
    """By how much the effort a shift later is another one: whole samples, and Taylor's series for the rest of one."""
    driven = signals.effort + signals.of_motion
    samples = round(shift / signals.sample_period)
    rest, at = shift - samples * signals.sample_period, np.clip(np.arange(driven.size) + samples, 0, driven.size - 1)
    later = [(rest**order / math.factorial(order) * driven[at], order) for order in range(SERIES + 1)]
    return [[*later, (-driven, 0)]]


def _cut_off(signals: Signals) -> list[Column]:
    """What a fraction that is cut off takes from the effort, per unit of half a step."""
    return [[(-np.sign(signals.effort), 0)]]


def _of_hum(signals: Signals, lines: tuple[float, ...], starts: tuple[float, ...]) -> list[Column]:
    """Sine and cosine of every line in every recording: no two of them start at the same phase of the mains."""
    angles = [2.0 * np.pi * line * signals.time for line in lines]
    waves = [wave(angle) for angle in angles for wave in (np.sin, np.cos)]
    return [[(values if start == signals.began else np.zeros_like(values), 0)] for start in starts for values in waves]


def _around(seen: Rows, around: tuple[float, ...]) -> Array:
    """A constant, a ramp and a parabola over a stretch of time and what the filter reaches next to it, else 0 (m, 3).

    Not filtered: what is smooth all the way passes the filter as such, and only its stretch has edges.
    """
    first, last = around
    half = 0.5 * (last - first) + SIGN_REACH * seen.conditioning.filter.width
    at = (seen.time - 0.5 * (first + last)) / half
    return np.where(np.abs(at) <= 1.0, at ** np.arange(3)[:, None], 0.0).T


def _of_term(seen: Rows, hypothesis: Hypothesis, index: int, lag: float, found: Found, missing: Array | None) -> Array:
    """Columns (m, k) of one term; none of one that only changes how the recording is seen.

    What follows the motion behind a coupling is integrated at length, and only once where nothing but a lag differs.
    """
    term, effect = hypothesis.terms[index], hypothesis.terms[index].effect
    if not isinstance(effect, Columns):
        return np.empty((seen.effort.size, 0))
    seen = _seen_by_term(seen, hypothesis, index, found)
    if missing is not None:
        return _copied(seen, effect, term.shape, lag, missing)
    if not isinstance(effect, Coupling):
        columns = seen.kept_of(effect, term.shape, lag)
        constant = effect.spring and hypothesis.having(lambda other: other.constant or other.directed)
        return columns * (1.0, 0.0) if constant else columns  # a balance has one constant
    of_terms = [(hypothesis.terms[k], load) for k, load in _loads(hypothesis, found).items()]
    loads = [(each.effect, each.shape, load) for each, load in of_terms if isinstance(each.effect, Columns)]
    if loads:
        return seen.table(lambda s: effect.columns_of(s, [term.shape], loads), lag)

    made_of, stretches = (effect.tables_of, term.shape), [part.signals for part in seen.stretches]

    def table() -> Array:
        made = seen.memory.get((*made_of, seen.motion), lambda: effect.tables_of(stretches, [term.shape]))
        return seen.table(made, lag)

    return seen.memory.get((made_of, lag, seen.made_by), table)


def _seen_by_term(seen: Rows, hypothesis: Hypothesis, index: int, found: Found) -> Rows:
    """The recording with the terms from which that one is computed: dry friction, or a load."""
    effect = hypothesis.terms[index].effect
    if effect.scales_friction or isinstance(effect, Bristles):
        seen = _with_friction(seen, hypothesis, index, found)
    return _with_load(seen, hypothesis, found) if effect.follows_load else seen


def unfiltered(rows: Rows, hypothesis: Hypothesis, found: Found) -> dict[int, Array]:
    """Torque at the rows themselves (m,), by place, of terms that need no filter: neither derivative nor torque."""
    seen, torques = seen_by(rows, hypothesis), dict[int, Array]()
    for index, term in enumerate(hypothesis.terms):
        effect = term.effect
        if not isinstance(effect, Columns) or isinstance(effect, Coupling) or effect.copies_torque or term.on_load:
            continue
        own = _seen_by_term(seen, hypothesis, index, found)
        columns = effect.columns(own.stretches[0].signals, term.shape)
        if all(order == 0 for column in columns for _, order in column):
            torques[index] = own.values(partial(_plain_torque, effect, term.shape, found[index]))
    return torques


def _plain_torque(effect: Columns, shape: Sequence[float], strengths: Sequence[float], signals: Signals) -> Array:
    """At the samples (n,), of columns without derivatives - N*m (N)."""
    columns = effect.columns(signals, shape)
    return np.sum([own * values for own, ((values, _),) in zip(strengths, columns, strict=True)], axis=0)


def _copied(seen: Rows, effect: Columns, shape: tuple[float, ...], lag: float, missing: Array) -> Array:
    """Columns (m, k) of the modelled torque: of samples less what is missing at the rows between them (m,) - N*m (N).

    That has passed the filter, which takes the fastest of it once more: the slope of the columns makes it good.
    """
    step, joined = 1e-3 * rms(seen.effort), seen.joined
    between = seen.laid(lambda signals: _acting(signals, seen.time, missing, lag))
    low, high = (replace(joined, torque=joined.torque - between + more) for more in (0.0, step))
    columns = [*effect.columns(low, shape), *effect.columns(high, shape), [(between, 0)]]
    table = seen.table([columns], lag)
    low, high, twice = np.split(table, [table.shape[1] // 2, table.shape[1] - 1], axis=1)
    return low - (high - low) / step * (missing[:, None] - twice)


def _acting(s: Signals, time: Array, reported: Array, lag: float) -> Array:
    """At the samples (n,) what acts of a reported torque at rows (m,) behind a lag of the current loop - N*m (N)."""
    between = np.interp(s.time + s.began, time, reported)
    return lagged(between, lag, s.sample_period) if lag else between


def _noise(rows: Rows, hypothesis: Hypothesis, owners: NDArray[np.object_], moving: float, late: float) -> Array:
    """Covariance (p, p) of the columns due to the sensors' white noise."""
    smooth, effort_noise = rows.conditioning.filter, rows.conditioning.effort_noise
    gain = smooth.noise_gain(1) ** 2 + (late * smooth.noise_gain(2)) ** 2
    noise = np.zeros((owners.size, owners.size))
    noise[BASE.index(MISALIGNMENT), BASE.index(MISALIGNMENT)] = effort_noise**2 * gain
    couplings = hypothesis.couplings
    behind = [int(np.flatnonzero(owners == index)[0]) for index in hypothesis.of_kind(Coupling)]
    places = [BASE.index(INERTIA), BASE.index(VISCOUS), *behind]
    made_of = _noise_of_motion, moving, couplings
    of_motion = rows.memory.get(made_of, lambda: _noise_of_motion(rows.conditioning, moving, couplings))
    noise[np.ix_(places, places)] = of_motion
    return noise


def _noise_of_motion(
    conditioning: Conditioning, moving: float, couplings: Sequence[tuple[Coupling, tuple[float, ...]]]
) -> Array:
    """That of acceleration, speed, of which a lag `moving` - s - is undone, and what follows them (2 + c, 2 + c).

    A smoothed signal and its derivative are uncorrelated, as G is even and omega*G odd; what follows the motion behind
    a coupling is not uncorrelated with the motor's acceleration: its transfer determines how much of that noise it has.
    """
    smooth = conditioning.filter
    omega = frequencies(couplings, REACH / smooth.width, FREQUENCIES)
    # all of them less the speed's own factor, (1j * omega) ** order * (1.0 + 1j * omega * moving)
    s = np.asarray(1j * omega, dtype=np.complex128)
    behind = (s * effect.noise_of_motion(shape, omega) for effect, shape in couplings)
    spectra = np.stack([s, np.ones_like(s), *behind])
    weight = conditioning.source_power(omega) * smooth.sample_period / np.pi * np.exp(-((omega * smooth.width) ** 2))
    weight *= omega ** (2 * conditioning.order) * (1.0 + (omega * moving) ** 2)
    steps = np.diff(omega, prepend=0.0, append=omega[-1])
    weight *= 0.5 * (steps[1:] + steps[:-1])  # the trapezoidal rule
    return ((spectra * weight) @ spectra.conj().T).real


def frequencies(couplings: Iterable[tuple[Coupling, tuple[float, ...]]], highest: float, count: int) -> Array:
    """Angular frequencies (k,) over which a power is summed: `count` even ones from 0 to the highest - rad/s -, and
    around each resonance of a coupling CLOSER to each unit of asinh of the distance from it in half widths: some 20
    over its half width at half power, and as dense further away as its flanks need.
    """
    even, near = np.linspace(0.0, highest, count), []
    for effect, shape in couplings:
        for centre, half in effect.resonances(shape):
            if half > 0.0:
                ends = np.arcsinh(np.array([-centre, highest - centre]) / half)
                near.append(centre + half * np.sinh(np.arange(ends[0], ends[1], 1.0 / CLOSER)))
    return np.unique(np.clip(np.concatenate([even, *near]), 0.0, highest)) if near else even


def seen_by(rows: Rows, hypothesis: Hypothesis) -> Rows:
    """The recording as the hypothesis has it: without the faults of its sensors."""
    terms = sorted(hypothesis.terms, key=lambda term: term.key)
    faults = [(term.effect, term.shape) for term in terms if isinstance(term.effect, Distortion)]
    if not faults:
        return rows

    def change(signals: Signals) -> Signals:
        for effect, shape in faults:
            signals = effect.without_fault(signals, shape)
        return signals

    return rows.with_signals(change, tuple((effect.name, shape) for effect, shape in faults))


def delays(rows: Rows, hypothesis: Hypothesis) -> tuple[float, float, float]:
    """Lags to undo on columns of motion, on all others, and on the reported effort - s."""
    source, terms = rows.conditioning.source, hypothesis.terms
    found = [term.effect.delays(term.shape, source) for term in terms if isinstance(term.effect, Lag)]
    moving, resting, late = (sum(each) for each in zip(*found, strict=True)) if found else (0.0, 0.0, 0.0)
    return moving, resting, late


def _with_friction(seen: Rows, hypothesis: Hypothesis, index: int, found: Found) -> Rows:
    """The recording with the level of dry friction that the term at an index scales or carries, as share of K_0.

    sgn(omega) and what terms add to it, times what scales it: before the one at the index, or all where it carries it.
    """
    carries = index in hypothesis.of_kind(Bristles)
    acting = [
        (effect, hypothesis.terms[k].shape, level)
        for k, level in _levels(hypothesis, found).items()
        if isinstance(effect := hypothesis.terms[k].effect, Friction) and k != index
        if k < index or carries or not effect.scales_friction
    ]
    if not acting:
        return seen
    acting.sort(key=lambda each: each[0].scales_friction)  # stable: all that adds first

    def change(signals: Signals) -> Signals:
        for effect, shape, level in acting:
            signals = replace(signals, friction=signals.friction + effect.signed(signals, level, shape))
        return signals

    return seen.with_signals(change)


def _with_load(seen: Rows, hypothesis: Hypothesis, found: Found) -> Rows:
    """The recording with the torque that terms make as a load of the transmission."""
    terms = [(hypothesis.terms[k], pull) for k, pull in _pulls(hypothesis, found).items()]
    known = [(term.effect, term.shape, pull) for term, pull in terms if isinstance(term.effect, Columns)]
    if not known:
        return seen

    def change(signals: Signals) -> Signals:
        load = np.zeros(signals.time.size)
        for effect, shape, strengths in known:
            for strength, ((values, _),) in zip(strengths, effect.columns(signals, shape), strict=True):
                load += strength * values
        return replace(signals, load=load)

    return seen.with_signals(change)


def rows_of_next(rows: Rows, hypothesis: Hypothesis, left: Array, found: Found) -> Rows:
    """The recording as one more term would read it, by the residual (m,) - N*m (N) - and the fit's coefficients.

    It sees the modelled torque in the place of the measured. Columns computed from the measured torque contain what a
    model does not explain and explain it by itself: errors in the variables, for which the modelled torque is the
    instrument (W. A. Fuller, Measurement Error Models, 1987, 1.4).
    """
    lag = delays(rows, hypothesis)[1]
    seen = seen_by(rows, hypothesis).with_signals(
        lambda s: replace(s, torque=s.torque - _acting(s, rows.time, left, lag))
    )
    return _with_load(_with_friction(seen, hypothesis, len(hypothesis.terms), found), hypothesis, found)


def not_reaching(hypothesis: Hypothesis, layout: Layout, theta: Array) -> dict[int, Array]:
    """By the place of each term that copies torque: the part of the reported one that it does not use (m,) - N*m (N).

    That is what no term explains, and what those take that the torque passes before: gains of reading, constant and
    position multiply, and dry friction is caused by the torque that comes of it.
    """
    copies, found = hypothesis.having(lambda effect: effect.copies_torque), {}
    if not copies:
        return found
    lost = layout.effort - layout.columns @ theta
    for index in sorted(copies, key=lambda index: hypothesis.terms[index].effect.stage):
        own = layout.owners == index
        found[index], lost = lost, lost + layout.columns[:, own] @ theta[own]
    return found


def _shares(hypothesis: Hypothesis, found: Found, of: float, wanted: Callable[[Term], bool]) -> Strengths:
    """Strengths of wanted terms over a number, by their places; none where that is not positive."""
    places = [k for k, term in enumerate(hypothesis.terms) if of > 0.0 and k in found and wanted(term)]
    return {k: tuple(strength / of for strength in found[k]) for k in places}


def _levels(hypothesis: Hypothesis, found: Found) -> Strengths:
    """Levels of dry friction that terms add, over K_0."""
    return _shares(hypothesis, found, found.get(COULOMB, (0.0,))[0], lambda term: isinstance(term.effect, Friction))


def _loads(hypothesis: Hypothesis, found: Found) -> Strengths:
    """Strengths of terms that act on the load behind a coupling, over its inertia."""
    inertia = 0.0 if hypothesis.coupling is None else found.get(hypothesis.coupling, (0.0,))[0]
    return _shares(hypothesis, found, inertia, lambda term: term.on_load)


def _pulls(hypothesis: Hypothesis, found: Found) -> Strengths:
    """Strengths of terms that load the transmission."""
    return _shares(hypothesis, found, 1.0, lambda term: term.effect.transmitted)


def depended_on(hypothesis: Hypothesis, found: Found) -> list[float]:
    """The strengths on which columns of other terms depend: a load, or friction that multiplies."""
    levels, follows = _levels(hypothesis, found), hypothesis.having(lambda effect: effect.follows_load)
    scaled = hypothesis.having(lambda effect: effect.scales_friction) and len(hypothesis.of_kind(Friction)) > 1
    used = levels if scaled or hypothesis.of_kind(Bristles) else {}, _pulls(hypothesis, found) if follows else {}
    return [value for own in (*used, _loads(hypothesis, found)) for strengths in own.values() for value in strengths]


def in_line(now: Sequence[float], then: Sequence[float]) -> bool:
    """Whether strengths on which columns depend are as they were when these columns were made."""
    return len(now) == len(then) and np.allclose(now, then, rtol=1e-3, atol=1e-6)


def outer_loads(hypothesis: Hypothesis) -> list[int]:
    """Indices of the terms that may act on the load of a coupling; none without one."""
    return [] if hypothesis.coupling is None else hypothesis.having(lambda effect: effect.external)


def on_other_side(hypothesis: Hypothesis) -> Hypothesis:
    """The hypothesis with its outer loads on the load instead of on the motor, or the other way round."""
    outer = outer_loads(hypothesis)
    onto = not any(hypothesis.terms[index].on_load for index in outer)
    return hypothesis.with_terms(
        replace(term, on_load=onto) if index in outer else term for index, term in enumerate(hypothesis.terms)
    )
