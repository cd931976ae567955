"""What counts as a change: margins below which no change matters, and the spread between recordings of one axis.

A rig states both in `[check.margin]` and `[check.between]`, by quantity (`coulomb_friction_torque`,
`cogging_torque.amplitude`, `torque_gap`): a share of the baseline's value, "2 %", or a number with its unit.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from bench.axis_kind import COULOMB, INERTIA, ROTARY, VISCOUS, AxisKind
from bench.baseline.state import TORQUE_GAP, VELOCITY_GAP, State
from bench.comparison.difference import Measured
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.names import nearest
from bench.rig.rig import Rig
from bench.units import parse

_SHARE = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*%\s*")
#: Default margins, as shares of the baseline's value.
MARGINS = {INERTIA: 0.005, VISCOUS: 0.15, COULOMB: 0.03, TORQUE_GAP: 0.25, VELOCITY_GAP: 0.5}
#: Default standard deviations between recordings, as shares of the baseline's value, for an axis that is warm and moves
#: the same way each time. Used where the rig states none and fewer than `difference.ENOUGH` recordings show them.
BETWEEN = {INERTIA: 0.001, VISCOUS: 0.03, COULOMB: 0.0075, TORQUE_GAP: 0.04, VELOCITY_GAP: 0.1}
#: Relative standard deviation of a recording's noise floor: coloured noise is hard to separate from a gap.
FLOOR = 0.12
#: Default margin, and standard deviation between recordings, of quantities of effects and of their torque.
OF_EFFECTS, BETWEEN_OF_EFFECTS = 0.25, 0.05
#: Share of the effort of a motion below which the contribution of a parameter does not matter.
LEAST = 1e-3
#: Factor on these standard deviations for recordings of different motion or sampling. For two recordings at 95 % it
#: gives what `bench.diagnosis.same_axis` allows (1 % of inertia, 30 % of viscous and 10 % of Coulomb friction).
OTHER_MOTION = 5.0
#: The quantity of a motion that a parameter's torque is proportional to.
_MADE_OF = {INERTIA: "rms_acceleration", VISCOUS: "rms_speed"}


@dataclass(frozen=True)
class Allowed:
    """Margins and spreads of an axis.

    Attributes:
        kind: of the axis.
        margin, between: as the rig states them, by quantity.
        source: where they are stated, for messages.
    """

    kind: AxisKind
    margin: Mapping[str, str] = field(default_factory=dict)
    between: Mapping[str, str] = field(default_factory=dict)
    source: str = "rig"

    @classmethod
    def of(cls, rig: Rig | None, kind: AxisKind = ROTARY) -> Allowed:
        """Those of a rig, or the defaults without one.

        Args:
            rig: of the axis.
            kind: of the axis, if there is no rig.

        Raises:
            InputError: an unknown quantity.
        """
        if rig is None:
            return cls(kind)
        found = cls(rig.axis_kind)
        if rig.check is not None:
            found = cls(rig.axis_kind, rig.check.margin, rig.check.between, f"{rig.source}: check")
        for table in ("margin", "between"):
            for name in getattr(found, table):
                _require_known(name, found, f"{found.source}.{table}")
        return found

    def margin_of(self, name: str, baseline: Measured, state: State) -> float:
        """Change of a quantity below which it does not matter - its unit.

        Args:
            name: of the quantity.
            baseline: its value.
            state: the baseline, whose motion gives the torque of a parameter.
        """
        if name in self.margin:
            return _stated(self.margin[name], baseline, f"{self.source}.margin.{name}")
        term = self._term(name)
        share = MARGINS.get(term or name, OF_EFFECTS) * abs(baseline.value)
        effort = state.conditions.get("rms_effort")
        if term is None or effort is None:
            return share
        made_of = state.conditions[_MADE_OF[term]].value if term in _MADE_OF else 1.0
        return max(share, LEAST * effort.value / max(made_of, 1e-300))

    def between_of(self, name: str, baseline: Measured) -> float:
        """Standard deviation of a quantity between recordings - its unit."""
        if name in self.between:
            return _stated(self.between[name], baseline, f"{self.source}.between.{name}")
        return BETWEEN.get(self._term(name) or name, BETWEEN_OF_EFFECTS) * abs(baseline.value)

    def _term(self, name: str) -> str | None:
        return next((term for term in (INERTIA, VISCOUS, COULOMB) if self.kind.parameter(term) == name), None)


def _stated(text: str, baseline: Measured, where: str) -> float:
    """A share of the baseline's value, or a number with its unit, in the quantity's unit."""
    match = _SHARE.fullmatch(text)
    value = 0.01 * float(match[1]) * abs(baseline.value) if match else parse(text, baseline.unit, where)
    if value < 0.0:
        raise InputError(where, f"found {text!r}", 'allowed: zero or above, e.g. "2 %"')
    return value


def _require_known(name: str, allowed: Allowed, where: str) -> None:
    own = [*allowed.kind.base_parameters(), TORQUE_GAP, VELOCITY_GAP]
    of_effects = [f"{effect.name}.{q.name}" for effect in catalogue().values() for q in effect.quantities]
    if name not in own and name not in of_effects:
        known = f"{', '.join(own)}, or EFFECT.QUANTITY as in bench effects"
        raise InputError(where, f"found '{name}'{nearest(name, [*own, *of_effects])}", f"allowed: {known}")
