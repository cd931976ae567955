"""Columns of a hypothesis: the recording as it sees it, laid out for least squares.

Among them is the last digit of a current that is reported in coarse steps. A current that is rounded errs by up to half
a step, evenly; one whose fraction is cut off stands half a step nearer to zero on average, which a balance of torque
takes for friction or saturation. So half a step at most, in the direction of the torque, is a nuisance of the recording
wherever a step could be seen. What is left is noise, white where noise of the sensor moves the signal over the steps;
where it does not, the error follows the signal's slow way through them and passes the filter: it is then read off the
modelled torque, rounded in the same steps.

    e = q*round(M/q) - M, of which noise of a deviation s leaves exp(-2*(pi*s/q)**2)

q - step; M - modelled torque - N*m (N).
Source: B. Widrow, I. Kollar, Quantization Noise, 2008 (characteristic function of a dithered quantiser).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS
from bench.effects.acting import FollowsLoad, FrictionLevel, MisreadEffort, ScalesTorque, TorqueLoss
from bench.effects.effect import Columns, CopiesTorque, Coupling, Distortion, Effect, EffortLag, MotionLag
from bench.effects.signals import Signals
from bench.fit.hypothesis import Hypothesis, loads_of, with_friction, with_load
from bench.fit.normal_equations import Name
from bench.fit.rows import Rows, known_of
from bench.trace.filter import Column
from bench.trace.motion import SIGN_REACH

#: Names of columns that belong to no effect: of the axis and the shift of torque against speed, and what else a
#: recording has - sines and cosines of the mains, what the last digit of the effort cuts off, what varies slowly around
#: a short event. Those of an effect are named by the index of its term.
BASE = (INERTIA, VISCOUS, COULOMB, MISALIGNMENT)
HUM, DIGIT, AROUND = "hum", "last digit", "around"
#: Frequencies at which noise is summed, up to REACH over the filter's width, where it passes 1e-7 of the power.
FREQUENCIES, REACH = 400, 4.0
#: Share of the filtered white noise below which half a step is not seen.
UNSEEN = 0.1
#: What the torque passes from its reading to the motion, by kinds of effects that copy it.
STAGES = (MisreadEffort, TorqueLoss, ScalesTorque, FrictionLevel)


@dataclass(frozen=True)
class Layout:
    """A hypothesis in columns.

    Attributes:
        columns: (m, p): J, K_w, K_0, misalignment, the effort's last digit where it matters, sines and cosines of hum,
            then the effects' in order, each followed by what varies around it.
        owners: (p,) index of the term a column belongs to, or one of the names of BASE, DIGIT, HUM or AROUND.
        effort: (m,) what they are to explain - N*m (N).
        noise: (p, p) covariance of what the sensors' noise makes of the columns in a row.
        bounds: lowest and highest value of strengths that are not free, by their places.
    """

    columns: Array
    owners: NDArray[np.object_]
    effort: Array
    noise: Array
    bounds: Mapping[int, tuple[float, float]]

    @property
    def of_effects(self) -> NDArray[np.bool_]:
        """Which columns are those of an effect (p,)."""
        return np.array([isinstance(owner, int) for owner in self.owners])


def plain(rows: Rows) -> Hypothesis:
    """The hypothesis without an effect: with the effort's last digit where half a step of it could be seen."""
    conditioning = rows.conditioning
    noise = conditioning.effort_noise * conditioning.filter.noise_gain(0)
    return Hypothesis(step=conditioning.effort_step if 0.5 * conditioning.effort_step > UNSEEN * noise else 0.0)


def seen_by(rows: Rows, hypothesis: Hypothesis) -> Rows:
    """The recording as the hypothesis has it: without the faults of its sensors."""
    terms = sorted(hypothesis.terms, key=lambda term: term.key)
    faults = [(term.effect, term.shape) for term in terms if isinstance(term.effect, Distortion)]
    if not faults:
        return rows

    def change(signals: Signals) -> Signals:
        for effect, shape in faults:
            signals = effect.see(signals, shape)
        return signals

    return rows.with_signals(change, tuple((effect.name, shape) for effect, shape in faults))


def delays(rows: Rows, hypothesis: Hypothesis) -> tuple[float, float]:
    """Lag to undo on columns of motion, and on all others - s."""
    lags = [(term.effect, term.shape) for term in hypothesis.terms if isinstance(term.effect, MotionLag)]
    found = [effect.delays(shape, rows.conditioning.source) for effect, shape in lags]
    return sum(moving for moving, _ in found), sum(resting for _, resting in found)


def effort_lag(hypothesis: Hypothesis) -> float:
    """Lag to undo on the reported effort - s."""
    return sum(term.effect.effort_lag(term.shape) for term in hypothesis.terms if isinstance(term.effect, EffortLag))


def by_model(rows: Rows, left: Array) -> Rows:
    """The recording with the modelled torque in the place of the measured, whose residual (m,) is given - N*m (N).

    Columns made of the measured torque would hold what a model leaves of it, and so explain it by itself: errors in the
    variables, for which the modelled torque is the instrument (W. A. Fuller, Measurement Error Models, 1987, 1.4).
    """
    time = rows.time
    return rows.with_signals(lambda s: replace(s, torque=s.torque - np.interp(s.time + s.began, time, left)))


def not_reaching(hypothesis: Hypothesis, layout: Layout, theta: Array) -> dict[int, Array]:
    """By the place of each term that copies torque: what of the reported one it is not made of (m,) - N*m (N).

    That is what no term explains, and what those take that the torque passes before: gains of reading, constant and
    position multiply, and dry friction is caused by the torque that comes of it.
    """
    effects = [term.effect for term in hypothesis.terms]
    copies = [index for index, effect in enumerate(effects) if isinstance(effect, CopiesTorque)]
    if not copies:
        return {}
    lost, found = layout.effort - layout.columns @ theta, {}
    for index in sorted(copies, key=lambda index: _stage(effects[index])):
        own = layout.owners == index
        found[index], lost = lost, lost + layout.columns[:, own] @ theta[own]
    return found


def _stage(effect: Effect) -> int:
    """Where the torque passes an effect."""
    return next((stage for stage, kind in enumerate(STAGES) if isinstance(effect, kind)), STAGES.index(ScalesTorque))


def lay_out(rows: Rows, hypothesis: Hypothesis, missing: Mapping[int, Array] | None = None) -> Layout:
    """Columns of a hypothesis; `missing`: what each that copies torque is not made of, see `not_reaching`."""
    seen, late = seen_by(rows, hypothesis), effort_lag(hypothesis)
    moving, resting = delays(rows, hypothesis)
    lags = moving, moving, resting, resting + late
    parts = [rows.memory.get((_axis, lags, seen.made_by), lambda: _axis(seen, lags))]
    owners: list[Name] = [*BASE]
    bounds = {BASE.index(MISALIGNMENT): (-rows.scope.latched, rows.scope.latched)}
    if hypothesis.step:
        parts.append(seen.kept(_cut_off, _cut_off, resting))
        bounds[len(owners)] = (0.0, 0.5 * hypothesis.step)
        owners.append(DIGIT)
    if hypothesis.hum:
        lines, starts = hypothesis.hum, rows.starts
        parts.append(seen.kept((_of_hum, lines), lambda s: _of_hum(s, lines, starts), resting))
        owners += [HUM] * parts[-1].shape[1]
    for index, term in enumerate(hypothesis.terms):
        lag = moving if isinstance(term.effect, Coupling) else resting
        parts.append(_of_term(seen, hypothesis, index, lag, (missing or {}).get(index)))
        if isinstance(term.effect, Columns):
            bounds |= {len(owners) + place: most for place, most in term.effect.bounded.items()}
        owners += [index] * parts[-1].shape[1]
        if term.around:
            parts.append(_around(seen, term.around))
            owners += [AROUND] * parts[-1].shape[1]
    columns = np.concatenate(parts, axis=1) if len(parts) > 1 else parts[0]
    held_by = np.array(owners, dtype=object)
    effort = seen.kept(_of_effort, _of_effort, late)[:, 0] if late else seen.effort
    if (moving or late) and seen.stretches[0].signals.known:
        # as the motion tells it, whose lag is undone; all of it of an effort that was made anew
        known = seen.kept(known_of, known_of, moving)[:, 0]
        effort = effort - (known if late else known - seen.kept(known_of, known_of)[:, 0])
    return Layout(columns, held_by, effort, _noise(rows, hypothesis, held_by, moving), bounds)


def _of_term(seen: Rows, hypothesis: Hypothesis, index: int, lag: float, missing: Array | None) -> Array:
    """Columns (m, k) of one term; none of one that only changes how the recording is seen.

    What follows the motion behind a coupling is integrated at length, and only once where nothing but a lag differs.
    """
    term, effect = hypothesis.terms[index], hypothesis.terms[index].effect
    if not isinstance(effect, Columns):
        return np.empty((seen.effort.size, 0))
    seen = with_friction(seen, hypothesis, index)
    if isinstance(effect, FollowsLoad):
        seen = with_load(seen, ((other, other.pull) for other in hypothesis.terms))
    if missing is not None:
        return _copied(seen, effect, term.shape, lag, missing)
    if not isinstance(effect, Coupling):
        return seen.kept((effect.columns, term.shape), lambda s: effect.columns(s, term.shape), lag)
    loads = loads_of(hypothesis)
    if loads:
        return seen.table(lambda s: effect.columns_of(s, [term.shape], loads), lag)

    made_of, stretches = (effect.tables_of, term.shape), [part.signals for part in seen.stretches]

    def table() -> Array:
        made = seen.memory.get((*made_of, seen.motion), lambda: effect.tables_of(stretches, [term.shape]))
        return seen.table(made, lag)

    return seen.memory.get((made_of, lag, seen.made_by), table)


def _copied(seen: Rows, effect: Columns, shape: tuple[float, ...], lag: float, missing: Array) -> Array:
    """Columns (m, k) of the modelled torque: of samples less what is missing at the rows between them (m,) - N*m (N).

    That has passed the filter, which takes the fastest of it once more: the slope of the columns makes it good.
    """
    time, step = seen.time, 1e-3 * rms(seen.effort)

    def columns(s: Signals) -> list[Column]:
        between = np.interp(s.time + s.began, time, missing)
        low, high = (replace(s, torque=s.torque - between + more) for more in (0.0, step))
        return [*effect.columns(low, shape), *effect.columns(high, shape), [(between, 0)]]

    table = seen.table(columns, lag)
    low, high, twice = np.split(table, [table.shape[1] // 2, table.shape[1] - 1], axis=1)
    return low - (high - low) / step * (missing[:, None] - twice)


def _axis(seen: Rows, lags: tuple[float, ...]) -> Array:
    """Columns (m, 4) of BASE."""
    order = 1 if seen.conditioning.source == "position" else 0

    def columns(signals: Signals) -> list[Column]:
        values = getattr(signals, seen.conditioning.source)
        return [[(values, order + 1)], [(values, order)], [(signals.sign, 0)], [(signals.effort, 1)]]

    table = seen.table(columns, lags)
    table[:, BASE.index(MISALIGNMENT)] *= -1.0
    return table


def _around(seen: Rows, around: tuple[float, ...]) -> Array:
    """A constant, a ramp and a parabola over a stretch of time and what the filter reaches beside it, else 0 (m, 3).

    Not filtered: what is smooth all the way passes the filter as such, and only its stretch has edges.
    """
    first, last = around
    half = 0.5 * (last - first) + SIGN_REACH * seen.conditioning.filter.width
    at = (seen.time - 0.5 * (first + last)) / half
    return np.where(np.abs(at) <= 1.0, at ** np.arange(3)[:, None], 0.0).T


def _of_effort(signals: Signals) -> list[Column]:
    return [[(signals.effort, 0)]]


def _cut_off(signals: Signals) -> list[Column]:
    """What a fraction that is cut off takes from the effort, per unit of half a step."""
    return [[(-np.sign(signals.effort), 0)]]


def _of_hum(signals: Signals, lines: tuple[float, ...], starts: tuple[float, ...]) -> list[Column]:
    """Sine and cosine of every line in every recording: no two of them start at the same phase of the mains."""
    angles = [2.0 * np.pi * line * signals.time for line in lines]
    waves = [wave(angle) for angle in angles for wave in (np.sin, np.cos)]
    return [[(values if start == signals.began else np.zeros_like(values), 0)] for start in starts for values in waves]


def _noise(rows: Rows, hypothesis: Hypothesis, owners: NDArray[np.object_], moving: float) -> Array:
    """Covariance (p, p) of what the sensors' white noise makes of the columns.

    A smoothed signal and its derivative are uncorrelated, as G is even and omega*G odd; what follows the motion behind
    a coupling is not uncorrelated with the motor's acceleration: its transfer says how much of that noise it has.
    """
    conditioning = rows.conditioning
    smooth, order = conditioning.filter, conditioning.order
    noise = np.zeros((owners.size, owners.size))
    gain = smooth.noise_gain(1) ** 2 + (effort_lag(hypothesis) * smooth.noise_gain(2)) ** 2
    noise[BASE.index(MISALIGNMENT), BASE.index(MISALIGNMENT)] = conditioning.effort_noise**2 * gain
    omega = np.linspace(0.0, REACH / smooth.width, FREQUENCIES)
    # all of them less the speed's own factor, (1j * omega) ** order * (1.0 + 1j * omega * moving)
    s = np.asarray(1j * omega, dtype=np.complex128)
    transfers = {BASE.index(INERTIA): s, BASE.index(VISCOUS): np.ones_like(s)}
    for index, term in enumerate(hypothesis.terms):
        if isinstance(term.effect, Coupling):
            place = int(np.flatnonzero(owners == index)[0])
            transfers[place] = s * term.effect.noise_of_motion(term.shape, omega)
    spectra = np.stack(list(transfers.values()))
    weight = conditioning.source_power(omega) * smooth.sample_period / np.pi * np.exp(-((omega * smooth.width) ** 2))
    weight *= omega ** (2 * order) * (1.0 + (omega * moving) ** 2)
    places = list(transfers)
    step = omega[1] - omega[0]
    noise[np.ix_(places, places)] = step * ((spectra * weight) @ spectra.conj().T).real
    return noise


def cut_beforehand(step: float) -> tuple[float, float]:
    """Middle and variance of what may be cut off, nothing to half a step - N*m (N) -, before it is measured."""
    return 0.25 * step, (0.5 * step) ** 2 / 12.0


def rounding(rows: Rows, step: float, modelled: Array, cut: float) -> float:
    """RMS of what the last digit of an effort leaves in a residual, through the filter - N*m (N).

    Args:
        rows: the recording.
        step: of the digit - N*m (N); 0 where it does not matter.
        modelled: reported effort at the used rows - N*m (N) - (m,).
        cut: what was found to be cut off - N*m (N): from a quarter of a step on it was, below it was rounded.
    """
    if not step:
        return 0.0
    conditioning = rows.conditioning
    free = max(conditioning.effort_noise**2 - step**2 / 12.0, 0.0)
    followed = np.exp(-2.0 * np.pi**2 * free / step**2)
    whole = np.trunc if cut > 0.25 * step else np.round
    errors = []
    for part in rows.stretches:
        torque = np.interp(part.signals.time, rows.time, modelled + cut * np.sign(modelled))
        reported = step * whole(torque / step)
        (error,) = conditioning.filter(reported + cut * np.sign(reported) - torque, 0)
        errors.append(error[part.used])
    return float(followed) * rms(np.concatenate(errors))
