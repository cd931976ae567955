"""An unknown effect, tabulated: a torque without a name, over what it depends on.

    M = T(q)              over position, the same in both directions
    M = K(x)*sgn(omega)   over position, speed or motor torque: dry friction in addition to Coulomb's

    T(x) = sum over j of T_j*max(0, 1 - |u - j|),   u = (x - low)/(high - low)*(NODES - 1) within 0 to NODES - 1

T_j, K_j - N*m (N) - are the values at equidistant nodes from `low` to `high`, linear between and constant beyond them.
Over the whole turn of an axis (`turns` is 1) the position is taken modulo 2*pi. Friction never drives: in a simulation
its level with Coulomb's is not below zero.

No table is in the catalogue, so none is ever a name: `bench.diagnosis.tabulated` fits them to a residual.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import ClassVar

import numpy as np

from bench.arrays import namespace
from bench.effects.signals import Axis, AxisState, Number, Scope, Signals, Values
from bench.effects.torque import Friction, Torque
from bench.trace.filter import Column
from bench.units import Quantity

#: Nodes of a table, which bounds its size: 7.6 degrees of a turn.
NODES = 48
#: Their names among the quantities of a table.
NAMES = tuple(f"node_{k:02d}" for k in range(NODES))
_TURN = 2.0 * math.pi


class Tabulated(Torque):
    """A torque tabulated over one coordinate.

    Attributes:
        over: the coordinate: position, speed or torque.
    """

    over: ClassVar[str]

    def sought(self, scope: Scope) -> bool:
        """Whether the coordinate was recorded."""
        return super().sought(scope) and (self.over != "position" or "position" in scope.signals)

    def coordinate(self, at: AxisState) -> Number:
        """What it depends on."""
        if self.over == "position":
            return at.position
        return abs(at.velocity if self.over == "speed" else at.effort)

    def place(self, values: Values, at: AxisState) -> Number:
        """Where among the nodes the coordinate is, 0 to NODES - 1."""
        x, low = self.coordinate(at), values["low"]
        xp = namespace(x)
        x = x - values["turns"] * _TURN * xp.floor(x / _TURN)
        return xp.clip((x - low) / (values["high"] - low), 0.0, 1.0) * (NODES - 1.0)

    def level(self, values: Values, at: AxisState) -> Number:
        """Torque, or friction in the direction of the motion, between the nodes - N*m (N)."""
        place = self.place(values, at)
        if isinstance(place, float):  # only its two nodes: a tenth of the time
            node = min(int(place), NODES - 2)
            return values[NAMES[node]] + (place - node) * (values[NAMES[node + 1]] - values[NAMES[node]])
        share, nodes = hats(place), [values[name] for name in NAMES]
        xp = namespace(share)  # NumPy's own stack takes twenty times as long as np.array
        return xp.sum(share * (np.array(nodes).T if xp is np else xp.stack(nodes, axis=-1)), axis=-1)

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """One of each node, of a shape (low, high, turns)."""
        low, high, turns = shape
        values = {"low": low, "high": high, "turns": turns}
        return [[(column, 0)] for column in (hats(self.place(values, signals.state)) * self.direction(signals)).T]

    def direction(self, signals: Signals) -> Number:
        """Sign of the torque at samples (n, 1)."""
        return 1.0


def _quantities(unit: str) -> tuple[Quantity, ...]:
    """Of a table over a coordinate of this unit."""
    ends = Quantity("low", "x_1", unit), Quantity("high", "x_2", unit)
    turns = Quantity("turns", "w", "dimensionless", lower=0.0, upper=1.0, preset=0.0)
    return *ends, turns, *(Quantity(name, f"M_{k}", "N*m", null=0.0, preset=0.0) for k, name in enumerate(NAMES))


class TorqueOverPosition(Tabulated):
    name, over = "unknown_torque_over_position", "position"
    summary = "a torque of an unknown effect, tabulated over position"
    quantities = _quantities("rad")

    def torque(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return self.level(values, at)


class TabulatedFriction(Friction, Tabulated):
    """Dry friction, which opposes the motion."""

    def direction(self, signals: Signals) -> Number:
        return signals.sign[:, None]

    def friction(self, values: Values, axis: Axis, at: AxisState) -> Number:
        return self.level(values, at)


class FrictionOverPosition(TabulatedFriction):
    name, over = "unknown_friction_over_position", "position"
    summary = "friction of an unknown effect, tabulated over position"
    quantities = _quantities("rad")


class FrictionOverSpeed(TabulatedFriction):
    name, over = "unknown_friction_over_speed", "speed"
    summary = "friction of an unknown effect, tabulated over speed"
    quantities = _quantities("rad/s")


class FrictionOverTorque(TabulatedFriction):
    name, over = "unknown_friction_over_torque", "torque"
    summary = "friction of an unknown effect, tabulated over the motor's torque"
    quantities = _quantities("N*m")


def hats(place: Number) -> Number:
    """Share of each node in a torque (..., NODES) at places among them (...)."""
    xp = namespace(place)
    off = place[..., None] - np.arange(NODES) if xp is np else xp.stack([place - k for k in range(NODES)], axis=-1)
    return xp.clip(1.0 - xp.abs(off), 0.0, None)


#: Every table by its name.
TABLES: Mapping[str, Tabulated] = MappingProxyType(
    {
        table.name: table
        for table in (TorqueOverPosition(), FrictionOverPosition(), FrictionOverSpeed(), FrictionOverTorque())
    }
)
