"""A model grown effect by effect: the torque balance and the MuJoCo model after each addition."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from bench.diagnose.added import stored_model
from bench.diagnose.balance import Balance
from bench.diagnose.fit import Fit, fit
from bench.diagnose.hypothesis import Hypothesis
from bench.diagnose.workbench import Workbench
from bench.effects.present import Present
from bench.errors import InputError
from bench.plant.model_file import StoredModel
from bench.rig.rig import Rig


@dataclass(frozen=True)
class Grown:
    """A model at one point of its growth.

    Attributes:
        effect: added last; empty for the bare axis.
        fitted: its torque balance.
        beside: effects that the torque balance does not hold.
        rows: what it was fitted to.
        model: in MuJoCo; None where MuJoCo cannot have it.
        problem: why not; empty where it can.
    """

    effect: str
    fitted: Fit
    beside: tuple[Present, ...]
    rows: str
    model: StoredModel | None
    problem: str = ""

    @classmethod
    def of(cls, effect: str, fitted: Fit, beside: Sequence[Present], rig: Rig, rows: str) -> Grown:
        """The model of a fit."""
        try:
            return cls(effect, fitted, tuple(beside), rows, stored_model(fitted, beside, rig))
        except InputError as error:
            return cls(effect, fitted, tuple(beside), rows, None, str(error))


@dataclass(frozen=True)
class Chain:
    """The bare axis, then with each effect added in turn: those of the torque balance, then those beside it.

    Attributes:
        bench: the rows that every balance is fitted to.
        rows: their name.
        hypothesis: all effects of the torque balance.
        beside: the others.
        rig: of the axis.
    """

    bench: Workbench
    rows: str
    hypothesis: Hypothesis
    beside: tuple[Present, ...]
    rig: Rig

    @property
    def names(self) -> tuple[str, ...]:
        """Effects in the order in which they are added."""
        return (*self.hypothesis.names, *(present.name for present in self.beside))

    @cached_property
    def whole(self) -> Grown:
        """The model with all effects."""
        effect = self.names[-1] if self.names else ""
        return Grown.of(effect, fit(self.bench, self.hypothesis), self.beside, self.rig, self.rows)

    @cached_property
    def grown(self) -> tuple[Grown, ...]:
        """The model after none, one, ... all of the effects."""
        effects, count = self.hypothesis.effects, len(self.names)
        parts = [replace(self, hypothesis=Hypothesis(effects[:k]), beside=()) for k in range(len(effects))]
        parts += [replace(self, beside=self.beside[:k]) for k in range(len(self.beside))]
        return (*(part.whole for part in parts[:count]), self.whole)

    def less(self, index: int) -> Chain:
        """The chain without one of its effects."""
        own = len(self.hypothesis.effects)
        if index < own:
            return replace(self, hypothesis=self.hypothesis.without(index))
        return replace(self, beside=(*self.beside[: index - own], *self.beside[index - own + 1 :]))

    def balance(self, events: bool) -> Balance:
        """Torque balance of the whole; `events`: whether its events happen in every recording."""
        return Balance.of(self.bench, self.whole.fitted).repeating(events)
