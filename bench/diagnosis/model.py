"""The MuJoCo model of a fit, extended effect by effect, and its velocity gap along recordings and held-out motion.

The gap is recorded velocity less that of a model that tracks the recording with low gains.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import UnionType

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.diagnosis.recordings import Recordings
from bench.effects.effect import Contact, Detected, Effect, Occasional
from bench.effects.present import Present
from bench.effects.signals import AxisState
from bench.effects.torque import Friction
from bench.effects.waves import Wave
from bench.errors import InputError
from bench.fit.determined import INDEPENDENT_SHARE
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis, Term, lay_out
from bench.fit.rows import Rows
from bench.plant.axis_model import AxisModel, AxisParameters, winding_of
from bench.plant.model_file import Mounting, StoredModel
from bench.plant.tracking import SoftTracking, Tracked, track_all
from bench.rig.rig import Rig
from bench.trace.motion import in_stretches, measured_position, measured_velocity
from bench.trace.trace import Trace, less_known

#: Bandwidth of the cascade that tracks a recording - rad/s -, and the largest that a model may need (docs/diagnose.md).
BANDWIDTH, MOST = 20.0, 100.0
#: Phase from which on a wave of position out of phase has a larger residual than no wave, |exp(j*phase) - 1| > 1 - rad.
OUT_OF_PHASE = math.pi / 3.0
#: What acts by position: waves, and parts that meet.
Placed = Wave | Contact
#: Number of speeds at which the slope of friction is evaluated, and the lowest as share of the top speed.
SPEEDS, SLOWEST = 400, 1e-3
#: Names of fitted and of judging motion.
RECORDING, HOLDOUT = "recording", "holdout"
#: Share of a recording that is held out if there is no holdout recording.
HELD_OUT = 1.0 / 3.0
#: Blocks of moving rows, and least reaches of the filter in one: borders take 3 % of the rows at 1 kHz, 18 % at 48 Hz.
BLOCKS, REACHES = 24, 8
#: Ranges of speed, and of position, of equally many rows each.
RANGES = 3
#: Share of its largest torque above which an event acts on a row.
ACTS = 1e-3
#: Names of the motion that simulations may be fitted to and of judging motion, if both are of one recording.
REST, THIRD = "rest of the recording", "third of the recording that was held out"
#: What the velocities of every addition leave, to be shown: half the memory, and never summed.
Residual = NDArray[np.float32]


def stored_model(fitted: Fit, outside: Mapping[Effect, Detected], rig: Rig) -> StoredModel:
    """The axis of a fit in MuJoCo, with effects outside the torque balance.

    InputError where MuJoCo cannot have the effects with these values, or there is no inertia.
    """
    inertia, viscous, coulomb = (fitted.value(term) for term in (INERTIA, VISCOUS, COULOMB))
    if inertia <= mujoco.mjMINVAL:
        raise InputError(rig.source, f"found an inertia of {inertia:.3g}", "allowed: above zero")
    motor = rig.motor.rotor_inertia or rig.motor.moving_mass or 0.0
    coupling = fitted.hypothesis.coupling
    if coupling is not None:
        motor = inertia - fitted.strengths(coupling)[0]
    base = AxisParameters(inertia, max(viscous, 0.0), max(coulomb, 0.0), 0.0, min(motor, inertia), rig.axis_kind)
    present = [
        present_of(term.effect, term.effect.report(fitted.strengths(index), term.shape, fitted.base))
        for index, term in enumerate(fitted.terms)
    ]
    present += [Present.of(effect.name, found.values) for effect, found in outside.items()]
    model = AxisModel(base, tuple(present), fitted.scope.peak_effort, winding_of(rig))
    return StoredModel(rig.name, model, fitted.shift, Mounting.of(rig))


def present_of(effect: Effect, values: Mapping[str, float]) -> Present:
    """An effect with its quantities among the values; those that noise moved beyond a bound are set to it."""
    known = {quantity.name: quantity for quantity in effect.quantities}
    bounded = {key: float(np.clip(values[key], known[key].lower, known[key].upper)) for key in values if key in known}
    return Present.of(effect.name, bounded)


def tracking(stored: StoredModel, trace: Trace, rig: Rig, events: bool, inertia: float | None = None) -> SoftTracking:
    """A model and what drives it along a recording, in which its events occur or not; `inertia`: see `SoftTracking`."""
    model, own, driven = stored.model, rig.own_effort(trace)[0], rig.driven(trace)
    # the signal is late, the motion is not
    effort = driven - np.interp(trace.time - stored.misalignment, trace.time, driven - own)
    if not events:
        model = model.with_effects([each for each in model.effects if not isinstance(each.effect, Occasional)])
    return SoftTracking(model, trace, effort, stored.misalignment, inertia, own - less_known(trace, own))


def holding_bandwidth(model: AxisModel, top_speed: float) -> float:
    """Bandwidth of the cascade by which a model tracks a recording - rad/s.

    Where friction falls as speed rises by c - N*m*s/rad -, the held axis J*s**2 + (K_v + K_w - c)*s + K_i runs away
    from the recording unless K_v = J*w exceeds c - K_w: small errors grow where the axis under its own drive was
    stable. Then the model is held as firmly as that takes, up to the recording's top speed - rad/s (m/s).
    """
    speed = np.geomspace(SLOWEST, 1.0, SPEEDS) * max(top_speed, 1e-9)
    nothing = np.zeros_like(speed)
    level = model.parameters.viscous_friction_coefficient * speed
    for effect, values in model.acting(Friction):
        level = level + effect.friction(values, model.axis, AxisState(0.0, nothing, speed, nothing))
    fall = max(0.0, -float(np.min(np.diff(level) / np.diff(speed))))
    return float(np.clip(fall / model.parameters.inertia, BANDWIDTH, MOST))


@dataclass(frozen=True)
class Extension:
    """The bare axis with effects: those of the torque balance, then the others.

    Attributes:
        recording: the rows that the balance is fitted to.
        hypothesis: effects of the torque balance.
        outside: the others, as the signals show them.
        rig: of the axis.
        start: a fit of these effects, from whose strengths that of the balance starts.
        refused: why its inertia is not determined, so that it has no model; empty if it is.
    """

    recording: Rows
    hypothesis: Hypothesis
    outside: Mapping[Effect, Detected]
    rig: Rig
    start: Fit | None = None
    refused: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Effects in the order in which they are added."""
        return (*self.hypothesis.names, *(effect.name for effect in self.outside))

    @cached_property
    def fitted(self) -> Fit:
        """Its torque balance."""
        return fit(self.recording, self.hypothesis, self.start)

    @cached_property
    def _simulated(self) -> tuple[StoredModel | None, str]:
        if self.refused:
            return None, self.refused
        try:
            return stored_model(self.fitted, self.outside, self.rig), ""
        except InputError as error:
            return None, str(error)

    @property
    def model(self) -> StoredModel | None:
        """In MuJoCo; None if MuJoCo cannot simulate it."""
        return self._simulated[0]

    @property
    def problem(self) -> str:
        """Why MuJoCo cannot simulate it; empty if it can."""
        return self._simulated[1]

    @cached_property
    def stages(self) -> tuple[Extension, ...]:
        """With none, one, ... all of the effects, each with the nuisances of the recording."""
        own, terms, others = self.hypothesis, self.hypothesis.terms, [*self.outside.items()]
        parts = [replace(self, hypothesis=own.with_terms(terms[:k]), outside={}) for k in range(len(terms))]
        return (*parts, *(replace(self, outside=dict(others[:k])) for k in range(len(others))), self)

    def less(self, index: int) -> Extension:
        """The same without one of its effects."""
        own = len(self.hypothesis.terms)
        if index < own:
            return replace(self, hypothesis=self.hypothesis.without(index))
        others = [*self.outside.items()]
        return replace(self, outside=dict([*others[: index - own], *others[index - own + 1 :]]))

    def a(self, kind: type[Effect] | UnionType, index: int) -> bool:
        """Whether an effect of the torque balance is of a kind."""
        terms = self.hypothesis.terms
        return index < len(terms) and isinstance(terms[index].effect, kind)


@dataclass(frozen=True)
class Recorded:
    """A recording for models to track.

    Attributes:
        name: of it.
        trace: the recording.
        rig: of the axis.
        over: (n,) samples over which the gap is taken, as far as they are in stretches without holes.
        events: whether the model's events occur in it.
    """

    name: str
    trace: Trace
    rig: Rig
    over: NDArray[np.bool_] | bool = True
    events: bool = True

    @cached_property
    def judged(self) -> NDArray[np.bool_]:
        """(n,) samples over which the gap is taken."""
        return in_stretches(self.trace) & self.over

    def difference(self, simulated: Array) -> Array:
        """Simulated less measured velocity at the judged samples - rad/s (m/s)."""
        return (simulated - measured_velocity(self.trace))[self.judged]

    def drift(self, simulated: Array) -> float:
        """RMS of simulated less measured position at the judged samples - rad (m)."""
        return rms((simulated - measured_position(self.trace))[self.judged])

    def gap(self, simulated: Array | None) -> float:
        """RMS of measured less simulated velocity at the judged samples - rad/s (m/s); nan where there is none."""
        return math.nan if simulated is None else rms(self.difference(simulated))

    @property
    def varies(self) -> float:
        """Standard deviation of the measured velocity: a larger gap means no tracking at all - rad/s (m/s)."""
        return float(np.std(measured_velocity(self.trace)[self.judged]))


def keeps_phase(terms: Iterable[Term], drift: float) -> bool:
    """Whether what terms have over position acts where the axis has it, at a drift of position - rad (m)."""
    numbers = (term.effect.wave_number(term.shape) for term in terms if isinstance(term.effect, Placed))
    return not max(numbers, default=0.0) * drift > OUT_OF_PHASE


class VelocityGaps:
    """Velocity gaps of models along recordings, each simulated once, over whatever part of a recording they are taken.

    Args:
        bandwidth: of the tracking cascade - rad/s.
        inertia: for which the cascade is designed, each model's own if None - kg*m**2 (kg).
    """

    def __init__(self, bandwidth: float, inertia: float | None) -> None:
        self.bandwidth, self.inertia = bandwidth, inertia
        self._known: dict[tuple[StoredModel | None, int, bool], Tracked | None] = {}

    def simulate(self, pairs: Iterable[tuple[Extension, Recorded]]) -> None:
        """Simulate models along recordings in parallel, unless done before."""
        self._tracked((extension.model, recorded) for extension, recorded in pairs)

    def of(self, extension: Extension, recorded: Recorded) -> float:
        """RMS of measured less simulated velocity - rad/s (m/s); nan without a model, or where it diverged."""
        return recorded.gap(*self.velocities([extension.model], recorded))

    def residual(self, model: StoredModel | None, recorded: Recorded) -> Residual | None:
        """Measured less simulated velocity along a recording; None without a model, or where it diverged."""
        (simulated,) = self.velocities([model], recorded)
        return None if simulated is None else (measured_velocity(recorded.trace) - simulated).astype(np.float32)

    def in_phase(self, extension: Extension, recorded: Recorded) -> bool:
        """Whether what a model has over position acts where the axis has it, as far as there is a simulation."""
        placed = [term for term in extension.fitted.terms if isinstance(term.effect, Placed)]
        (tracked,) = self._tracked([(extension.model, recorded)]) if placed else (None,)
        return tracked is None or keeps_phase(placed, recorded.drift(tracked.position))

    def velocities(self, models: Iterable[StoredModel | None], recorded: Recorded) -> list[Array | None]:
        """Of models along a recording, (n,) each - rad/s (m/s); None without one, or where it diverged."""
        return [None if one is None else one.velocity for one in self._tracked((model, recorded) for model in models)]

    def _tracked(self, pairs: Iterable[tuple[StoredModel | None, Recorded]]) -> list[Tracked | None]:
        asked = [(model, one, (model, id(one.trace), one.events)) for model, one in pairs]
        new = {
            key: tracking(model, one.trace, one.rig, one.events, self.inertia)
            for model, one, key in asked
            if model is not None and key not in self._known
        }
        self._known |= zip(new, track_all(list(new.values()), self.bandwidth), strict=True)
        return [self._known.get(key) for _, _, key in asked]


@dataclass(frozen=True)
class HeldOut:
    """Motion by which additions are judged and that no judged fit uses: a holdout, or a third of the recording.

    Cut by time, a third may go one way where the rest goes the other: an axis may stand for half a recording. So the
    moving rows are cut into blocks, each longer than the filter and what it correlates, and a block is held out if that
    brings the part nearer to a third of each regime: in each direction of slow, middle and fast rows, and of those at
    low, middle and high positions (minimisation: S. J. Pocock, R. Simon, Biometrics 31, 1975, 103-115). Rows within the
    filter's reach of a border are in neither part. A part judges only what it determines.

    Attributes:
        fitted: rows that judged fits use.
        judge: rows they are judged by.
        recorded: the same for simulations.
        seen: motion that simulations may be fitted to.
    """

    fitted: Rows
    judge: Rows
    recorded: Recorded
    seen: Recorded

    @classmethod
    def of(cls, recordings: Recordings, trusted: bool, events: bool, whole: Fit) -> HeldOut:
        """A holdout that is `trusted` to be of this axis, with the recording's events or not; else a third.

        Events of a fit to the `whole` recording stay in the rest where that would lack one: of arbitrary size there, it
        would judge all else.
        """
        trace, rig, rows = recordings.trace, recordings.rig, recordings.rows
        if recordings.holdout is not None and recordings.holdout_rows is not None and trusted:
            recorded = Recorded(HOLDOUT, recordings.holdout, rig, events=events)
            return cls(rows, recordings.holdout_rows, recorded, Recorded(RECORDING, trace, rig))
        plain = cls.third(recordings)
        events_of = [k for k, term in enumerate(whole.terms) if isinstance(term.effect, Occasional)]
        lacked = [k for k in events_of if plain.lacks(whole, k)]
        if not lacked:
            return plain
        acts = np.abs(lay_out(rows, whole.hypothesis, whole.found).columns[:, np.isin(whole.owners, lacked)])
        return cls.third(recordings, np.any(acts > ACTS * acts.max(axis=0), axis=1))

    @classmethod
    def third(cls, recordings: Recordings, kept: NDArray[np.bool_] | bool = False) -> HeldOut:
        """A third of every regime, in no block with one of the rows `kept` (m,), judges a fit to the rest."""
        trace, rig, rows = recordings.trace, recordings.rig, recordings.rows
        smooth, count = rows.conditioning.filter, rows.effort.size
        shortest = REACHES * smooth.margin // smooth.stride
        edges = np.linspace(0, count, int(np.clip(count // shortest, 3, BLOCKS)) + 1).astype(int)
        shown = np.add.reduceat(regimes(rows), edges[:-1], axis=0)
        free = ~np.logical_or.reduceat(np.broadcast_to(kept, count), edges[:-1])
        borders, out, reach = rows.time[edges[1:-1]], balanced(shown, free), smooth.margin * smooth.sample_period

        def held(time: Array) -> NDArray[np.bool_]:
            return out[np.searchsorted(borders, time, side="right")]

        def apart(part: bool) -> Rows:
            """Rows of one part, over all of the filter's reach."""
            reaches = (-reach, 0.0, reach)
            return rows.selected(lambda time: np.all([held(time + ahead) == part for ahead in reaches], axis=0))

        judging = held(trace.time - trace.time[0])
        recorded, seen = Recorded(THIRD, trace, rig, judging), Recorded(REST, trace, rig, ~judging)
        return cls(apart(False), apart(True), recorded, seen)

    def lacks(self, whole: Fit, index: int) -> bool:
        """Whether the fitted rows do not determine the strengths of a term of a fit to the recording."""
        own, columns = whole.owners == index, lay_out(self.fitted, whole.hypothesis, whole.found).columns
        return not _information(columns, own) > INDEPENDENT_SHARE * _information(whole.columns, own)

    def determines(self, judged: Fit, whole: Fit, index: int) -> bool:
        """Whether fitted and judging rows both determine the strengths of a term that have a column.

        By fits to the fitted rows and to the whole recording; compared with that a part may be ten times as uncertain.
        """
        own = whole.owners == index
        if not own.any():
            return True
        least = INDEPENDENT_SHARE * _information(whole.columns, own)
        parts = judged.columns, lay_out(self.judge, judged.hypothesis, judged.found).columns
        return all(_information(columns, own) > least for columns in parts)


def _information(columns: Array, own: NDArray[np.bool_]) -> float:
    """Least information of columns (m, p) about a combination of some of them given the others, in its noise power."""
    others = np.linalg.qr(columns[:, ~own])[0]
    left = columns[:, own] - others @ (others.T @ columns[:, own])
    return float(np.linalg.eigvalsh(left.T @ left)[0])


def regimes(rows: Rows) -> Array:
    """1 where a row is of a regime, else 0 (m, r): ranges of speed, and of position, in each direction."""
    forward = rows.values(lambda s: s.sign) > 0.0
    found = []
    for values in (np.abs(rows.values(lambda s: s.velocity)), rows.values(lambda s: s.position)):
        limits = np.quantile(values, np.arange(1, RANGES) / RANGES)
        found.append(np.searchsorted(limits, values) + RANGES * forward == np.arange(2 * RANGES)[:, None])
    return np.concatenate(found).T.astype(float)


def balanced(shown: Array, free: NDArray[np.bool_] | bool = True) -> NDArray[np.bool_]:
    """Which of the blocks that are `free` (b,) are held out, by how many rows of each regime each shows (b, r)."""
    lacks, out = np.zeros(shown.shape[1]), np.array(np.broadcast_to(free, shown.shape[0]))
    for block, own in enumerate(shown):
        lacks = lacks + HELD_OUT * own
        out[block] &= 2.0 * own @ lacks > own @ own  # it brings the part nearer to its third
        lacks = lacks - out[block] * own
    return out
