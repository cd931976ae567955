"""The torque balance of a diagnosed model along any recording, which is held against the measured torque."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.candidates import EVENT
from bench.diagnose.columns import MAINS, build
from bench.diagnose.fit import Fit
from bench.diagnose.hypothesis import Hypothesis, Named
from bench.diagnose.workbench import Workbench

Array = NDArray[np.float64]

#: Stands for a recording where an event comes at the same time of every one.
EVERY = "every recording"


@dataclass(frozen=True)
class Balance:
    """A fitted torque balance, ready for other recordings of the axis.

    Attributes:
        hypothesis: its effects and their shapes.
        theta: (p,) J, K_w, K_0, misalignment, strengths.
        width: of the filter it was fitted through - s.
        recording: the one it was fitted to; an event happened in it and in no other, unless EVERY.
    """

    hypothesis: Hypothesis
    theta: Array
    width: float
    recording: str

    @classmethod
    def of(cls, bench: Workbench, fitted: Fit) -> Balance:
        """Balance of a fit."""
        return cls(fitted.hypothesis, fitted.theta, bench.conditioning.filter.width, bench.origin)

    def repeating(self, events: bool) -> Balance:
        """The same with its events in every recording, if they happen in every one."""
        return replace(self, recording=EVERY) if events else self

    def torque(self, bench: Workbench) -> Array:
        """Modelled torque at the used rows of a recording - N*m (N) - (m,)."""
        columns, owners = build(bench, self.hypothesis)
        theta = self.theta.copy()
        if self.recording != bench.origin:
            theta[owners == MAINS] = 0.0
        if self.recording not in (EVERY, bench.origin):
            names = self.hypothesis.names
            theta[[owner >= 0 and names[owner] == EVENT for owner in owners]] = 0.0
        return columns @ theta

    def gap(self, bench: Workbench) -> float:
        """RMS of measured less modelled torque along a recording - N*m (N)."""
        return float(np.sqrt(np.mean((bench.effort - self.torque(bench)) ** 2)))

    def table(self) -> dict[str, Any]:
        """The table `torque_balance` of a `model.toml`: the model as coefficients, for `bench replay` - SI."""
        loads = self.hypothesis.loads
        effects = [
            {"name": effect.name, "shape": _listed(effect.shape), "level": _listed(level)}
            | ({} if loads is None else {"load": _listed(loads[index])})
            for index, (effect, level) in enumerate(zip(self.hypothesis.effects, self.hypothesis.levels, strict=True))
        ]
        return {
            "recording": self.recording,
            "filter_width": float(self.width),
            "mains": _listed(self.hypothesis.mains),
            "coefficients": _listed(self.theta),
            "effects": effects,
        }

    @classmethod
    def from_table(cls, table: dict) -> Balance:
        """Balance of the table that `table` gave; KeyError, TypeError or ValueError if it is none."""
        effects = tuple(
            Named(str(entry["name"]), tuple(float(value) for value in entry["shape"]))
            for entry in table.get("effects", [])
        )
        theta = np.array([float(value) for value in table["coefficients"]])
        mains = tuple(float(line) for line in table.get("mains", []))
        levels = tuple(tuple(float(value) for value in entry["level"]) for entry in table.get("effects", []))
        loads = [
            tuple(float(value) for value in entry["load"]) for entry in table.get("effects", []) if "load" in entry
        ]
        hypothesis = Hypothesis(effects, levels, mains, tuple(loads) if loads else None)
        return cls(hypothesis, theta, float(table["filter_width"]), str(table["recording"]))


def _listed(values: Iterable[float]) -> list[float]:
    return [float(value) for value in values]
