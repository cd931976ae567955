"""The page of friction over steady speeds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, VISCOUS
from bench.friction_map.curve import Curve
from bench.friction_map.map import CHANCE, FrictionMap
from bench.names import words
from bench.report.document import Chart, Document, Heading, Panel, Section, Series, Table
from bench.report.friction import base_values, effect_values
from bench.report.numbers import effort_word, number, sentence, share, unit_text
from bench.report.parts import checks_section, origin

#: Speeds at which a curve is drawn, in each direction.
DRAWN = 200

Values = Mapping[str, tuple[float, str]]


def friction_page(found: FrictionMap, title: str) -> Document:
    """The page of a friction map."""
    tables = [_table("The axis", base_values(found))]
    if found.name is not None:
        tables.append(_table(sentence(words(found.name)), effect_values(found)))
    return Document(
        title=f"{title}: friction",
        subject=f"Friction of {title} over {found.velocity.size} steady speeds",
        verdict=_verdict(found),
        tone="sure",
        answers=_answers(found),
        sections=(
            Section(key="curve", heading="Friction over speed", blocks=(_over_speed(found), _left(found))),
            Section(key="parameters", heading="Parameters", blocks=tuple(tables)),
            checks_section(found.checks, ()),
        ),
        origin=origin(None),
    )


def _verdict(found: FrictionMap) -> str:
    before, after = found.unexplained
    if found.name is None:
        return f"Friction is a straight line over speed: no effect bends it, and {share(before)} is left unexplained."
    values = ", ".join(f"{words(name)} {number(value, unit)}" for name, (value, unit) in effect_values(found).items())
    bent = f"{sentence(words(found.name))} ({values}) bends the curve"
    return f"{bent}: {share(before)} was unexplained without, {share(after)} with it."


def _answers(found: FrictionMap) -> dict[str, str]:
    base = base_values(found)
    friction = "; ".join(
        f"{words(name)} {number(*base[name])}" for name in map(found.kind.parameter, (COULOMB, VISCOUS)) if name in base
    )
    sure = f"Chance saves as much with probability {number(found.probability, digits=2)}; named below {CHANCE:g}."
    left = "Nothing that steady speeds would tell."
    if found.offset is None:
        left = "A constant offset is counted in the effect: such recordings do not tell them apart."
    return {"Friction?": friction, "How sure?": sure, "What is open?": left}


def _table(caption: str, values: Values) -> Table:
    columns = Heading(heading="quantity"), Heading(heading="value", number=True), Heading(heading="unit")
    rows = tuple((words(name), number(value), unit_text(unit)) for name, (value, unit) in values.items())
    return Table(caption=caption, columns=columns, rows=rows)


def _curves(found: FrictionMap) -> list[tuple[Curve, str, bool]]:
    """Curves that are drawn, what they are called, and whether an effect bends them."""
    plain = [(found.plain, "no effect", False)]
    return plain if found.name is None else [*plain, (found.best, words(found.name), True)]


def _over_speed(found: FrictionMap) -> Chart:
    effort, series = effort_word(found.effort_unit), []
    for curve, label, bent in _curves(found):
        for direction in (-1.0, 1.0):
            speeds = found.velocity[direction * found.velocity > 0.0]
            if speeds.size:
                x = np.sort(direction * np.geomspace(np.abs(speeds).min(), np.abs(speeds).max(), DRAWN))
                name = "" if any(one.name == label for one in series) else label
                series.append(_series(name, "line", "model" if bent else "left", x, curve.effort(x)))
    series.append(_series("recordings", "dots", "ink", found.velocity, found.effort))
    axes = Panel(x_label="speed", x_unit=unit_text(found.kind.speed_unit), series=tuple(series))
    alternative = f"{sentence(effort)} of each recording at its steady speed, and the curves fitted to them."
    return Chart(
        title="Friction.", alternative=alternative, y_label=effort, y_unit=unit_text(found.effort_unit), panels=(axes,)
    )


def _left(found: FrictionMap) -> Chart:
    series = tuple(
        _series(
            label,
            "dots" if bent else "rings",
            "model" if bent else "left",
            found.velocity,
            found.effort - curve.effort(found.velocity),
        )
        for curve, label, bent in _curves(found)
    )
    axes = Panel(x_label="speed", x_unit=unit_text(found.kind.speed_unit), series=series)
    alternative, unit = "What each curve leaves of the recordings.", unit_text(found.effort_unit)
    return Chart(title="What is left.", alternative=alternative, y_label="left", y_unit=unit, panels=(axes,))


def _series(
    name: str, style: Literal["dots", "rings", "line"], colour: Literal["ink", "model", "left"], x: Array, y: Array
) -> Series:
    return Series(name=name, style=style, colour=colour, x=tuple(x.tolist()), y=tuple(y.tolist()))
