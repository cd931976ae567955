"""The catalogue for a person: a table of all effects, and the page of one."""

from __future__ import annotations

import inspect
import math

from bench.effects import acting as ways
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.effects.present import named
from bench.report.document import Table, table
from bench.units import Quantity

#: The method by which effects of a kind act in a simulation, and where.
PLACES: tuple[tuple[type[Effect], str, str], ...] = (
    (ways.Native, "add", "in the MuJoCo model"),
    (ways.RaisesFriction, "friction_excess", "in every step, level of dry friction"),
    (ways.ScalesFriction, "friction_factor", "in every step, level of dry friction"),
    (ways.DirectedFriction, "friction_difference", "in every step, level of dry friction"),
    (ways.ResistingTorque, "resisting_torque", "in every step, resisting torque"),
    (ways.ScalesTorque, "torque_factor", "in every step, motor torque"),
    (ways.VaryingInertia, "added_inertia", "in every step, inertia"),
    (ways.DriveLimit, "flowing", "between demanded and reported current"),
    (ways.TorqueLag, "acting", "between reported current and torque"),
    (ways.TorqueLoss, "delivered", "between reported current and torque"),
    (ways.MisreadMotion, "seen", "between motion and drive"),
    (ways.MisreadEffort, "acted", "between the current that is read and the one that flows"),
    (ways.FilteredSignal, "recorded", "between drive and recording"),
)
#: What is simulated where, in a word.
SIMULATED = (
    (ways.Native, "MuJoCo model"),
    (ways.Mechanism, "every step"),
    (ways.Electronics, "electronics"),
    (ways.Sensing, "sensor"),
)


def effects_table() -> Table:
    """Every effect with its quantities, and where it acts."""
    rows = []
    for name, effect in sorted(catalogue().items()):
        quantities = ", ".join(f"{quantity.name} [{unit_of(quantity)}]" for quantity in effect.quantities)
        where = next((place for kind, place in SIMULATED if isinstance(effect, kind)), "")
        rows.append((name, effect.summary, quantities, where))
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
    for method, place in acting(effect).items():
        text = inspect.getdoc(getattr(effect, method)) or ""
        lines.append(f"    {place}: {text.splitlines()[0]}")
    return "\n".join(lines)


def acting(effect: Effect) -> dict[str, str]:
    """Methods through which an effect is simulated, and where each acts, in words."""
    return {method: place for kind, method, place in PLACES if isinstance(effect, kind)}


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
