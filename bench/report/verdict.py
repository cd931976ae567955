"""Why a diagnosis is incomplete, and why an effect is in the model or is not, in words."""

from __future__ import annotations

from typing import Any

from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.policy import Reason
from bench.names import words
from bench.parameter import Parameter
from bench.report.numbers import interval

#: Criteria that have no figures.
PLAIN = {
    "withheld": "an excluded effect was found",
    "excluded": "excluded",
    "removed": "added and removed again: the others explain it too, or another set is more likely",
    "invisible": "this recording cannot show it",
    "chance": "no more than chance",
    "impossible": "it fits only with values that are physically impossible",
    "damps": "it takes no more than noise that it damps",
    "misplaced": "links a degree off their encoder explain it, too",
    "small": "it explains too small a part of what remains",
    "others": "others explain more",
    "same_as_added": "the recording does not distinguish it from an added effect",
    "no_sign": "nothing in the recording points to it",
}


def reasons(found: Diagnosis) -> list[str]:
    """Each objection in a line, the gravest first; none where the verdict is that nothing more is missing."""
    return [reason(one) for one in found.objections]


def reason(one: Reason) -> str:
    """A criterion with its figures in a line."""
    figures: dict[str, Any] = dict(one.figures)
    match one.criterion:
        case "accepted":
            return ", ".join(f"{words(key)} {value:.3g}" for key, value in figures.items()) or "named"
        case "alike":
            return f"this recording does not distinguish it from {words(figures['effect'])}"
        case "grows":
            where = f"of the {figures['recording']}" if "recording" in figures else "under the rig's drive"
            change = f"{figures['before']:.3g} -> {figures['after']:.3g} {figures['unit']}".rstrip()
            return f"the {figures['gap']} gap {where} grows with it: {change}"
        case "residual":
            return f"the residual is {figures['times_noise']:.3g} times the noise"
        case "refused":
            return f"{words(figures['parameter'])} is not determined: {figures['reason']}"
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
    return PLAIN[one.criterion] if one.criterion in PLAIN else figures["reason"]


def with_interval(name: str, found: Parameter) -> str:
    """A quantity with half of its interval in words."""
    return f"{words(name)} ({interval(found)})"
