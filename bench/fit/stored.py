"""The torque balance of a diagnosed model along any recording, which is held against the measured torque."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, Field, FiniteFloat, ValidationError

from bench.arrays import Array, rms
from bench.effects.effect import Occasional
from bench.effects.present import named
from bench.errors import InputError
from bench.fit.fit import ROUNDS, Fit
from bench.fit.hypothesis import AROUND, HUM, Hypothesis, Layout, Term, depended_on, lay_out, not_reaching
from bench.fit.rows import Rows
from bench.plant.model_file import LARGEST_VALUE
from bench.validated import input_error

#: Placeholder for a recording where an event comes at the same time of every one.
EVERY = "every recording"


@dataclass(frozen=True)
class Balance:
    """A fitted torque balance, ready for other recordings of the axis.

    Attributes:
        hypothesis: its effects and their shapes.
        theta: (p,) J, K_w, K_0, misalignment, last digit, strengths.
        width: of the filter it was fitted through - s.
        recording: the one it was fitted to; what is occasional happened in it and in no other, unless EVERY.
    """

    hypothesis: Hypothesis
    theta: Array
    width: float
    recording: str

    @classmethod
    def of(cls, fitted: Fit) -> Balance:
        """Balance of a fit; without mains lines where it is of several recordings, as each had its own phase of it."""
        width, origin = fitted.rows.conditioning.filter.width, fitted.rows.origin
        if len(fitted.rows.starts) == 1:
            return cls(fitted.hypothesis, fitted.theta, width, origin)
        return cls(replace(fitted.hypothesis, hum=()), fitted.theta[fitted.owners != HUM], width, origin)

    def repeating(self, events: bool) -> Balance:
        """The same with its events in every recording, if they happen in every one."""
        return replace(self, recording=EVERY) if events else self

    def left(self, rows: Rows) -> Array:
        """Measured less modelled torque at the used rows of a recording - N*m (N) - (m,)."""
        layout = self.laid(rows)
        theta = self.theta.copy()
        if self.recording != rows.origin:
            theta[np.isin(layout.owners, (AROUND, HUM))] = 0.0
        if self.recording not in (EVERY, rows.origin):
            theta[np.isin(layout.owners, self.hypothesis.of_kind(Occasional))] = 0.0
        for _ in range(ROUNDS):
            if not (missing := not_reaching(self.hypothesis, layout, theta)):
                break
            layout = lay_out(rows, self.hypothesis, layout.by_name(self.theta), missing)
        return layout.left(theta)

    def laid(self, rows: Rows) -> Layout:
        """Its columns in a recording."""
        layout = lay_out(rows, self.hypothesis)
        found = layout.by_name(self.theta)
        return lay_out(rows, self.hypothesis, found) if depended_on(self.hypothesis, found) else layout

    def gap(self, rows: Rows) -> float:
        """RMS of measured less modelled torque along a recording - N*m (N)."""
        return rms(self.left(rows))

    def table(self) -> dict[str, Any]:
        """The table `torque_balance` of a `model.toml`: the model as coefficients, for `bench replay`; SI."""
        own, effects = self.hypothesis, [_Effect.of(term) for term in self.hypothesis.terms]
        return _Table(
            recording=self.recording,
            filter_width=self.width,
            mains=[*own.hum],
            effort_step=own.step,
            shift=own.shift,
            misplaced=own.misplaced,
            coefficients=self.theta.tolist(),
            effects=effects,
        ).model_dump()

    @classmethod
    def from_table(cls, tables: Mapping[str, Any], path: object) -> Balance:
        """Balance of what `table` gave, among the tables of a file; InputError where it is not there, or wrong."""
        if "torque_balance" not in tables:
            raise InputError(f"{path}: torque_balance", "missing", "allowed: a model.toml that bench diagnose wrote")
        try:
            found = _File.model_validate(tables).torque_balance
        except ValidationError as error:
            raise input_error(path, error) from error
        terms = tuple(one.term(f"{path}: torque_balance.effects") for one in found.effects)
        hypothesis = Hypothesis(terms, tuple(found.mains), found.effort_step, found.shift, found.misplaced)
        return cls(hypothesis, np.array(found.coefficients), found.filter_width, found.recording)


class _Effect(BaseModel):
    """A term of a balance in the file."""

    name: str
    shape: list[FiniteFloat]
    on_load: bool
    around: list[FiniteFloat]

    @classmethod
    def of(cls, term: Term) -> _Effect:
        return cls(name=term.effect.name, shape=[*term.shape], on_load=term.on_load, around=[*term.around])

    def term(self, where: str) -> Term:
        effect = named(self.name, where)
        if len(self.shape) != len(effect.shapes):
            allowed = f"allowed: {len(effect.shapes)} finite numbers"
            raise InputError(f"{where}: {effect.name}.shape", f"found {self.shape}", allowed)
        return Term(effect, tuple(self.shape), self.on_load, tuple(self.around))


class _Table(BaseModel):
    """A balance in the file."""

    recording: str
    filter_width: Annotated[FiniteFloat, Field(gt=0.0)]
    mains: list[FiniteFloat] = []
    effort_step: FiniteFloat = 0.0
    shift: FiniteFloat = 0.0
    misplaced: bool = False
    coefficients: list[Annotated[FiniteFloat, Field(ge=-LARGEST_VALUE, le=LARGEST_VALUE)]]
    effects: list[_Effect] = []


class _File(BaseModel):
    """The table among those of a `model.toml`."""

    torque_balance: _Table
