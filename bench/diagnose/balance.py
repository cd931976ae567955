"""The torque balance of a diagnosed model along any recording, which is held against the measured torque."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

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

    def toml(self) -> str:
        """The table `[torque_balance]` of a `model.toml`."""
        lines = [
            "",
            "# The same model as coefficients of the torque balance, for `bench replay`; SI.",
            "[torque_balance]",
            f"recording = {_quoted(self.recording)}",
            f"filter_width = {self.width!r}",
            f"mains = [{_listed(self.hypothesis.mains)}]",
            f"coefficients = [{_listed(self.theta)}]",
        ]
        loads = self.hypothesis.loads
        for index, (effect, level) in enumerate(zip(self.hypothesis.effects, self.hypothesis.levels, strict=True)):
            lines += ["", "[[torque_balance.effects]]", f'name = "{effect.name}"']
            lines += [f"shape = [{_listed(effect.shape)}]", f"level = [{_listed(level)}]"]
            lines += [] if loads is None else [f"load = [{_listed(loads[index])}]"]
        return "\n".join(lines) + "\n"

    @classmethod
    def from_table(cls, table: dict) -> Balance:
        """Balance of the table that `toml` wrote; KeyError, TypeError or ValueError if it is none."""
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


def _listed(values: Iterable[float]) -> str:
    return ", ".join(repr(float(value)) for value in values)


def _quoted(text: str) -> str:
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
