"""The axis extended effect by effect: the torque balance and the MuJoCo model after each addition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from bench.diagnosis.add.model import stored_model
from bench.diagnosis.name.name import Suspects
from bench.effects.effect import Detected, Effect
from bench.effects.present import Present
from bench.errors import InputError
from bench.fit.fit import Fit, fit
from bench.fit.hypothesis import Hypothesis
from bench.fit.rows import Rows
from bench.fit.stored import Balance
from bench.plant.model_file import StoredModel
from bench.rig.rig import Rig


@dataclass(frozen=True)
class Stage:
    """The model after an addition.

    Attributes:
        effect: added last; empty for the bare axis.
        fitted: its torque balance.
        beside: effects outside the torque balance.
        rows: name of the rows it was fitted to.
        model: in MuJoCo; None if MuJoCo cannot simulate it.
        problem: why not; empty if it can.
    """

    effect: str
    fitted: Fit
    beside: tuple[Present, ...]
    rows: str
    model: StoredModel | None
    problem: str = ""

    def detected(self, suspects: Suspects) -> dict[Effect, Detected]:
        """Those of the suspects outside the torque balance that are in this model."""
        present = {one.effect for one in self.beside}
        return {effect: found for effect, found in suspects.detected.items() if effect in present}

    @classmethod
    def of(cls, effect: str, fitted: Fit, beside: Sequence[Present], rig: Rig, rows: str) -> Stage:
        """The model of a fit."""
        try:
            return cls(effect, fitted, tuple(beside), rows, stored_model(fitted, beside, rig))
        except InputError as error:
            return cls(effect, fitted, tuple(beside), rows, None, str(error))


@dataclass(frozen=True)
class Extension:
    """The bare axis, then with one effect after another: those of the torque balance, then the others.

    Attributes:
        recording: the rows that every balance is fitted to.
        rows: their name.
        hypothesis: all effects of the torque balance.
        beside: the others.
        rig: of the axis.
    """

    recording: Rows
    rows: str
    hypothesis: Hypothesis
    beside: tuple[Present, ...]
    rig: Rig

    @property
    def names(self) -> tuple[str, ...]:
        """Effects in the order in which they are added."""
        return (*self.hypothesis.names, *(present.name for present in self.beside))

    @cached_property
    def whole(self) -> Stage:
        """The model with all effects."""
        effect = self.names[-1] if self.names else ""
        return Stage.of(effect, fit(self.recording, self.hypothesis), self.beside, self.rig, self.rows)

    @cached_property
    def stages(self) -> tuple[Stage, ...]:
        """The model after none, one, ... all of the effects, each with the nuisances of the recording."""
        own, count = len(self.hypothesis.terms), len(self.names)
        parts = [replace(self, hypothesis=self.hypothesis.first(k), beside=()) for k in range(own)]
        parts += [replace(self, beside=self.beside[:k]) for k in range(len(self.beside))]
        return (*(part.whole for part in parts[:count]), self.whole)

    def less(self, index: int) -> Extension:
        """The same without one of its effects."""
        own = len(self.hypothesis.terms)
        if index < own:
            return replace(self, hypothesis=self.hypothesis.without(index))
        return replace(self, beside=(*self.beside[: index - own], *self.beside[index - own + 1 :]))

    def occasional(self, index: int) -> bool:
        """Whether an effect may occur in one recording and not in another."""
        return index < len(self.hypothesis.terms) and self.hypothesis.terms[index].effect.occasional

    def balance(self, events: bool) -> Balance:
        """Torque balance with all effects; `events`: whether its events occur in every recording."""
        return Balance.of(self.whole.fitted).repeating(events)
