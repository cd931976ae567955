"""The torque balance of a diagnosed model along any recording, which is held against the measured torque."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bench.arrays import Array, rms
from bench.effects.effect import Occasional
from bench.effects.present import named
from bench.fit.fit import ROUNDS, Fit
from bench.fit.hypothesis import AROUND, HUM, Hypothesis, Layout, Term, depended_on, lay_out, not_reaching
from bench.fit.rows import Rows

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
        effects = [
            {"name": term.effect.name, "shape": list(term.shape), "on_load": term.on_load, "around": list(term.around)}
            for term in self.hypothesis.terms
        ]
        return {
            "recording": self.recording,
            "filter_width": self.width,
            "mains": list(self.hypothesis.hum),
            "effort_step": self.hypothesis.step,
            "shift": self.hypothesis.shift,
            "misplaced": self.hypothesis.misplaced,
            "coefficients": self.theta.tolist(),
            "effects": effects,
        }

    @classmethod
    def from_table(cls, table: Mapping[str, Any], where: str) -> Balance:
        """Balance of the table that `table` gave.

        KeyError, TypeError or ValueError where it is none; InputError, of `where`, where there is no such effect.
        """
        terms = tuple(
            Term(
                named(str(entry["name"]), f"{where}.effects"),
                _floats(entry["shape"]),
                bool(entry["on_load"]),
                _floats(entry["around"]),
            )
            for entry in table.get("effects", [])
        )
        step, shift = (float(table.get(name, 0.0)) for name in ("effort_step", "shift"))
        misplaced = bool(table.get("misplaced", False))
        hypothesis = Hypothesis(terms, _floats(table.get("mains", [])), step, shift, misplaced)
        theta = np.array(_floats(table["coefficients"]))
        return cls(hypothesis, theta, float(table["filter_width"]), str(table["recording"]))


def _floats(values: Any) -> tuple[float, ...]:  # noqa: ANN401 - whatever a file holds
    return tuple(float(value) for value in values)
