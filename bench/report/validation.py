"""A validation: how often intervals hold, how far off numbers are, and whether names are right.

As JSON (`bench.validate/1`), as a document, and run by run as CSV and Parquet.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import csv

from bench.arrays import NORMAL95
from bench.files import held, whole
from bench.names import words
from bench.report import document as doc
from bench.report.numbers import SPACE, number, sentence, share, unit_text
from bench.report.parts import origin
from bench.report.publish import markdown, write_document
from bench.report.serial import as_json, known, picked, serialised
from bench.validation.coverage import LEVELS, NOTHING, NOTHING_MISSING, Coverage, Naming, Run, Share
from bench.validation.validate import Validation

SCHEMA = "bench.validate/1"
#: Terms of the equation of motion as tables have them, and in words.
SYMBOLS = {"inertia": "J", "viscous": "K_w", "coulomb": "K_0"}
TERM_WORDS = {"inertia": "inertia", "viscous": "viscous friction", "coulomb": "Coulomb friction"}
TITLES = {
    "identify": "identify: how far off, and how often an interval contains the truth",
    "diagnose": "diagnose: the same, after it added what it named",
}
NOTE = (
    "known: runs that give the quantity, of all. Over the true value: bias with its interval, RMS error, median half "
    "width of the interval of 95 %; ±/RMS by root mean squares, 1.96 of a normal distribution's. 50 %, 80 %, 95 %: "
    "share of the intervals of that level that contain the true value; bounds: 95 % of the last, Clopper-Pearson."
)
#: The level that the page's chart shows; the table has the others.
LEVEL = LEVELS[-1]
#: Share that the chart's scale begins at, where no bound lies below it; fewer runs than show as much are too few.
FROM = 0.8
NO_QUANTITY = "No run determines a quantity."
FEW = " More runs narrow these bounds."
#: Shares and counts of names as JSON has them, in its order.
NAMING = {
    "nulls_with_false_name": "nulls",
    "nulls_by_motion": "nulls_by_motion",
    "with_false_name": "false",
    "with_false_name_explained": "silent",
    "named_exactly": "exact",
    "refused": "refused",
    "named": "named",
    "falsely_named": "falsely",
    "confusion": "confusion",
}
#: The result of a diagnosis for a run, as a table has it.
SAID = ("verdict", "named", "false", "missed", "diagnose_reason")
FILES = {
    "validation.json": "all of it, as data",
    "runs.csv": "what each run was, and what was found in it",
    "quantities.csv": "each quantity that a run determines, with its true value",
}


def validation_json(found: Validation, provenance: Mapping[str, Any]) -> str:
    """The whole, as the contract's JSON; nan is null."""
    status, naming = Counter(run.status for run in found.runs), found.naming
    return serialised(
        {
            "schema": SCHEMA,
            "runs": {"asked": len(found.runs), **{name: status[name] for name in ("done", "refused", "failed")}},
            "coverage": found.coverage,
            "naming": naming and {key: getattr(naming, name) for key, name in NAMING.items()},
            "provenance": provenance,
        }
    )


@as_json.register
def _(found: Coverage) -> dict[str, Any]:
    plain = {name: known(each) if isinstance(each, float) else each for name, each in vars(found).items()}
    inside = [{"level": level, **as_json(each)} for level, each in zip(LEVELS, found.inside, strict=True)]
    del plain["inside"]
    return {**plain, "inside": inside}


@as_json.register
def _(found: Share) -> dict[str, Any]:
    return {**picked(found, "count", "of"), "share": found.value if found.of else None, "bounds95": found.bounds}


def validation(found: Validation, provenance: Mapping[str, Any], command: str, own: bool) -> doc.Document:
    """The document of a validation that `command` does again; on one's own axis how well it is known comes first."""
    first, naming, note, runs = _first(found), found.naming, doc.Paragraph(text=NOTE), _outcomes(found.runs)
    numbers, parts = (_numbers(found, whole) for whole in (True, False))
    names = [] if naming is None else [*_naming(naming)]
    charts = [chart for quantity in SYMBOLS if (chart := _chart(found, quantity, -1)).spans]
    coverage = charts or [doc.Paragraph(text=NO_QUANTITY)]
    tables = filter(None, map(markdown, (runs, *numbers, *parts, note, *names)))
    text = "\n\n".join([f"# Validation\n\n`{command}`", *tables])
    low = any(one.inside[-1].bounds[1] < LEVEL for one in first)
    false = naming is not None and naming.false.count > 0
    return doc.Document(
        title="Validation",
        subject=command,
        verdict=_verdict(first, naming),
        tone="open" if not _enough(first) or low or false else "sure",
        answers=dict(_answers(found, first)),
        sections=doc.sections(
            doc.section("axis", "This motion on this drive", *(_determined(found.runs) if own else ())),
            doc.section("coverage", "How often an interval contains the truth", *coverage),
            doc.section("numbers", "How far off numbers are", *numbers, note),
            doc.section("parts", "The same, by parts of these runs", *parts, detail=True),
            doc.section("names", "Whether names are right", *names),
            doc.section("runs", "All runs", runs, doc.neighbours(FILES)),
        ),
        origin=origin(provenance),
        pictures=tuple(_pictures(found)),
        files_in_folder={"validation.json": validation_json(found, provenance) + "\n", "validation.md": text + "\n"},
    )


def _first(found: Validation) -> list[Coverage]:
    """The results of `identify` for the first whole group of runs: those with the least hidden in them."""
    groups = [one for one in found.coverage if one.by == "identify" and one.whole and one.told]
    return [one for one in groups if one.group == groups[0].group]


def _enough(first: list[Coverage]) -> bool:
    """Whether there are so many runs that a level much below the one claimed would show."""
    return bool(first) and all(one.inside[-1].bounds[0] >= FROM for one in first)


def _verdict(first: list[Coverage], naming: Naming | None) -> str:
    if not first:
        verdict = "No run determines a quantity"
    else:
        shares = ", ".join(f"of {TERM_WORDS[one.quantity]} in {share(one.inside[-1].value)}" for one in first)
        runs, hidden = first[0].runs, "nothing" if first[0].group == "nulls" else first[0].group
        of = f"{runs} {'run' if runs == 1 else 'runs'} with {hidden} hidden"
        verdict = f"Intervals of {share(LEVEL)} contain the true value {shares}, of {of}"
    if naming is None:
        return f"{verdict}."
    false = naming.false
    has = "has" if false.count == 1 else "have"
    return f"{verdict}; {false.count or 'none'} of {false.of} diagnosed runs {has} a false name."


def _answers(found: Validation, first: list[Coverage]) -> Iterator[tuple[str, str]]:
    far = ", ".join(f"{TERM_WORDS[one.quantity]} {share(one.typical)}" for one in first) or "not known"
    yield "How far off are numbers?", f"RMS error over the true value: {far}."
    bounds = "; ".join(f"{TERM_WORDS[one.quantity]} {_bounded(one.inside[-1])}" for one in first) or "not known"
    yield f"In their {share(LEVEL)} interval?", f"{bounds} (bounds of 95 %).{'' if _enough(first) else FEW}"
    if found.naming is not None:
        yield "Named exactly?", f"{_bounded(found.naming.exact)} of {found.naming.exact.of} runs."
    status = Counter(run.status for run in found.runs)
    counts = ", ".join(f"{count} {words(name)}" for name, count in status.most_common())
    yield "Runs?", f"{len(found.runs)}: {counts}."
    yield "What next?", _next(found, first)


def _next(found: Validation, first: list[Coverage]) -> str:
    """What to do about the worst of the answers, or to try in addition."""
    if not first:
        return 'A longer or faster motion: "All runs" gives the reason of each run without a result.'
    if (naming := found.naming) is not None and naming.false.count > 0:
        return 'Confirm such names with a holdout: "Whether names are right" shows which effects are confused.'
    if any(one.inside[-1].bounds[1] < LEVEL for one in first):
        return 'Do not rely on these intervals: "The same, by parts of these runs" shows where they are too narrow.'
    if not _enough(first):
        return f"More runs, which narrow the bounds: bench validate --rigs {4 * len(found.runs)}."
    return "The same for one of your recordings: bench validate --into RECORDING --rig RIG."


def _chart(found: Validation, quantity: str, place: int) -> doc.Intervals:
    """Share of intervals that contain the true value, with its bounds, by group of runs, at the level of this place."""
    level, shown = LEVELS[place], [one for one in found.coverage if one.quantity in SYMBOLS and one.told]
    spans = []
    for one in shown:
        inside = one.inside[place]
        low, value, high = (100.0 * each for each in (inside.bounds[0], inside.value, inside.bounds[1]))
        colour, name = "ink" if one.by == "identify" else "model", f"{one.by}: {one.group}"
        if one.quantity == quantity:
            spans.append(doc.Span(name=name, colour=colour, value=value, low=low, high=high))
    least = min((one.inside[place].bounds[0] for one in shown), default=FROM)
    return doc.Intervals(
        title=f"{sentence(TERM_WORDS[quantity])}, {SYMBOLS[quantity]}.",
        alternative=f"Share of the intervals of {share(level)} that contain the true value, by groups of runs, "
        "with bounds of 95 %; the line is what they claim.",
        label=f"in their {share(level)} interval",
        unit="%",
        right=(100.0 * level, 100.0 * level),
        limits=(100.0 * min(FROM if level > FROM else level / 2.0, least), 100.0),
        spans=tuple(spans),
    )


def _pictures(found: Validation) -> Iterator[doc.Picture]:
    """Coverage of each quantity at every level, and names by what is hidden."""
    rows = [tuple(_chart(found, quantity, place) for place in range(len(LEVELS))) for quantity in SYMBOLS]
    estimated = tuple(row for row in rows if row[0].spans)
    nothing = doc.table("", ("",), [(NO_QUANTITY,)])
    yield doc.Picture(
        name="coverage", title="How often an interval contains the truth", rows=estimated or ((nothing,),)
    )
    if found.naming is not None:
        matrix = confusion(found.naming.confusion)
        yield doc.Picture(name="confusion", title="Named, by what is hidden", rows=((matrix,),))


def _numbers(found: Validation, whole: bool) -> list[doc.Table]:
    """Bias, spread, width and coverage, of whole groups of runs or of parts of them."""
    levels = (f"{share(level)}>" for level in LEVELS)
    headings = ("runs", "of", "known>", "bias %>", "RMS %>", "± %>", "±/RMS>", *levels, "bounds>")
    rows = {by: [] for by in TITLES}
    for each in found.coverage:
        if each.whole is whole:
            rows[each.by].append(
                (
                    each.group,
                    SYMBOLS.get(each.quantity, each.quantity),
                    f"{each.told}/{each.runs}",
                    f"{_percent(each.bias, 2)}±{_percent(NORMAL95 * each.bias_error, 1)}",
                    _percent(each.typical),
                    _percent(each.half_width),
                    f"{each.width_over_error:.2f}" if math.isfinite(each.width_over_error) else None,
                    *(f"{100.0 * inside.value:.1f}" if inside.of else None for inside in each.inside),
                    "{:.1f}-{:.1f}".format(*(100.0 * bound for bound in each.inside[-1].bounds)) if each.told else None,
                )
            )
    return [doc.table(title, headings, rows[by]) for by, title in TITLES.items() if rows[by]]


def _determined(runs: tuple[Run, ...]) -> tuple[doc.AnyPart, ...]:
    """How well a motion determines each quantity of one axis with nothing hidden in it: how often, and how closely."""
    plain = [run for run in runs if not run.hidden and run.status != "failed"]
    rows = []
    for term, symbol in SYMBOLS.items():
        scored = [one for run in plain for one in run.scored if one.by == "identify" and one.quantity == term]
        found = Coverage.of("identify", term, scored, len(plain))
        sure = Share(sum(abs(one.parameter.value) > one.half_width * one.scale for one in scored), len(plain))
        true = f"{scored[0].true:.4g} {unit_text(scored[0].parameter.unit)}" if scored else "–"
        rows.append((symbol, true, _of(sure), *map(_percent, (found.half_width, found.bias, found.typical))))
    headings = ("quantity", "true", "determined>", "± % (95 %)>", "bias %>", "RMS error %>")
    note = "determined: runs, with nothing hidden, that determine the quantity by an interval which excludes zero."
    title = "How well this motion on this drive determines the axis"
    return doc.table(title, headings, rows), doc.Paragraph(text=note)


def _outcomes(runs: tuple[Run, ...]) -> doc.Table:
    """How many runs there are, and why some determine nothing, without the numbers of a run."""
    counts = Counter((run.status, run.reason.partition(":")[0]) for run in runs)
    rows = ((status, reason, str(count)) for (status, reason), count in sorted(counts.items(), key=lambda e: -e[1]))
    return doc.table("By result", ("identify", "why", "runs>"), rows)


def _naming(found: Naming) -> Iterator[doc.AnyPart]:
    """Whether names are right, over all runs that were diagnosed."""
    by_motion = found.nulls_by_motion if len(found.nulls_by_motion) > 1 else {}
    every = {
        "nulls with a false name": found.nulls,
        **{f"  {name}": each for name, each in by_motion.items()},
        "runs with a false name": found.false,
        "  and no remainder in addition": found.silent,
        "runs named exactly": found.exact,
        "refused": found.refused,
    }
    names = ((name, _bounded(one), _of(one)) for name, one in every.items())
    yield doc.table("Names", ("what", "share>", "runs>"), names)
    if found.named:  # of each effect, how often it is named where it is, and where it is not
        shares = {name: found.named.get(name, Share(0, 0)) for name in sorted({*found.named, *found.falsely})}
        by_name = ((name, _bounded(one), _of(one), str(found.falsely.get(name, 0))) for name, one in shares.items())
        yield doc.table("By effect", ("effect", "named where it is>", "runs>", "where it is not>"), by_name)
    if found.confusion:
        yield confusion(found.confusion)
    rows = []
    for hidden, counts in found.confusion.items():
        ordered = sorted(counts.items(), key=lambda pair: (-pair[1], pair[0]))
        rows.append((words(hidden), ", ".join(f"{words(name)} {number(count)}" for name, count in ordered)))
    yield doc.table("What is found where one effect is hidden, or none", ("hidden", "found, and how often~"), rows)


def confusion(counts: Mapping[str, Mapping[str, int]]) -> doc.HeatMap:
    """What is found in runs with one effect hidden or none, as a matrix: first the right answers, in the rows'
    order."""
    answers = [NOTHING_MISSING if name == NOTHING else name for name in counts]
    columns = [*answers, *sorted({name for said in counts.values() for name in said} - set(answers))]
    return doc.HeatMap(
        caption="Hidden down, found across: how often, coloured by the share in a row; the right answer is framed",
        corner="hidden",
        rows=tuple(map(words, counts)),
        columns=tuple(map(words, columns)),
        counts=tuple(tuple(said.get(name, 0) for name in columns) for said in counts.values()),
    )


def _bounded(found: Share) -> str:
    if not found.of:
        return "–"
    value, low, high = (f"{100.0 * one:.1f}{SPACE}%" for one in (found.value, *found.bounds))
    return f"{value} ({low} to {high})"


def _of(found: Share) -> str:
    return f"{found.count}/{found.of}"


def _percent(value: float, digits: int = 3) -> str:
    percent = 100.0 * value
    if not math.isfinite(percent):
        return "–"
    return f"{percent:.0f}" if abs(percent) >= 10.0 ** (digits - 1) else f"{percent:.{digits}g}"


def runs_table(runs: tuple[Run, ...]) -> pa.Table:
    """One row a run."""
    rows = []
    for run in runs:
        named, said = run.named, dict.fromkeys(SAID)
        if named is not None:
            names = ("+".join(each) for each in (named.names, named.false, named.missed))
            said = dict(zip(SAID, (named.verdict or "refused", *names, named.reason), strict=True))
        rows.append(
            {
                **{name: getattr(run, name) for name in ("index", "plant", "motion", "kind", "noise")},
                "sample_period_s": run.sample_period,
                "duration_s": run.duration,
                "hidden": "+".join(run.hidden),
                "severity": run.severity,
                "identify": run.status,
                "reason": run.reason,
                **said,
            }
        )
    schema = pa.Table.from_pylist(rows).schema
    for name in SAID:  # of type null, where none was diagnosed
        schema = schema.set(schema.get_field_index(name), pa.field(name, pa.string()))
    return pa.Table.from_pylist(rows, schema)


def quantities_table(runs: tuple[Run, ...]) -> pa.Table:
    """One row a quantity that a run determines."""
    rows = []
    for run in runs:
        for one in run.scored:
            found, of = one.parameter, {name: getattr(one, name) for name in ("by", "effect", "quantity")}
            known = {"unit": found.unit, "true": one.true, "value": found.value, "std_error": found.std_error}
            rows.append({"index": run.index, **of, **known, "low": found.ci95[0], "high": found.ci95[1]})
    return pa.Table.from_pylist(rows)


def write_validation(folder: Path, found: Validation, document: doc.Document) -> list[Path]:
    """Write the document of a validation and its tables into a folder; the paths written.

    Raises:
        InputError: the folder cannot be written to.
    """
    with held(folder):
        written = write_document(folder, document)
        for name, rows in (("runs", runs_table(found.runs)), ("quantities", quantities_table(found.runs))):
            for ending, write in (("parquet", pq.write_table), ("csv", csv.write_csv)):
                written.append(folder / f"{name}.{ending}")
                with whole(written[-1]) as temporary:
                    write(rows, temporary)
    return written
