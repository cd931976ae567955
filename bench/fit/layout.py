"""Columns of a hypothesis: the recording as it sees it, laid out for least squares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS
from bench.effects.acting import FollowsLoad
from bench.effects.effect import Columns, Coupling, Distortion, EffortLag, Load, MotionLag
from bench.effects.signals import Signals
from bench.fit.hypothesis import Hypothesis, Term
from bench.fit.interplay import loads_of, with_friction, with_load
from bench.fit.last_digit import cut_off
from bench.fit.rows import Rows, known_of
from bench.trace.filter import Column

#: Names of columns that belong to no effect: of the axis and the shift of torque against speed, and what else a
#: recording has - sines and cosines of the mains, what the last digit of the effort cuts off. Those of an effect are
#: named by the index of its term.
BASE = (INERTIA, VISCOUS, COULOMB, MISALIGNMENT)
HUM, DIGIT = "hum", "last digit"
#: Frequencies at which noise is summed, up to REACH over the filter's width, where it passes 1e-7 of the power.
FREQUENCIES, REACH = 400, 4.0


@dataclass(frozen=True)
class Layout:
    """A hypothesis in columns.

    Attributes:
        columns: (m, p): J, K_w, K_0, misalignment, the effort's last digit where it matters, sines and cosines of hum,
            then the effects' in order.
        owners: (p,) index of the term a column belongs to, or one of the names of BASE, DIGIT or HUM.
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


def lay_out(rows: Rows, hypothesis: Hypothesis) -> Layout:
    """Columns of a hypothesis."""
    seen, (moving, resting) = seen_by(rows, hypothesis), delays(rows, hypothesis)
    made_of, late = _made_of(rows, hypothesis), effort_lag(hypothesis)
    order = 1 if rows.conditioning.source == "position" else 0

    def motion(signals: Signals) -> list[Column]:
        values = getattr(signals, rows.conditioning.source)
        return [[(values, order + 1)], [(values, order)]]

    parts = [
        rows.memory.get(("motion", *made_of), lambda: seen.table(motion, moving, of_signals=True)),
        rows.memory.get(("sign", *made_of), lambda: seen.table(lambda s: [[(s.sign, 0)]], resting, of_signals=True)),
        -rows.memory.get(
            ("rate", late, *made_of),
            lambda: seen.table(lambda s: [[(s.effort, 1)]], resting + late, of_signals=True),
        ),
    ]
    owners: list[str | int] = [*BASE]
    bounds = {owners.index(MISALIGNMENT): (-rows.scope.latched, rows.scope.latched)}
    if hypothesis.step:
        parts.append(rows.memory.get(("digit", resting, *made_of), lambda: seen.table(cut_off, resting)))
        bounds[len(owners)] = (0.0, 0.5 * hypothesis.step)
        owners.append(DIGIT)
    if hypothesis.hum:
        made = ("hum", hypothesis.hum, resting)
        parts.append(rows.memory.get(made, lambda: seen.table(lambda s: _hum(s, hypothesis.hum, rows.starts), resting)))
        owners += [HUM] * 2 * len(hypothesis.hum) * len(rows.starts)
    for index in range(len(hypothesis.terms)):
        table = term_columns(rows, seen, hypothesis, index)
        parts.append(table)
        effect = hypothesis.terms[index].effect
        if isinstance(effect, Columns):
            bounds |= {len(owners) + place: most for place, most in effect.bounded.items()}
        owners += [index] * table.shape[1]
    columns = np.concatenate(parts, axis=1)
    held_by = np.array(owners, dtype=object)
    effort = seen.effort
    if late:
        effort = rows.memory.get(
            ("effort", late, *made_of), lambda: seen.table(lambda s: [[(s.effort, 0)]], late)[:, 0]
        )
    if moving or late:
        effort = effort - rows.memory.get(("known", late, *made_of), lambda: _known(seen, moving, late))
    return Layout(columns, held_by, effort, _noise(rows, hypothesis, held_by, moving), bounds)


def _known(seen: Rows, moving: float, late: float) -> Array:
    """What more is known to act (m,) - N*m (N): as the motion tells it, whose lag is undone; all of it of an effort
    that was made anew.
    """
    if not seen.stretches[0].signals.known:
        return np.zeros(seen.effort.size)
    known = seen.table(known_of, moving)[:, 0]
    return known if late else known - seen.table(known_of)[:, 0]


def term_columns(rows: Rows, seen: Rows, hypothesis: Hypothesis, index: int) -> Array:
    """Columns (m, k) of one term; none of one that only changes how the recording is seen."""
    term = hypothesis.terms[index]
    friction = with_friction(seen, hypothesis, index)
    if isinstance(term.effect, FollowsLoad):
        friction = with_load(friction, ((other, other.pull) for other in hypothesis.terms))
    couples = isinstance(term.effect, Coupling)
    loads = loads_of(hypothesis) if couples else ()
    lag = delays(rows, hypothesis)[0 if couples else 1]
    if loads or friction is not seen:
        return filtered(friction, term, loads, lag)
    return rows.memory.get((term.key, *_made_of(rows, hypothesis)), lambda: filtered(seen, term, loads, lag))


def filtered(seen: Rows, term: Term, loads: tuple[Load, ...], lag: float) -> Array:
    """Columns (m, k) of a term in a recording as it is seen.

    What follows the motion behind a coupling is integrated at length, and only once where nothing but a lag differs.
    """
    effect = term.effect
    if not isinstance(effect, Columns):
        return np.empty((seen.effort.size, 0))
    if not isinstance(effect, Coupling):
        return seen.table(lambda s: effect.columns(s, term.shape), lag)
    if loads:
        return seen.table(lambda s: effect.columns_of(s, [term.shape], loads), lag)

    def kept(signals: Signals) -> Sequence[Column]:
        made_of = ("raw", term.key, seen.motion, signals.began, float(signals.time[0]))
        return seen.memory.columns(made_of, lambda: effect.columns_of(signals, [term.shape]))

    return seen.table(kept, lag)


def _hum(signals: Signals, lines: tuple[float, ...], starts: tuple[float, ...]) -> list[Column]:
    """Sine and cosine of every line in every recording: no two of them start at the same phase of the mains."""
    angles = [2.0 * np.pi * line * signals.time for line in lines]
    waves = [wave(angle) for angle in angles for wave in (np.sin, np.cos)]
    return [[(values if start == signals.began else np.zeros_like(values), 0)] for start in starts for values in waves]


def _made_of(rows: Rows, hypothesis: Hypothesis) -> tuple[object, ...]:
    seen = tuple(sorted(term.key for term in hypothesis.terms if isinstance(term.effect, Distortion)))
    return *delays(rows, hypothesis), seen


def _noise(rows: Rows, hypothesis: Hypothesis, owners: NDArray[np.object_], moving: float) -> Array:
    """Covariance (p, p) of what the sensors' white noise makes of the columns.

    A smoothed signal and its derivative are uncorrelated, as G is even and omega*G odd; what follows the motion behind
    a coupling is not uncorrelated with the motor's acceleration: its transfer says how far it hears the same noise.
    """
    conditioning = rows.conditioning
    smooth, order = conditioning.filter, conditioning.order
    noise = np.zeros((owners.size, owners.size))
    hearing = smooth.noise_gain(1) ** 2 + (effort_lag(hypothesis) * smooth.noise_gain(2)) ** 2
    noise[BASE.index(MISALIGNMENT), BASE.index(MISALIGNMENT)] = conditioning.effort_noise**2 * hearing
    omega = np.linspace(0.0, REACH / smooth.width, FREQUENCIES)
    accelerated = (1j * omega) ** (order + 1) * (1.0 + 1j * omega * moving)
    turned = (1j * omega) ** order * (1.0 + 1j * omega * moving)
    heard = {BASE.index(INERTIA): accelerated, BASE.index(VISCOUS): turned}
    for index, term in enumerate(hypothesis.terms):
        if isinstance(term.effect, Coupling):
            place = int(np.flatnonzero(owners == index)[0])
            heard[place] = accelerated * term.effect.noise_of_motion(term.shape, omega)
    spectra = np.stack(list(heard.values()))
    weight = conditioning.source_power(omega) * smooth.sample_period / np.pi * np.exp(-((omega * smooth.width) ** 2))
    places = list(heard)
    step = omega[1] - omega[0]
    noise[np.ix_(places, places)] = step * ((spectra * weight) @ spectra.conj().T).real
    return noise
