"""Why a diagnosis is incomplete, in words."""

from __future__ import annotations

from typing import Any

from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.name import with_interval
from bench.diagnosis.verdict import Objection
from bench.names import words


def reasons(found: Diagnosis) -> list[str]:
    """Each objection in a line, the gravest first; none where the verdict is that nothing more is missing."""
    return [reason(one) for one in found.objections]


def reason(one: Objection) -> str:
    """An objection in a line."""
    figures: dict[str, Any] = dict(one.figures)
    match one.criterion:
        case "residual":
            return f"the torque residual is {figures['times_noise']:.3g} times the noise"
        case "refused":
            return f"{words(figures['parameter'])} is not determined: {figures['reason']}"
        case "excluded":
            return "an excluded effect was found"
        case "moves_otherwise":
            gap = f"{figures['after']:.3g} {figures['unit']} RMS"
            return f"the simulated speed differs by {gap}, {figures['times_noise']:.2g} times the noise"
        case "moves_worse":
            change = f"{figures['before']:.3g} -> {figures['after']:.3g} {figures['unit']}"
            return f"simulated motion of the {figures['recording']} is worse with it: {change}"
        case "undetermined":
            of = f"{figures['effect']}: " if "effect" in figures else ""
            return f"{of}{with_interval(figures['quantity'], figures['found'])} is not determined"
        case "negative":
            return f"{with_interval(figures['quantity'], figures['found'])} is negative"
        case "holdout":
            other = f"that of the recording {figures['recording']:.3g}"
            return f"the residual of the holdout is {figures['holdout']:.3g} {figures['unit']}, {other}"
        case "likelier":
            likely, nothing = (f"({100.0 * figures[key]:.0f} %)" for key in ("probability", "nothing"))
            return f"{words(figures['name'])} is more likely {likely} than no missing effect {nothing}"
    return figures["reason"]
