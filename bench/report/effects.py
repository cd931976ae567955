"""The catalogue for a person: a table of all effects, and the page of one."""

from __future__ import annotations

import inspect
import math

from bench.effects.catalogue import list_effects
from bench.effects.effect import DriveLimit, Effect, EncoderFault, Lag, Stage
from bench.effects.present import named
from bench.effects.torque import Friction, Inertia, Torque
from bench.report.document import Table, table
from bench.units import Quantity

#: Where a torque acts, by its stage.
STAGES = {
    Stage.CURRENT_SENSOR: "between the current that is read and the one that flows",
    Stage.TORQUE_CONSTANT: "between reported current and torque",
    Stage.COMMUTATION: "in every step, motor torque",
    Stage.MECHANICS: "in every step, resisting torque",
}


def effects_table() -> Table:
    """Every effect with what it is, a line each."""
    return table("", ("effect", "what it is"), list_effects().items())


def effect_page(name: str) -> str:
    """The description of the effect's module, its quantities, and how it is simulated.

    Raises:
        InputError: no such effect.
    """
    effect = named(name, "bench list effects")
    module = inspect.getmodule(type(effect))
    lines = [effect.name, "=" * len(effect.name), inspect.getdoc(module) or effect.summary, "", "Quantities"]
    lines += [f"    {q.name} ({q.symbol}) [{unit_of(q)}], {bounds(q)}" for q in effect.quantities]
    lines += ["", "Simulated"]
    for method, place in acting(effect).items():
        text = inspect.getdoc(getattr(effect, method)) or ""
        lines.append(f"    {place}: {text.splitlines()[0]}")
    return "\n".join(lines)


def is_native(effect: Effect) -> bool:
    """Whether MuJoCo simulates it by itself, at some of its values at least."""
    return type(effect).add is not Effect.add


def acting(effect: Effect) -> dict[str, str]:
    """Methods through which an effect is simulated, and where each acts, in words."""
    found = {"add": "in the MuJoCo model"} if is_native(effect) else {}
    if is_native(effect) and type(effect).native is Effect.native:
        return found
    if isinstance(effect, Friction):
        found["friction"] = "in every step, level of dry friction"
    if isinstance(effect, Torque) and type(effect).torque is not Friction.torque:
        found["torque"] = STAGES[effect.stage]
    if isinstance(effect, Inertia):
        found["inertia"] = "in every step, inertia"
    if isinstance(effect, DriveLimit):
        found["flowing"] = "between demanded and reported current"
    if isinstance(effect, EncoderFault):
        found["measured"] = "between motion and drive"
    if isinstance(effect, Lag):
        torque = effect.signal == "torque"
        found["stepped" if torque else "lagging"] = (
            "between reported current and torque" if torque else "between drive and recording"
        )
    return found


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
