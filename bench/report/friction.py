"""`bench friction`: friction over steady speeds as JSON (`bench.friction/1`), as a table and as a figure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from rich import box
from rich.table import Table

from bench.axis_kind import COULOMB, OFFSET, VISCOUS
from bench.effects.catalogue import catalogue
from bench.friction_map.map import CHANCE, FrictionMap
from bench.names import words
from bench.report.figures import MEASURED, MODELLED, REST, in_style, legend_above, save_as_named, title_figure
from bench.report.gate import checks_json
from bench.report.numbers import effort_word, unit_text
from bench.structured import json_text

SCHEMA = "bench.friction/1"
#: Speeds at which a curve is drawn, in each direction.
DRAWN = 400


def friction_json(found: FrictionMap) -> str:
    """The map, what holds of it and how sure that is."""
    effect = None if found.name is None else {"name": found.name, "parameters": _numbers(effect_values(found))}
    before, after = found.unexplained
    content = {
        "schema": SCHEMA,
        "parameters": _numbers(base_values(found)),
        "effect": effect,
        "best": found.best.name or None,
        "chance": found.probability,
        "unexplained": {"before": before, "after": after},
        "checks": checks_json(found.checks),
        "velocity": {"unit": found.kind.speed_unit, "values": found.velocity.tolist()},
        "effort": {"unit": found.effort_unit, "values": found.effort.tolist()},
    }
    return json_text(content)


def friction_table(found: FrictionMap, title: str) -> Table:
    """Quantities of the curve that holds; below it how sure the effect is and what it explains."""
    before, after = found.unexplained
    label = words(found.best.name)
    if found.name is not None:
        verdict = f"named: {label}; chance saves as much with probability {found.probability:.2g}"
    elif label:
        verdict = f"no effect named: {label} is best, chance saves as much with probability {found.probability:.2g}"
    else:
        verdict = "no effect named: physics allows none of them here"
    low, high = np.abs(found.velocity).min(), np.abs(found.velocity).max()
    caption = [
        f"{verdict} (named below {CHANCE:g})",
        f"unexplained share of the effort: {before:.4f} without, {after:.4f} with it",
        f"{found.velocity.size} recordings, {low:.3g} to {high:.3g} {found.kind.speed_unit}",
    ]
    if found.offset is None:
        caption.append("a constant offset is counted in the effect: no such recordings tell them apart")
    table = Table(
        title=title, caption="\n".join(caption), title_justify="left", caption_justify="left", box=box.SIMPLE_HEAD
    )
    for heading in ("effect", "quantity"):
        table.add_column(heading, no_wrap=True)
    table.add_column("value", justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for owner, quantities in (("", base_values(found)), (found.name or "", effect_values(found))):
        for name, (value, unit) in quantities.items():
            table.add_row(owner, words(name), f"{value:.5g}", unit)
            owner = ""
    return table


def draw_friction(found: FrictionMap, title: str, path: Path) -> None:
    """Write effort over speed: the recordings, the curve without an effect and, where one is named, the curve with it.

    Raises:
        InputError: an ending that is no figure's, or a place that cannot be written to.
    """
    save_as_named(friction_figure(found, title), path)


@in_style
def friction_figure(found: FrictionMap, title: str) -> Figure:
    """Effort over speed, and what each curve leaves of it."""
    figure = Figure(figsize=(9.0, 7.0), layout="constrained")
    title_figure(figure, title)
    over, rest = figure.subplots(2, 1, sharex=True, height_ratios=(2.0, 1.0))
    over.plot(found.velocity, found.effort, "o", ms=4.5, color=MEASURED, label="recordings")
    curves = [(found.plain, "no effect", REST, "s")]
    if found.name is not None:
        curves.append((found.best, words(found.name), MODELLED, "o"))
    for curve, label, colour, marker in curves:
        for direction in (-1.0, 1.0):
            speeds = direction * np.abs(found.velocity[direction * found.velocity > 0.0])
            drawn = direction * np.geomspace(np.abs(speeds).min(), np.abs(speeds).max(), DRAWN)
            over.plot(drawn, curve.effort(drawn), lw=1.3, color=colour, label=label if direction > 0.0 else None)
        left = found.effort - curve.effort(found.velocity)
        rest.plot(found.velocity, left, marker, ms=4.0, color=colour, label=label)
    rest.axhline(0.0, color="#8a94a0", lw=0.8)
    over.set_ylabel(f"{effort_word(found.effort_unit)} / {unit_text(found.effort_unit)}")
    rest.set_ylabel(f"left / {unit_text(found.effort_unit)}")
    rest.set_xlabel(f"speed / ({unit_text(found.kind.speed_unit)})")
    for axes in (over, rest):
        legend_above(axes)
    return figure


def base_values(found: FrictionMap) -> dict[str, tuple[float, str]]:
    """K_w, K_0 and M_0 by their names, with their units."""
    columns = {VISCOUS: found.base.viscous, COULOMB: found.base.coulomb}
    if found.offset is not None:
        columns[OFFSET] = found.offset
    return {
        found.kind.parameter(column): (value, found.kind.parameter_unit(column, found.effort_unit))
        for column, value in columns.items()
    }


def effect_values(found: FrictionMap) -> dict[str, tuple[float, str]]:
    """Quantities of the effect that is named, with their units; none where none is."""
    if found.name is None:
        return {}
    quantities = {quantity.name: quantity for quantity in catalogue()[found.name].quantities}
    return {name: (value, found.kind.unit(quantities[name], found.effort_unit)) for name, value in found.values.items()}


def _numbers(quantities: dict[str, tuple[float, str]]) -> dict[str, Any]:
    return {name: {"value": value, "unit": unit} for name, (value, unit) in quantities.items()}
