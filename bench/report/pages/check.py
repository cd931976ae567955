"""The page of a check: whether an axis has changed, what did, by how many margins, and how sure that is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from bench.baseline.check import Checked
from bench.baseline.wording import described, headline
from bench.comparison.difference import CHANGED, SAME, UNDECIDED, Comparison
from bench.names import short, words
from bench.report.check import cells
from bench.report.document import (
    AnyPart,
    Colour,
    Document,
    Heading,
    Intervals,
    Paragraph,
    Points,
    Section,
    Span,
    Table,
    Tone,
)
from bench.report.numbers import effort_word, number, sentence, share, unit_text

COLOURS: dict[str, Colour] = {CHANGED: "model", UNDECIDED: "ink", SAME: "left"}
TONES: dict[str, Tone] = {SAME: "sure", UNDECIDED: "open", CHANGED: "refused"}
#: Margins to which the chart reaches at least, so that one is seen, and at most, so that small differences are.
LEAST, MOST = 2.0, 8.0
#: Characters of what a state rests on, and of a title made of file names.
LONG = 600


def check_page(checked: Checked, title: str) -> Document:
    """The page of a check.

    Args:
        checked: what was found.
        title: names of what is compared.
    """
    sections = [
        Section(key="comparisons", heading="What was compared", blocks=tuple(_compared(checked))),
        Section(key="conditions", heading="Like with like", blocks=(_conditions(checked),)),
    ]
    if checked.baseline.gaps or checked.now.gaps:
        sections.append(Section(key="gaps", heading="What the models leave", blocks=(_gaps(checked),)))
    return Document(
        title=f"{short(title)}: check",
        subject=short(title, LONG),
        verdict=_verdict(checked),
        tone=TONES[checked.result],
        answers=_answers(checked),
        sections=tuple(sections),
        origin=(_basis("now", checked.now.provenance), _basis("baseline", checked.baseline.provenance)),
    )


def _verdict(checked: Checked) -> str:
    line = unit_text(headline(checked))
    return f"Changed: {line[:1].lower()}{line[1:]}." if checked.result == CHANGED else f"{line}."


def _answers(checked: Checked) -> dict[str, str]:
    results = [one.result for one in checked.comparisons]
    count = ", ".join(f"{results.count(result)} {result}" for result in TONES if result in results)
    return {
        "What came or went?": _names(checked),
        "How many differ?": f"{count} of {len(results)} comparisons." if results else "Nothing could be compared.",
        "How sure?": _sure(checked),
        "What next?": _next(checked),
    }


def _names(checked: Checked) -> str:
    pairs = [*checked.appeared, *checked.gone]
    if pairs:
        return unit_text(sentence("; ".join(described(one, checked) for _, one in pairs))) + "."
    if not (checked.baseline.names and checked.now.names):
        return "Not asked: the baseline has parameters alone."
    kept = ", ".join(words(effect.label) for effect in checked.now.effects)
    return f"No effect; {kept} as in the baseline." if kept else "No effect: none is named in either state."


def _sure(checked: Checked) -> str:
    if not checked.false_alarm_rate:
        return "Two models are compared by what they say, without noise."
    return (
        f"Of axes that differ by no margin at most {share(checked.false_alarm_rate)} are called changed, all "
        f"{checked.family} comparisons together."
    )


def _next(checked: Checked) -> str:
    if checked.result == SAME:
        return "Nothing."
    if checked.result == CHANGED:
        return "Look at what changed; where the new state is right, accept it with --update."
    if checked.rig:
        return "Make the baseline anew: --update with recordings of the old state and the rig file of now."
    if checked.conditions:
        return "Record the motion of the baseline at its sampling, and check again."
    return "Record again, several times: a difference near its margin needs more than one recording to decide."


def _compared(checked: Checked) -> Iterator[AnyPart]:
    """The chart, and the table behind it, worst first."""
    spans = tuple(_spans(checked))
    if spans:
        reach = max(abs(end) for span in spans for end in (span.low, span.high))
        reach = min(max(reach, LEAST), MOST)
        yield Intervals(
            title="Differences over their margins.",
            alternative="Now less baseline with its interval of 95 %, as a multiple of the margin: within the band "
            f"it does not matter. A ring at the end of the scale lies beyond {number(reach, digits=2)} margins.",
            label="difference over margin",
            right=(-1.0, 1.0),
            limits=(-reach, reach),
            spans=spans,
        )
    yield _table(checked)


def _spans(checked: Checked) -> Iterator[Span]:
    for one in checked.comparisons:
        bounds, difference = one.difference95, one.difference
        if bounds is not None and difference is not None and one.margin > 0.0:
            low, value, high = (each / one.margin for each in (bounds[0], difference.value, bounds[1]))
            yield Span(name=_label(one), colour=COLOURS[one.result], value=value, low=low, high=high)


def _label(one: Comparison) -> str:
    return words(one.name).replace(".", ": ") + (f", {one.effect}" if one.effect else "")


def _table(checked: Checked) -> Table:
    comparisons = checked.comparisons
    held_back = any(one.held_back for one in comparisons)
    numbers = ("baseline", "now", "difference (95 %)", "margin")
    columns = [
        Heading(heading="quantity"),
        *(Heading(heading=heading, number=True) for heading in numbers),
        Heading(heading="unit"),
        Heading(heading="result"),
        *([Heading(heading="because", prose=True)] if held_back else []),
    ]
    rows = []
    for one in comparisons:
        _, *values, unit, result = cells(one)
        why = [one.held_back] if held_back else []
        rows.append((_label(one), *(value.replace("-", "−") for value in values), unit_text(unit), result, *why))
    marked = tuple(k for k, one in enumerate(comparisons) if one.result == CHANGED)
    return Table(caption="Worst first", columns=tuple(columns), rows=tuple(rows), marked=marked)


def _conditions(checked: Checked) -> AnyPart:
    lines = [f"rig: {line}" for line in checked.rig] + [
        f"not as in the baseline: {line}" for line in checked.conditions
    ]
    if lines:
        return Points(items=tuple(lines))
    if not checked.now.conditions:
        return Paragraph(text="Nothing beside the models differs: neither rests on a recording here.")
    return Paragraph(text="The rig, the motion and the sampling are those of the baseline.")


def _gaps(checked: Checked) -> Table:
    """What is left in both states, and their verdicts."""
    baseline, now = checked.baseline, checked.now
    rows: list[tuple[str, ...]] = [
        ("verdict", words(baseline.verdict) or "not asked", words(now.verdict) or "not asked", "")
    ]
    for name in dict.fromkeys([*baseline.gaps, *now.gaps]):
        gaps = [state.gaps.get(name) for state in (baseline, now)]
        unit = next(gap.unit for gap in gaps if gap is not None)
        what = effort_word(unit) if name == "torque" else words(name)
        for of, value in (("left", "after"), ("noise alone", "noise_floor")):
            both = ("–" if gap is None else number(getattr(gap, value), digits=3) for gap in gaps)
            rows.append((f"{what}, {of} (RMS)", *both, unit_text(unit)))
    columns = (
        Heading(heading="of"),
        Heading(heading="baseline", number=True),
        Heading(heading="now", number=True),
        Heading(heading="unit"),
    )
    return Table(
        caption="Verdicts, and what inertia, friction and effects do not explain", columns=columns, rows=tuple(rows)
    )


def _basis(label: str, provenance: Mapping[str, Any]) -> str:
    """What a state rests on, whatever its baseline file says of it."""
    return short(f"{label}: {', '.join(_leaves('', provenance))}", LONG)


def _leaves(name: str, value: object) -> Iterator[str]:
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from _leaves(str(key), inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _leaves(name, inner)
    elif value is not None:
        yield f"{words(name)} {value}"
