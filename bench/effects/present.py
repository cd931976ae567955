"""An effect that is there: its name and the values of its quantities."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from bench.axis_kind import ROTARY, AxisKind
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.effects.signals import Axis
from bench.effects.tabulated import TABLES
from bench.errors import InputError
from bench.names import nearest
from bench.units import Quantity, parse


@dataclass(frozen=True)
class Present:
    """An effect with values; equal ones compare equal, and they sort by name and values.

    Attributes:
        name: of the effect.
        values: quantity and value - SI - in the order of the effect's quantities.
    """

    name: str
    values: tuple[tuple[str, float], ...]

    @classmethod
    def of(cls, name: str, values: Mapping[str, float], where: str = "effect") -> Present:
        """Checked against the effect's quantities and their bounds; values by quantity - SI.

        InputError, of `where` they come from, for an unknown effect or quantity, or a value out of bounds.
        """
        effect = named(name, where)
        for key, value in values.items():
            quantity = known_quantity(effect, key, where)
            if not quantity.lower <= value <= quantity.upper:
                allowed = f"allowed: {quantity.lower:g} to {quantity.upper:g} {quantity.unit}"
                raise InputError(f"{where}: {name}.{key}", f"found {value:g} {quantity.unit}", allowed)
        return cls(name, tuple((q.name, float(values[q.name])) for q in effect.quantities if q.name in values))

    @property
    def effect(self) -> Effect:
        """What the catalogue has under the name, or the table of an unknown effect."""
        return TABLES.get(self.name) or catalogue()[self.name]

    def resolved(self, axis: Axis) -> dict[str, float]:
        """All quantities, those that are not given by their defaults - SI; InputError where one has none."""
        defaults = {key: float(value) for key, value in self.effect.defaults(axis).items()}
        values = {**defaults, **dict(self.values)}
        for quantity in self.effect.quantities:
            if quantity.name not in values:
                raise InputError(f"effect {self.name}", f"{quantity.name} missing", f"give it, {quantity.unit}")
        return {quantity.name: values[quantity.name] for quantity in self.effect.quantities}

    def absent(self, axis: Axis) -> bool:
        """Whether the values are those at which the effect does nothing."""
        values = self.resolved(axis)
        return all(values[key] == value for key, value in self.effect.null(axis).items())


def named(name: str, where: str = "effect") -> Effect:
    """The effect of a name, or the table of an unknown one; InputError where there is none."""
    if name in TABLES:
        return TABLES[name]
    if name not in catalogue():
        names = sorted(catalogue())
        raise InputError(where, f"found '{name}'{nearest(name, names)}", f"allowed: {', '.join(names)}")
    return catalogue()[name]


def known_quantity(effect: Effect, key: str, where: str) -> Quantity:
    """The quantity of an effect under a name; InputError where it has none of that name."""
    names = [quantity.name for quantity in effect.quantities]
    if key not in names:
        found = f"found '{key}'{nearest(key, names)}"
        raise InputError(f"{where}: {effect.name}", found, f"allowed: {', '.join(names)}")
    return effect.quantities[names.index(key)]


GivenEffects: TypeAlias = Present | str | Sequence[Present | str] | Mapping[str, Mapping[str, float | str]]


def given_effects(given: GivenEffects, kind: AxisKind) -> list[Present]:
    """Effects as a caller gives them: one or several, as texts of the command line or by name with their values.

    InputError as `parse_effect`, or where values are no dictionary.
    """
    if not isinstance(given, Mapping):
        every = [given] if isinstance(given, Present | str) else given
        return [parse_effect(one, kind) if isinstance(one, str) else one for one in every]
    for name, values in given.items():
        if not isinstance(values, Mapping):
            names = ", ".join(f'"{quantity.name}": ...' for quantity in named(name, "effects").quantities)
            raise InputError(f"effects: {name}", f"found {values!r}", f"allowed: {{{names}}}")
    return [_valued(named(name, "effects"), values, kind, "effects") for name, values in given.items()]


def _valued(effect: Effect, values: Mapping[str, object], kind: AxisKind, where: str) -> Present:
    """The effect with values in SI, or as texts with a unit."""
    units = {key: kind.unit(known_quantity(effect, key, where)) for key in values}
    found = {key: parse_value(str(values[key]), unit, f"{where}: {key}") for key, unit in units.items()}
    return Present.of(effect.name, found, where)


def parse_effect(text: str, kind: AxisKind = ROTARY) -> Present:
    """`NAME:key=value,key=value` as on the command line; a value without a unit is SI.

    InputError where it is not of this form, an effect or quantity is unknown, or a value is none or out of bounds.
    """
    where = f"effect {text}"
    name, _, rest = text.partition(":")
    effect = named(name.strip(), where)
    values = {}
    for part in filter(None, (part.strip() for part in rest.split(","))):
        key, sign, value = (piece.strip() for piece in part.partition("="))
        if not sign:
            raise InputError(where, f"found '{part}'", "allowed: key=value, separated by commas")
        values[key] = value.strip("\"'")
    return _valued(effect, values, kind, where)


def parse_value(text: str, unit: str, where: str) -> float:
    """A number in SI, or a number with a unit; InputError where it is neither."""
    try:
        value = float(text)
    except ValueError:
        return parse(text, unit, where)
    if not math.isfinite(value):
        raise InputError(where, f"found {text}", f"allowed: a finite number in {unit}")
    return value
