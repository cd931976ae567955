"""The catalogue for a person: a table of all effects, and the page of one."""

from __future__ import annotations

import inspect
import math

from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.effects.kinds import Electronics, Mechanism, Sensing
from bench.effects.present import named
from bench.report.document import Table, table
from bench.units import Quantity

#: What hooks do, in the words of a page.
HOOKS = {
    "add": "in the MuJoCo model",
    "friction_excess": "in every step, level of dry friction",
    "friction_factor": "in every step, level of dry friction",
    "friction_difference": "in every step, level of dry friction",
    "friction_under_load": "in every step, level of dry friction",
    "resisting_torque": "in every step, resisting torque",
    "torque_factor": "in every step, motor torque",
    "added_inertia": "in every step, inertia",
    "flowing": "between demanded and reported current",
    "acting": "between reported current and torque",
    "delivered": "between reported current and torque",
    "seen": "between motion and drive",
    "filtered": "between drive and recording",
    "acted": "between the current that is read and the one that flows",
    "recorded": "between drive and recording",
}


def effects_table() -> Table:
    """Every effect with its quantities, and where it acts."""
    rows = (
        (name, effect.summary, ", ".join(f"{q.name} [{unit_of(q)}]" for q in effect.quantities), _where(effect))
        for name, effect in sorted(catalogue().items())
    )
    return table("", ("effect", "what it is~", "quantities~", "simulated"), rows)


def effect_page(name: str) -> str:
    """What the effect's module says of it, its quantities, and how it is simulated.

    Raises:
        InputError: no such effect.
    """
    effect = named(name, "bench effects")
    module = inspect.getmodule(type(effect))
    lines = [effect.name, "=" * len(effect.name), inspect.getdoc(module) or effect.summary, "", "Quantities"]
    lines += [f"    {q.name} ({q.symbol}) [{unit_of(q)}], {bounds(q)}" for q in effect.quantities]
    lines += ["", "Simulated"]
    for hook, place in acting(effect).items():
        text = inspect.getdoc(getattr(effect, hook)) or ""
        lines.append(f"    {place}: {text.splitlines()[0]}")
    return "\n".join(lines)


def acting(effect: Effect) -> dict[str, str]:
    """Hooks through which an effect is simulated, and where each acts, in words."""
    return {hook: place for hook, place in HOOKS.items() if effect.overrides(hook)}


def _where(effect: Effect) -> str:
    if isinstance(effect, Mechanism):
        return "MuJoCo model" if effect.overrides("add") else "every step"
    return "electronics" if isinstance(effect, Electronics) else "sensor" if isinstance(effect, Sensing) else ""


def unit_of(quantity: Quantity) -> str:
    """SI unit of a quantity on a rotary axis; a dash where there is none."""
    return "-" if quantity.unit == "dimensionless" else quantity.unit


def bounds(quantity: Quantity) -> str:
    """What values a quantity may have, in words."""
    if math.isinf(quantity.lower) and math.isinf(quantity.upper):
        return "any"
    if math.isinf(quantity.upper):
        return f"from {quantity.lower:g}"
    return f"{quantity.lower:g} to {quantity.upper:g}"
