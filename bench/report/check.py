"""A check as JSON (contract `bench.check/1`) and as a table for a person."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from rich import box
from rich.table import Table

from bench.baseline.check import Checked
from bench.baseline.state import NamedHere, RemainingGap, State
from bench.baseline.wording import DISPLAYED, described, formatted, headline
from bench.comparison.difference import SAME, Comparison, Measured
from bench.structured import json_text

SCHEMA = "bench.check/1"


def check_json(checked: Checked, provenance: Mapping[str, Any]) -> str:
    """The check as the contract's JSON.

    Args:
        checked: what was found.
        provenance: of the state now; the baseline's stands beside it.
    """
    return json_text(
        {
            "schema": SCHEMA,
            "result": checked.result,
            "says": headline(checked),
            "false_alarm_rate": checked.false_alarm_rate,
            "comparisons": checked.family,
            "quantities": [_comparison(one) for one in checked.comparisons if not one.effect],
            "effects": {
                "appeared": [_effect(*pair) for pair in checked.appeared],
                "gone": [_effect(*pair) for pair in checked.gone],
            },
            "verdict": {"baseline": checked.baseline.verdict or None, "now": checked.now.verdict or None},
            "gap": _gaps(checked.baseline, checked.now),
            "rig": list(checked.rig),
            "conditions": list(checked.conditions),
            "provenance": {**provenance, "baseline": dict(checked.baseline.provenance)},
        }
    )


def _comparison(one: Comparison) -> dict[str, Any]:
    bounds, difference = one.difference95, one.difference
    return {
        "name": one.name,
        "unit": one.unit,
        "baseline": one.baseline,
        "now": one.now,
        "difference95": None if bounds is None else list(bounds),
        "std_error": None if difference is None else difference.std_error,
        "margin": one.margin,
        "chance": one.chance,
        "result": one.result,
        "because": one.held_back or None,
    }


def _effect(effect: NamedHere, one: Comparison) -> dict[str, Any]:
    """An effect that came or went; how sure that is: its torque against what the other state would have shown."""
    torque = {"unit": one.unit, "baseline": one.baseline, "now": one.now, "margin": one.margin}
    return {
        "name": effect.name,
        "parameters": {key: _measured(found) for key, found in effect.quantities.items()},
        "ambiguous_with": list(effect.ambiguous_with),
        "result": one.result,
        "because": one.held_back or None,
        "evidence": {
            "torque": torque if one.unit else None,
            "chance": one.chance,
            "gain": effect.gain if math.isfinite(effect.gain) else None,
        },
    }


def _measured(found: Measured) -> dict[str, Any]:
    error = found.std_error if math.isfinite(found.std_error) else None
    return {"value": found.value, "unit": found.unit, "std_error": error}


def _gaps(baseline: State, now: State) -> dict[str, Any]:
    def gap_json(gap: RemainingGap | None) -> dict[str, float] | None:
        return None if gap is None else {"after": gap.after, "noise_floor": gap.noise_floor}

    names = dict.fromkeys([*baseline.gaps, *now.gaps])
    return {
        name: {
            "unit": (now.gaps.get(name) or baseline.gaps[name]).unit,
            "baseline": gap_json(baseline.gaps.get(name)),
            "now": gap_json(now.gaps.get(name)),
        }
        for name in names
    }


def check_table(checked: Checked, title: str) -> Table:
    """Every comparison with its answer, worst first."""
    caption = [headline(checked)]
    caption += [f"rig: {line}" for line in checked.rig]
    caption += [f"not as in the baseline: {line}" for line in checked.conditions]
    if checked.false_alarm_rate:
        caption.append(
            f"{checked.family} comparisons; of axes that differ by no margin at most {checked.false_alarm_rate:.2%} "
            "are called changed"
        )
    table = Table(
        title=title, caption="\n".join(caption), title_justify="left", caption_justify="left", box=box.SIMPLE_HEAD
    )
    table.add_column("quantity")
    for heading in ("baseline", "now", "difference (95 %)", "margin"):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    table.add_column("", no_wrap=True)
    for one in checked.comparisons:
        table.add_row(*cells(one))
    return table


def cells(one: Comparison) -> list[str]:
    """A comparison as a row: quantity, baseline, now, difference, margin, unit, result."""

    def number(value: float | None) -> str:
        return "-" if value is None else formatted(value, one.unit)

    bounds = one.difference95
    difference = "-" if bounds is None else f"{number(bounds[0])} to {number(bounds[1])}"
    unit = DISPLAYED[one.unit][0] if one.unit in DISPLAYED else one.unit.replace("dimensionless", "")
    label = f"{one.name.replace('_', ' ')}{f' ({one.effect})' if one.effect else ''}"
    margin = number(one.margin) if bounds is not None else "-"
    return [label, number(one.baseline), number(one.now), difference, margin, unit, one.result]


def sentences(checked: Checked) -> list[tuple[Comparison, str]]:
    """A sentence for each comparison that is not the same, worst first."""
    return [(one, described(one, checked)) for one in checked.comparisons if one.result != SAME]
