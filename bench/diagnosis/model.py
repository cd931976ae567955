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
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS
from bench.effects.acting import RaisesFriction
from bench.effects.effect import Contact, Detected, Effect, Occasional
from bench.effects.present import Present
from bench.effects.signals import Moment
from bench.effects.waves import Wave
from bench.errors import InputError
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis
from bench.fit.rows import Rows
from bench.plant.axis_model import AxisModel, AxisParameters, winding_of
from bench.plant.model_file import Mounting, StoredModel
from bench.plant.tracking import SoftTracking, Tracked, track_all
from bench.rig.rig import Rig
from bench.trace.motion import in_stretches, measured_position, measured_velocity
from bench.trace.trace import Trace, less_known

#: Bandwidth of the cascade by which a model tracks a recording - rad/s -, and the largest that a model may need. On the
#: shared cases the effects found reduce the gap by a median factor of 15 at 10, 16 at 20 and 14 at 40 rad/s; at 20 none
#: fails to track (docs/diagnose.md).
BANDWIDTH, MOST = 20.0, 100.0
#: Phase from which on a wave of position out of phase leaves more torque than no wave, |exp(j*phase) - 1| > 1 - rad.
OUT_OF_PHASE = math.pi / 3.0
#: What acts where the position says: waves, and parts that meet.
Placed = Wave | Contact
#: Number of speeds at which the slope of friction is evaluated, and the lowest as share of the top speed.
SPEEDS, SLOWEST = 400, 1e-3
#: Names of fitted and of judging motion.
RECORDING, HOLDOUT = "recording", "holdout"
#: What the velocities of every addition leave, to be shown: half the memory, and never summed.
Residual = NDArray[np.float32]


def stored_model(fitted: Fit, outside: Mapping[Effect, Detected], rig: Rig) -> StoredModel:
    """The axis of a fit in MuJoCo, with effects outside the torque balance.

    Raises:
        InputError: MuJoCo cannot have the effects with these values, or no inertia.
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
    return StoredModel(rig.name, model, fitted.value(MISALIGNMENT), Mounting.of(rig))


def present_of(effect: Effect, values: Mapping[str, float]) -> Present:
    """An effect with its quantities among the values; those that noise moved beyond a bound are set to it."""
    known = {quantity.name: quantity for quantity in effect.quantities}
    bounded = {key: float(np.clip(values[key], known[key].lower, known[key].upper)) for key in values if key in known}
    return Present.of(effect.name, bounded)


def without_events(model: AxisModel) -> AxisModel:
    """The axis in a recording without its events."""
    return model.with_effects([present for present in model.effects if not isinstance(present.effect, Occasional)])


def holding_bandwidth(model: AxisModel, top_speed: float) -> float:
    """Bandwidth of the cascade by which a model tracks a recording - rad/s.

    Where friction falls as speed rises by c - N*m*s/rad -, the held axis J*s**2 + (K_v + K_w - c)*s + K_i runs away
    from the recording unless K_v = J*w exceeds c - K_w: small errors grow where the axis under its own drive was
    stable. Then the model is held as firmly as that takes, up to the recording's top speed - rad/s (m/s).
    """
    speed = np.geomspace(SLOWEST, 1.0, SPEEDS) * max(top_speed, 1e-9)
    nothing = np.zeros_like(speed)
    level = model.parameters.viscous_friction_coefficient * speed
    for effect, values in model.acting(RaisesFriction):
        level = level + effect.friction_excess(values, model.axis, Moment(0.0, nothing, speed, nothing))
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
        refused: why its inertia is not determined, so that it has no model; empty if it is.
    """

    recording: Rows
    hypothesis: Hypothesis
    outside: Mapping[Effect, Detected]
    rig: Rig
    refused: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Effects in the order in which they are added."""
        return (*self.hypothesis.names, *(effect.name for effect in self.outside))

    @cached_property
    def fitted(self) -> Fit:
        """Its torque balance."""
        return fit(self.recording, self.hypothesis)

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
        parts = [
            replace(self, hypothesis=self.hypothesis.first(k), outside={}) for k in range(len(self.hypothesis.terms))
        ]
        others = [*self.outside.items()]
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
        placed = ((term.effect, term.shape) for term in extension.fitted.terms)
        numbers = [effect.wave_number(shape) for effect, shape in placed if isinstance(effect, Placed)]
        (tracked,) = self._tracked([(extension.model, recorded)]) if numbers else (None,)
        return tracked is None or not max(numbers) * recorded.drift(tracked.position) > OUT_OF_PHASE

    def velocities(self, models: Iterable[StoredModel | None], recorded: Recorded) -> list[Array | None]:
        """Of models along a recording, (n,) each - rad/s (m/s); None without one, or where it diverged."""
        return [None if one is None else one.velocity for one in self._tracked((model, recorded) for model in models)]

    def _tracked(self, pairs: Iterable[tuple[StoredModel | None, Recorded]]) -> list[Tracked | None]:
        asked = [(model, one, (model, id(one.trace), one.events)) for model, one in pairs]
        new = {
            key: self._holding(model, one) for model, one, key in asked if model is not None and key not in self._known
        }
        self._known |= zip(new, track_all(list(new.values()), self.bandwidth), strict=True)
        return [self._known.get(key) for _, _, key in asked]

    def _holding(self, stored: StoredModel, recorded: Recorded) -> SoftTracking:
        model = stored.model if recorded.events else without_events(stored.model)
        effort = recorded.rig.own_effort(recorded.trace)[0]
        known = effort - less_known(recorded.trace, effort)
        return SoftTracking(model, recorded.trace, effort, stored.misalignment, self.inertia, known)
