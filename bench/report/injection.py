"""Known effects put into a recording: what was named, and how large each has to be; as JSON and as a document."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from bench.names import words
from bench.report import document as doc
from bench.report.numbers import interval, number, sentence, share, unit_text
from bench.report.parts import origin
from bench.report.serial import picked, serialised
from bench.validation.into import FATES, PART, RIGHT, SPAN, WRONG, Injection, Injections

SCHEMA = "bench.validate.into/1"
NOTE = (
    "One effect at a time was put into the recording; the motion is unchanged. strength: the torque of it that "
    "inertia and friction cannot take up, RMS, relative to the residual of the recording's own diagnosis. "
    "right: named, and nothing else is new; part: something else, too; flagged: a remainder without the name, "
    "or a refusal; missed: neither; wrong: only another name. "
    "inside: quantities whose interval of 95 % contains the truth."
)


def injections_json(found: Injections, provenance: Mapping[str, Any]) -> str:
    """The whole, as the contract's JSON."""
    own, counts = found.own, _counts(found)
    content = {
        "schema": SCHEMA,
        "recording": {"verdict": own.verdict, "effects": own.names, "left": {"value": own.left, "unit": own.unit}},
        "fates": [{"strength": strength, **counted} for strength, counted in counts.items()],
        "cases": [_case(case, own.unit) for case in found.cases],
        "unable": found.unable,
        "failed": found.failed,
        "provenance": provenance,
    }
    if found.sought:
        content["least_named"] = {
            name: None if case is None else {"value": case.size, **picked(case, "unit", "quantity", "strength")}
            for name, case in found.least.items()
        }
    return serialised(content)


def _case(case: Injection, unit: str) -> dict[str, Any]:
    size = {"quantity": case.quantity, "value": case.size, "unit": case.unit}
    quantities = {one.quantity: {"true": one.true, "found": one.parameter} for one in case.scored}
    return {
        **picked(case, "effect", "strength"),
        "size": size,
        "torque": {"value": case.torque, "unit": unit},
        **picked(case, "fate", "names"),
        "verdict": case.verdict or None,
        "reason": case.reason or None,
        "quantities": quantities,
    }


def _counts(found: Injections) -> dict[float, dict[str, int]]:
    """How often each fate befell the cases of a strength, the strengths that were asked for alone."""
    strengths = () if found.sought else sorted({case.strength for case in found.cases})
    counts = Counter((case.strength, case.fate) for case in found.cases)
    return {strength: {fate: counts[strength, fate] for fate in FATES} for strength in strengths}


def injections(found: Injections, provenance: Mapping[str, Any], recording: str) -> doc.Document:
    """The document of what became of effects in a recording."""
    least = [_least(found)] if found.sought else []
    tried = (_cases(found), doc.Paragraph(text=NOTE))
    wrong = any(case.fate in (WRONG, PART) for case in found.cases)
    return doc.Document(
        title=f"Effects in {recording}",
        subject=f"Known effects in {recording}",
        verdict=_verdict(found),
        tone="open" if wrong or found.failed else "sure",
        answers=dict(_answers(found)),
        sections=doc.sections(
            doc.section("least", "The least that is named", *least),
            doc.section("cases", "All that was tried", *tried, detail=found.sought),
        ),
        origin=origin(provenance),
        files_in_folder={"injections.json": injections_json(found, provenance) + "\n"},
        warnings=tuple(f"{name} gave no result: {reason}" for name, reason in found.failed.items()),
    )


def _verdict(found: Injections) -> str:
    if found.sought:
        named = sum(case is not None for case in found.least.values())
        return f"This recording shows {named} of the {len(found.least)} effects that were put into it."
    rates = (f"{counted[RIGHT]} of {sum(counted.values())} at {s:g} times" for s, counted in _counts(found).items())
    return sentence(f"{', '.join(rates) or 'nothing'} its own residual named rightly.")


def _answers(found: Injections) -> Iterator[tuple[str, str]]:
    own = found.own
    names = ", ".join(map(words, own.names)) or "no effect"
    yield "What is its own residual?", f"{number(own.left, own.unit)} RMS, after {names} ({words(own.verdict)})."
    wrong = (case for case in found.cases if case.fate in (WRONG, PART))
    false = "; ".join(f"{', '.join(map(words, case.names))} of {words(case.effect)}" for case in wrong)
    yield "False names?", f"{sentence(false or 'none')}."
    inside = [one.inside(0.95) for case in found.cases for one in case.scored]
    if inside:
        yield "Are sizes right?", f"{sum(inside)} of {len(inside)} quantities within their interval of {share(0.95)}."
    if found.unable:
        unable = sentence(", ".join(map(words, found.unable)))
        yield "Not tried?", f"{unable}: it has them, or cannot have them so large."
    if any(case.fate in (WRONG, PART) for case in found.cases):
        yield "What next?", "Confirm names of these effects in such a recording with a holdout of another motion."
    else:
        yield "What next?", "Effects smaller than these need a longer recording or less noise of the sensors."


def _least(found: Injections) -> doc.Table:
    """By effect how large it has to be."""
    rows = [
        (words(name), *((words(case.quantity), *_size(case)) if case else ("", f"not up to {SPAN[1]:g} times", "", "")))
        for name, case in found.least.items()
    ]
    headings = ("effect", "quantity", "named from>", "unit", "strength>")
    return doc.table("Tried, not estimated: the smallest of each effect that was named", headings, rows)


def _size(case: Injection) -> tuple[str, str, str]:
    return number(case.size, digits=3), unit_text(case.unit), f"{case.strength:.2g}"


def _cases(found: Injections) -> doc.Table:
    rows = [
        (
            words(case.effect),
            *_size(case),
            case.fate,
            ", ".join(map(words, case.names)),
            f"{sum(one.inside(0.95) for one in case.scored)}/{len(case.scored)}" if case.scored else "",
            "; ".join(f"{words(one.quantity)} {interval(one.parameter)}" for one in case.scored) or case.reason,
        )
        for case in found.cases
    ]
    marked = (place for place, case in enumerate(found.cases) if case.fate in (WRONG, PART))
    headings = ("effect", "size>", "unit", "strength>", "fate", "named", "inside>", "as found~")
    return doc.table("What was put in, and what was found", headings, rows, marked)
