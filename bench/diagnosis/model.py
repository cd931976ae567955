"""The MuJoCo model of a fit, and the axis extended effect by effect: torque balance and model after each addition."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS
from bench.diagnosis.name import Suspects
from bench.effects.acting import RaisesFriction
from bench.effects.axis import Moment
from bench.effects.effect import Detected, Effect, Occasional
from bench.effects.present import Present
from bench.errors import InputError
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis
from bench.fit.rows import Rows
from bench.plant.axis_model import AxisModel, AxisParameters, winding_of
from bench.plant.model_file import Mounting, StoredModel
from bench.rig.rig import Rig

#: Bandwidth of the cascade by which a model tracks a recording - rad/s -, and the largest that a model may need. On the
#: shared cases the effects found reduce the gap by a median factor of 15 at 10, 16 at 20 and 14 at 40 rad/s; at 20 none
#: fails to track (docs/diagnose.md).
BANDWIDTH, MOST = 20.0, 100.0
#: Number of speeds at which the slope of friction is evaluated, and the lowest as share of the top speed.
SPEEDS, SLOWEST = 400, 1e-3


def stored_model(fitted: Fit, outside: Sequence[Present], rig: Rig) -> StoredModel:
    """The axis of a fit in MuJoCo, with effects outside the torque balance.

    Raises:
        InputError: MuJoCo cannot have the effects with these values, or no inertia.
    """
    inertia, viscous, coulomb = (fitted.value(term) for term in (INERTIA, VISCOUS, COULOMB))
    if inertia <= 0.0:
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
    model = AxisModel(base, (*present, *outside), fitted.scope.peak_effort, winding_of(rig))
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
class Stage:
    """The model after an addition.

    Attributes:
        effect: added last; empty for the bare axis.
        fitted: its torque balance.
        outside: effects outside the torque balance.
        rows: name of the rows it was fitted to.
        model: in MuJoCo; None if MuJoCo cannot simulate it.
        problem: why not; empty if it can.
    """

    effect: str
    fitted: Fit
    outside: tuple[Present, ...]
    rows: str
    model: StoredModel | None
    problem: str = ""

    def detected(self, suspects: Suspects) -> dict[Effect, Detected]:
        """Those of the suspects outside the torque balance that are in this model."""
        present = {one.effect for one in self.outside}
        return {effect: found for effect, found in suspects.detected.items() if effect in present}

    @classmethod
    def of(cls, effect: str, fitted: Fit, outside: Sequence[Present], rig: Rig, rows: str) -> Stage:
        """The model of a fit."""
        try:
            return cls(effect, fitted, tuple(outside), rows, stored_model(fitted, outside, rig))
        except InputError as error:
            return cls(effect, fitted, tuple(outside), rows, None, str(error))


@dataclass(frozen=True)
class Extension:
    """The bare axis, then with one effect after another: those of the torque balance, then the others.

    Attributes:
        recording: the rows that every balance is fitted to.
        rows: their name.
        hypothesis: all effects of the torque balance.
        outside: the others.
        rig: of the axis.
    """

    recording: Rows
    rows: str
    hypothesis: Hypothesis
    outside: tuple[Present, ...]
    rig: Rig

    @property
    def names(self) -> tuple[str, ...]:
        """Effects in the order in which they are added."""
        return (*self.hypothesis.names, *(present.name for present in self.outside))

    @cached_property
    def whole(self) -> Stage:
        """The model with all effects."""
        effect = self.names[-1] if self.names else ""
        return Stage.of(effect, fit(self.recording, self.hypothesis), self.outside, self.rig, self.rows)

    @cached_property
    def stages(self) -> tuple[Stage, ...]:
        """The model after none, one, ... all of the effects, each with the nuisances of the recording."""
        own, count = len(self.hypothesis.terms), len(self.names)
        parts = [replace(self, hypothesis=self.hypothesis.first(k), outside=()) for k in range(own)]
        parts += [replace(self, outside=self.outside[:k]) for k in range(len(self.outside))]
        return (*(part.whole for part in parts[:count]), self.whole)

    def less(self, index: int) -> Extension:
        """The same without one of its effects."""
        own = len(self.hypothesis.terms)
        if index < own:
            return replace(self, hypothesis=self.hypothesis.without(index))
        return replace(self, outside=(*self.outside[: index - own], *self.outside[index - own + 1 :]))

    def occasional(self, index: int) -> bool:
        """Whether an effect may occur in one recording and not in another."""
        terms = self.hypothesis.terms
        return index < len(terms) and isinstance(terms[index].effect, Occasional)
