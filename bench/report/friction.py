"""Friction over steady speeds: the curve, the effect that bends it, and how sure that is.

As JSON (`bench.friction/1`) and as a document; its picture has the recordings, the curves, and what each leaves.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bench.axis_kind import COULOMB, OFFSET, VISCOUS
from bench.effects.catalogue import catalogue
from bench.friction_map import CHANCE, FrictionCurve, FrictionMap
from bench.gate.gate import warnings_of
from bench.names import words
from bench.report import document as doc
from bench.report.numbers import effort_word, number, sentence, share
from bench.report.parts import checks_section, one_panel, origin, values_table
from bench.report.serial import serialised

SCHEMA = "bench.friction/1"
#: Speeds at which a curve is drawn, in each direction.
DRAWN = 200

Values = Mapping[str, tuple[float, str]]


def friction_json(found: FrictionMap) -> str:
    """The map, what holds of it and how sure that is."""
    before, after = found.unexplained
    return serialised(
        {
            "schema": SCHEMA,
            "parameters": _values_json(_base(found)),
            "effect": None if found.name is None else {"name": found.name, "parameters": _values_json(_effect(found))},
            "best": found.best.name or None,
            "chance": found.probability,
            "unexplained": {"before": before, "after": after},
            "checks": found.checks,
            "velocity": {"unit": found.kind.speed_unit, "values": found.velocity},
            "effort": {"unit": found.effort_unit, "values": found.effort},
        }
    )


def _values_json(values: Values) -> dict[str, Any]:
    return {name: {"value": value, "unit": unit} for name, (value, unit) in values.items()}


def friction(found: FrictionMap, title: str) -> doc.Document:
    """The document of a friction map of the axis that `title` names."""
    axes = {"The axis": _base(found), **({} if found.name is None else {sentence(words(found.name)): _effect(found)})}
    tables = [values_table(of, ((name, *value) for name, value in values.items())) for of, values in axes.items()]
    curves, left = _over_speed(found), _left(found)
    return doc.Document(
        title=f"{title}: friction",
        subject=f"Friction of {title} over {found.velocity.size} steady speeds",
        verdict=_verdict(found),
        tone="sure",
        answers=_answers(found),
        sections=(
            doc.section("curve", "Friction over speed", curves, left),
            doc.section("parameters", "Parameters", *tables),
            checks_section(found.checks, ()),
        ),
        origin=origin(None),
        pictures=(doc.Picture(name="friction", title=title, rows=((curves,), (left,))),),
        warnings=tuple(warnings_of(found.checks)),
    )


def _base(found: FrictionMap) -> Values:
    """K_w, K_0 and M_0 by their names, with their units."""
    columns = {VISCOUS: found.base.viscous, COULOMB: found.base.coulomb}
    if found.offset is not None:
        columns[OFFSET] = found.offset
    return {
        found.kind.parameter(column): (value, found.kind.parameter_unit(column, found.effort_unit))
        for column, value in columns.items()
    }


def _effect(found: FrictionMap) -> Values:
    """Quantities of the effect that is named, with their units; none where none is."""
    if found.name is None:
        return {}
    quantities = {quantity.name: quantity for quantity in catalogue()[found.name].quantities}
    return {name: (value, found.kind.unit(quantities[name], found.effort_unit)) for name, value in found.values.items()}


def _verdict(found: FrictionMap) -> str:
    before, after = found.unexplained
    if found.name is None:
        return f"Friction is a straight line over speed: no effect bends it, and {share(before)} is left unexplained."
    values = ", ".join(f"{words(name)} {number(value, unit)}" for name, (value, unit) in _effect(found).items())
    bent = f"{sentence(words(found.name))} ({values}) bends the curve"
    return f"{bent}: {share(before)} was unexplained without, {share(after)} with it."


def _answers(found: FrictionMap) -> dict[str, str]:
    base, least, most = _base(found), np.abs(found.velocity).min(), np.abs(found.velocity).max()
    friction = "; ".join(
        f"{words(name)} {number(*base[name])}" for name in map(found.kind.parameter, (COULOMB, VISCOUS)) if name in base
    )
    chance = f"chance saves as much with probability {number(found.probability, digits=2)}"
    if found.name is None and found.best.name:
        chance = f"{words(found.best.name)} is best, {chance}"
    elif found.name is None:
        chance = "physics allows no effect here"
    left = "Nothing that steady speeds would tell."
    if found.offset is None:
        left = "A constant offset is counted in the effect: such recordings do not tell them apart."
    speeds = f"{number(least, digits=3)} to {number(most, found.kind.speed_unit, 3)}"
    return {
        "Friction?": friction,
        "How sure?": f"{sentence(chance)}; named below {CHANCE:g}.",
        "From what?": f"{found.velocity.size} recordings, {speeds}.",
        "What is open?": left,
    }


def _curves(found: FrictionMap) -> list[tuple[FrictionCurve, str, bool]]:
    """Curves that are drawn, what they are called, and whether an effect bends them."""
    plain = [(found.plain, "no effect", False)]
    return plain if found.name is None else [*plain, (found.best, words(found.name), True)]


def _over_speed(found: FrictionMap) -> doc.Chart:
    effort, drawn = effort_word(found.effort_unit), []
    for curve, label, bent in _curves(found):
        for direction in (-1.0, 1.0):
            speeds = found.velocity[direction * found.velocity > 0.0]
            if speeds.size:
                x = np.sort(direction * np.geomspace(np.abs(speeds).min(), np.abs(speeds).max(), DRAWN))
                name = "" if any(one.name == label for one in drawn) else label
                drawn.append(doc.series(name, "line", "model" if bent else "left", x, curve.effort(x)))
    drawn.append(doc.series("recordings", "dots", "ink", found.velocity, found.effort))
    alternative = f"{sentence(effort)} of each recording at its steady speed, and the curves fitted to them."
    axes = ("speed", found.kind.speed_unit), (effort, found.effort_unit)
    return one_panel("Friction.", alternative, *axes, drawn)


def _left(found: FrictionMap) -> doc.Chart:
    """What each curve leaves of the recordings."""
    drawn = []
    for curve, label, bent in _curves(found):
        style, colour = ("dots", "model") if bent else ("rings", "left")
        drawn.append(doc.series(label, style, colour, found.velocity, found.effort - curve.effort(found.velocity)))
    axes = ("speed", found.kind.speed_unit), ("left", found.effort_unit)
    return one_panel("What is left.", "What each curve leaves of the recordings.", *axes, drawn)
