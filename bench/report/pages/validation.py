"""The page of a validation: how often intervals hold, how far off numbers are, and whether names are right."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from bench.names import words
from bench.report.confusion import Confusion
from bench.report.document import (
    AnyPart,
    Document,
    Heading,
    HeatMap,
    Intervals,
    Neighbour,
    Neighbours,
    Paragraph,
    Section,
    Span,
    Table,
)
from bench.report.numbers import number, sentence, share, unit_text
from bench.report.parts import origin
from bench.report.sheet import Sheet
from bench.report.validation import SYMBOLS, TITLES, bounded, by_name, covered, determined, names, outcomes
from bench.validation.coverage import LEVELS, Coverage
from bench.validation.naming import Naming
from bench.validation.validate import Validation

#: The level that the chart shows; the table has the others.
LEVEL = LEVELS[-1]
#: Share that the chart's scale begins at, where no bound lies below it; fewer runs than tell as much are too few.
FROM = 0.8
FEW = " More runs narrow these bounds."
TERM_WORDS = {"inertia": "inertia", "viscous": "viscous friction", "coulomb": "Coulomb friction"}
FILES = {
    "validation.json": "all of it, as data",
    "runs.csv": "what each run was, and what was said of it",
    "quantities.csv": "each quantity that a run tells, beside the truth",
}


def validation_page(found: Validation, provenance: Mapping[str, Any], command: str, own: bool) -> Document:
    """The page of a validation.

    Args:
        found: what was found.
        provenance: of it.
        command: that does the same again.
        own: whether the axis is one's own: then how well the motion determines it comes first.
    """
    first = _first(found)
    sections = [Section(key="coverage", heading="How often an interval holds the truth", blocks=tuple(_charts(found)))]
    if own:
        block = _table(determined(found.runs))
        sections.insert(0, Section(key="axis", heading="This motion on this drive", blocks=block))
    sections.append(Section(key="numbers", heading="How far off numbers are", blocks=tuple(_numbers(found))))
    if found.naming is not None:
        sections.append(Section(key="names", heading="Whether names are right", blocks=tuple(_naming(found.naming))))
    beside = Neighbours(files=tuple(Neighbour(name=name, about=about) for name, about in FILES.items()))
    sections.append(Section(key="runs", heading="All runs", blocks=(*_table(outcomes(found.runs)), beside)))
    low = any(one.inside[-1].bounds[1] < LEVEL for one in first)
    false = found.naming is not None and found.naming.false.count > 0
    return Document(
        title="Validation",
        subject=command,
        verdict=_verdict(first, found.naming),
        tone="open" if not _enough(first) or low or false else "sure",
        answers=_answers(found, first),
        sections=tuple(sections),
        origin=origin(provenance),
    )


def _first(found: Validation) -> list[Coverage]:
    """What `identify` tells of the first whole group of runs: those with the least hidden in them."""
    whole = [one for one in found.coverage if one.by == "identify" and one.whole and one.told]
    return [one for one in whole if one.group == whole[0].group]


def _enough(first: list[Coverage]) -> bool:
    """Whether there are so many runs that a level much below the one claimed would show."""
    return bool(first) and all(one.inside[-1].bounds[0] >= FROM for one in first)


def _verdict(first: list[Coverage], naming: Naming | None) -> str:
    if not first:
        verdict = "No run tells a quantity"
    else:
        shares = ", ".join(f"of {TERM_WORDS[one.quantity]} in {share(one.inside[-1].value)}" for one in first)
        verdict = f"Intervals of {share(LEVEL)} hold the truth {shares}, of {_runs(first[0])}"
    if naming is None:
        return f"{verdict}."
    false = naming.false
    return f"{verdict}; {false.count or 'none'} of {false.of} diagnosed runs {_has(false.count)} a false name."


def _runs(one: Coverage) -> str:
    hidden = "nothing" if one.group == "nulls" else one.group
    return f"{one.runs} {'run' if one.runs == 1 else 'runs'} with {hidden} hidden"


def _has(count: int) -> str:
    return "has" if count == 1 else "have"


def _answers(found: Validation, first: list[Coverage]) -> dict[str, str]:
    status = Counter(run.status for run in found.runs)
    counts = ", ".join(f"{count} {words(name)}" for name, count in status.most_common())
    far = ", ".join(f"{TERM_WORDS[one.quantity]} {share(one.typical)}" for one in first) or "not known"
    bounds = "; ".join(f"{TERM_WORDS[one.quantity]} {bounded(one.inside[-1])}" for one in first) or "not known"
    answers = {
        "How far off are numbers?": f"RMS error over the true value: {far}.",
        f"In their {share(LEVEL)} interval?": f"{bounds} (bounds of 95 %).{'' if _enough(first) else FEW}",
    }
    if found.naming is not None:
        answers["Named exactly?"] = f"{bounded(found.naming.exact)} of {found.naming.exact.of} runs."
    answers["Runs?"] = f"{len(found.runs)}: {counts}."
    return answers


def _charts(found: Validation) -> Iterator[AnyPart]:
    """Share of intervals that hold the truth with its bounds, by quantity and group of runs."""
    shown = [one for one in found.coverage if one.quantity in SYMBOLS and one.told]
    if not shown:
        yield Paragraph(text="No run tells a quantity.")
    least = min((one.inside[-1].bounds[0] for one in shown), default=FROM)
    for quantity, symbol in SYMBOLS.items():
        spans = tuple(_span(one) for one in shown if one.quantity == quantity)
        if spans:
            yield Intervals(
                title=f"{sentence(TERM_WORDS[quantity])}, {symbol}.",
                alternative=f"Share of the intervals of {share(LEVEL)} that hold the truth, by groups of runs, "
                "with bounds of 95 %; the line is what they claim.",
                label=f"in their {share(LEVEL)} interval",
                unit="%",
                right=(100.0 * LEVEL, 100.0 * LEVEL),
                limits=(100.0 * min(FROM, least), 100.0),
                spans=spans,
            )


def _span(one: Coverage) -> Span:
    held = one.inside[-1]
    low, value, high = (100.0 * each for each in (held.bounds[0], held.value, held.bounds[1]))
    colour = "ink" if one.by == "identify" else "model"
    return Span(name=f"{one.by}: {one.group}", colour=colour, value=value, low=low, high=high)


def _numbers(found: Validation) -> Iterator[AnyPart]:
    for by, title in TITLES.items():
        some = [one for one in found.coverage if one.by == by]
        if some:
            yield from _table(covered(some, title))


def _naming(found: Naming) -> Iterator[AnyPart]:
    yield from _table(names(found))
    if found.named:
        yield from _table(by_name(found))
    if found.confusion:
        yield _matrix(Confusion.of(found.confusion))
    columns = Heading(heading="hidden"), Heading(heading="said, and how often", prose=True)
    rows = tuple((words(hidden), _counts(counts)) for hidden, counts in found.confusion.items())
    yield Table(caption="What is said where one effect is hidden, or nothing", columns=columns, rows=rows)


def _matrix(found: Confusion) -> HeatMap:
    return HeatMap(
        caption="Hidden down, said across: how often, coloured by the share of what is said in a row; "
        "the right answer is framed",
        corner="hidden",
        rows=found.hidden,
        columns=found.said,
        counts=tuple(map(tuple, found.counts.tolist())),
    )


def _counts(counts: Mapping[str, int]) -> str:
    ordered = sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))
    return ", ".join(f"{words(name)} {number(count)}" for name, count in ordered)


def _table(sheet: Sheet) -> tuple[AnyPart, ...]:
    """A sheet, with its note below."""
    columns = tuple(Heading(heading=one, number=place >= sheet.words) for place, one in enumerate(sheet.headings))
    rows = tuple(tuple("–" if cell == "-" else unit_text(cell) for cell in row) for row in sheet.rows)
    notes = (Paragraph(text=sheet.note),) if sheet.note else ()
    return Table(caption=sheet.title, columns=columns, rows=rows), *notes
