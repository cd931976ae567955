"""The result of a check in sentences: what changed, by how much, and how certain that is."""

from __future__ import annotations

import math

from bench.baseline.check import Checked
from bench.baseline.model import RESPONSE_TORQUE
from bench.baseline.state import GAPS, NamedHere
from bench.comparison.difference import CHANGED, SAME, Comparison, Measured
from bench.names import words

#: Units shown in another one, with the factor.
DISPLAYED = {"rad": ("deg", 180.0 / math.pi)}
#: Quantities that change as a consequence of others.
FOLLOWING = frozenset({*GAPS, RESPONSE_TORQUE})


def headline(checked: Checked) -> str:
    """What changed, in one line; or that nothing did, or why it is undecided."""
    if checked.result == CHANGED:
        return _sentence(_changes(checked))
    if checked.result == SAME:
        return "The same: no quantity differs by more than its margin"
    if checked.rig:
        return f"Undecided, as the rig differs: {'; '.join(checked.rig)}"
    open_ = [described(one, checked) for one in checked.comparisons if one.result != SAME]
    if checked.baseline.verdict != checked.now.verdict:
        verdicts = (words(one) for one in (checked.baseline.verdict, checked.now.verdict))
        open_.append(f"the verdict is {' -> '.join(verdicts)}")
    motion = [f"motion or sampling differ ({', '.join(checked.conditions)})"] if checked.conditions else []
    return f"Undecided: {'; '.join([*motion, *open_])}"


def _changes(checked: Checked) -> list[str]:
    """What changed: names, then parameters; gaps only if nothing else did."""
    changed = [one for one in checked.comparisons if one.result == CHANGED]
    changed.sort(key=lambda one: not one.effect)
    parts = [one for one in changed if one.name not in FOLLOWING] or changed
    return [described(one, checked) for one in parts]


def _sentence(parts: list[str]) -> str:
    joined = parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])}, and {parts[-1]}"
    return f"{joined[:1].upper()}{joined[1:]}"


def described(one: Comparison, checked: Checked) -> str:
    """One comparison in words."""
    label = words(one.name).replace(".", " ")
    effect = next((effect for effect, found in (*checked.appeared, *checked.gone) if found is one), None)
    if effect is not None:
        return f"{label} {_came_or_went(one)}: {_values(effect)}{_why(one)}"
    if one.baseline is None or one.now is None:
        return f"{label} cannot be compared{_why(one)}"
    before, after = formatted(one.baseline, one.unit), formatted(one.now, one.unit)
    unit = displayed_unit(one.unit)
    share = f" ({100.0 * (one.now / one.baseline - 1.0):+.3g} %)" if one.baseline else ""
    if one.result == CHANGED:
        verb = "rose" if one.now > one.baseline else "fell"
        return f"{label} {verb} from {before} to {after}{unit}{share}"
    how = "is the same:" if one.result == SAME else "may have changed:"
    return f"{label} {how} {before} and now {after}{unit}{share}{_why(one)}"


def _came_or_went(one: Comparison) -> str:
    if one.effect == "appeared":
        return "appeared" if one.result == CHANGED else "is named now"
    return "is gone, which had" if one.result == CHANGED else "is named no more, which had"


def _why(one: Comparison) -> str:
    """Why a comparison is undecided, or how certain it is that an effect appeared."""
    unit = displayed_unit(one.unit)
    if one.held_back:
        return f", but {one.held_back}"
    if one.effect == "appeared" and one.differences:
        makes, least = formatted(one.now or 0.0, one.unit), formatted(one.margin, one.unit)
        seen = "would have shown" if one.result == CHANGED else "may have hidden"
        return f" ({makes}{unit} RMS, where the baseline {seen} {least}{unit})"
    bounds = one.difference95
    if one.result != CHANGED and one.result != SAME and bounds is not None:
        reach, margin = (formatted(value, one.unit) for value in (0.5 * (bounds[1] - bounds[0]), one.margin))
        return f", known to ± {reach}{unit} against a margin of {margin}{unit}"
    return ""


def _values(effect: NamedHere) -> str:
    """Quantities of an effect, without angles, whose zero is arbitrary, and without those in its label."""
    counted = {slot.quantity.name for slot, _ in effect.whole}
    names = [q.name for q in effect.effect.quantities if not q.angle and q.name not in counted]
    return ", ".join(f"{name.replace('_', ' ')} {with_unit(effect.quantities[name])}" for name in names)


def with_unit(found: Measured) -> str:
    """A value with its unit, for display."""
    return f"{formatted(found.value, found.unit)}{displayed_unit(found.unit)}"


def displayed_unit(unit: str) -> str:
    """The unit behind a number, for display; empty for a dimensionless one."""
    return "" if unit == "dimensionless" else f" {DISPLAYED[unit][0] if unit in DISPLAYED else unit}"


def formatted(value: float, unit: str) -> str:
    """A number in the unit for display."""
    return f"{value * (DISPLAYED[unit][1] if unit in DISPLAYED else 1.0):.4g}"
