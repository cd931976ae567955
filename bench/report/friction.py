"""Friction over steady speeds: the curve, the effect that bends it, and how sure that is.

As JSON (`bench.friction/1`) and as a document; its picture has the steady speeds, the curves, and their residuals.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bench.axis_kind import COULOMB, OFFSET, VISCOUS
from bench.effects.catalogue import catalogue
from bench.friction_map import CHANCE, FrictionMap
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
    """The map, what is valid of it and how sure that is."""
    before, after = found.unexplained
    axis, effect = (
        {name: {"value": value, "unit": unit} for name, (value, unit) in values.items()}
        for values in (_base(found), _effect(found))
    )
    return serialised(
        {
            "schema": SCHEMA,
            "parameters": axis,
            "effect": None if found.name is None else {"name": found.name, "parameters": effect},
            "best": found.best.name or None,
            "chance": found.probability,
            "unexplained": {"before": before, "after": after},
            "checks": found.checks,
            "velocity": {"unit": found.kind.speed_unit, "values": found.velocity},
            "effort": {"unit": found.effort_unit, "values": found.effort},
        }
    )


def friction(found: FrictionMap, title: str, following: str = "") -> doc.Document:
    """The document of a friction map of the axis that `title` names; `following`: what to do next."""
    axes = {"The axis": _base(found), **({} if found.name is None else {sentence(words(found.name)): _effect(found)})}
    tables = [values_table(of, ((name, *value) for name, value in values.items())) for of, values in axes.items()]
    curves, left = _charts(found)
    return doc.Document(
        title=f"{title}: friction",
        subject=f"Friction of {title} over {found.velocity.size} steady speeds",
        verdict=_verdict(found),
        tone="sure",
        answers=_answers(found) | ({"What next?": following} if following else {}),
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
        return f"Friction is a straight line over speed: no effect bends it, and {share(before)} is unexplained."
    values = ", ".join(f"{words(name)} {number(value, unit)}" for name, (value, unit) in _effect(found).items())
    bent = f"{sentence(words(found.name))} ({values}) bends the curve"
    return f"{bent}: {share(before)} was unexplained without, {share(after)} with it."


def _answers(found: FrictionMap) -> dict[str, str]:
    base, speeds = _base(found), np.abs(found.velocity)
    friction = "; ".join(
        f"{words(name)} {number(*base[name])}" for name in map(found.kind.parameter, (COULOMB, VISCOUS)) if name in base
    )
    chance = f"chance saves as much with probability {number(found.probability, digits=2)}"
    if found.name is None and found.best.name:
        chance = f"{words(found.best.name)} is best, {chance}"
    elif found.name is None:
        chance = "physics allows no effect here"
    sure = f"{sentence(chance)}; an effect is named below {CHANCE:g}."
    if found.offset is None:
        sure += " A constant offset is counted in the effect: such recordings do not distinguish them."
    before, after = found.unexplained
    effect = "; ".join(f"{words(name)} {number(*value)}" for name, value in _effect(found).items())
    between = f"{number(speeds.min(), digits=3)} to {number(speeds.max(), found.kind.speed_unit, 3)}"
    return {
        "Friction?": friction,
        "What was missing?": f"{sentence(words(found.name))} ({effect})." if found.name else "No effect of speed.",
        "How sure?": sure,
        "How large is the residual?": f"{share(before)} of the friction"
        + (f" without the effect, {share(after)} with it." if found.name else "."),
        "From what?": f"{found.velocity.size} steady speeds, {between}.",
    }


def _charts(found: FrictionMap) -> tuple[doc.Chart, doc.Chart]:
    """The steady speeds and the curves fitted to them, and the residuals of each curve."""
    effort, curves = effort_word(found.effort_unit), [("no effect", found.plain)]
    if found.name is not None:
        curves.append((words(found.name), found.best))
    drawn, left = [], []
    for label, curve in curves:
        style, colour = ("rings", "residual") if curve is found.plain else ("dots", "model")
        left.append(doc.series(label, style, colour, found.velocity, found.effort - curve.effort(found.velocity)))
        for direction in (-1.0, 1.0):
            speeds = found.velocity[direction * found.velocity > 0.0]
            if speeds.size:
                x = np.sort(direction * np.geomspace(np.abs(speeds).min(), np.abs(speeds).max(), DRAWN))
                drawn.append(doc.series(label, "line", colour, x, curve.effort(x)))
                label = ""
    drawn.append(doc.series("steady speeds", "dots", "ink", found.velocity, found.effort))
    over = ("speed", found.kind.speed_unit)
    alternative = f"{sentence(effort)} at each steady speed, and the curves fitted to them."
    return (
        one_panel("Friction.", alternative, over, (effort, found.effort_unit), drawn),
        one_panel("Residual.", "Residual of each curve.", over, ("residual", found.effort_unit), left),
    )
