"""A validation as tables, as JSON (`bench.validate/1`), and run by run as CSV and Parquet."""

from __future__ import annotations

import dataclasses
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import csv

from bench.files import held, whole, write_text
from bench.report.figures import save
from bench.report.sheet import Sheet
from bench.report.validation_figures import confusion_figure, coverage_figure
from bench.statistics import NORMAL95
from bench.structured import json_text
from bench.validation.coverage import LEVELS, Coverage, Group, Share
from bench.validation.naming import Naming
from bench.validation.run import Run
from bench.validation.validate import Validation

SCHEMA = "bench.validate/1"
#: Terms of the equation of motion as tables have them.
SYMBOLS = {"inertia": "J", "viscous": "K_w", "coulomb": "K_0"}
TITLES = {
    "identify": "identify: how far off, and how often an interval holds the truth",
    "diagnose": "diagnose: the same, after it added what it named",
}
NOTE = (
    "told: runs that tell the quantity, of all. Over the true value: bias with its interval, RMS error, median half "
    "width of the interval of 95 %; ±/RMS by root mean squares, 1.96 of a normal distribution's. 50%, 80%, 95%: share "
    "of the intervals of that level that hold the truth; bounds: 95 % of the last, Clopper-Pearson."
)


def sheets(found: Validation, every: bool = False) -> list[Sheet]:
    """All tables.

    Args:
        found: the validation.
        every: whether nulls are told by plant, noise, axis and motion too, and effects by their quantities.
    """
    tables = [outcomes(found.runs)]
    for by, title in TITLES.items():
        some = [each for each in found.coverage if each.by == by and (every or each.whole)]
        tables += [covered(some, title)] if some else []
    if found.naming is not None:
        tables += [names(found.naming), *([by_name(found.naming)] if found.naming.named else [])]
    return tables


def outcomes(runs: tuple[Run, ...]) -> Sheet:
    """How many runs there are, and why some tell nothing."""
    counts = Counter((run.status, _first_words(run.reason)) for run in runs)
    rows = [(status, reason, str(count)) for (status, reason), count in sorted(counts.items(), key=lambda e: -e[1])]
    return Sheet("Runs", ("identify", "why", "runs"), rows, words=2)


def _first_words(reason: str) -> str:
    """A reason without the numbers of its run."""
    return reason.partition(":")[0]


def determined(runs: tuple[Run, ...]) -> Sheet:
    """How well a motion determines each quantity of one axis with nothing hidden in it: how often, and how closely."""
    plain = [run for run in runs if not run.hidden and run.status != "failed"]
    rows = []
    for term, symbol in SYMBOLS.items():
        scored = [one for run in plain for one in run.scored if one.by == "identify" and one.quantity == term]
        found = Coverage.of("identify", Group("", len(plain), True), term, scored)
        known = Share(sum(abs(one.parameter.value) > one.half_width * one.scale for one in scored), len(plain))
        true = f"{scored[0].true:.4g} {scored[0].parameter.unit}" if scored else "-"
        rows.append(
            (symbol, true, _of(known), _percent(found.half_width), _percent(found.bias), _percent(found.typical))
        )
    headings = ("quantity", "true", "determined", "± % (95 %)", "bias %", "RMS error %")
    note = "determined: runs, with nothing hidden, that tell the quantity by an interval which excludes zero."
    return Sheet("How well this motion on this drive determines the axis", headings, rows, words=2, note=note)


def covered(found: Sequence[Coverage], title: str) -> Sheet:
    """Bias, spread, width and coverage."""
    rows = [
        (
            each.group,
            SYMBOLS.get(each.quantity, each.quantity),
            f"{each.told}/{each.runs}",
            f"{_percent(each.bias, 2)}±{_percent(NORMAL95 * each.bias_error, 1)}",
            _percent(each.typical),
            _percent(each.half_width),
            _number(each.width_over_error),
            *(f"{100.0 * share.value:.1f}" if share.of else "-" for share in each.inside),
            "{:.1f}-{:.1f}".format(*(100.0 * bound for bound in each.inside[-1].bounds)) if each.told else "-",
        )
        for each in found
    ]
    levels = (f"{level:.0%}" for level in LEVELS)
    headings = ("runs", "of", "told", "bias %", "RMS %", "± %", "±/RMS", *levels, "bounds")
    return Sheet(title, headings, rows, words=2, note=NOTE)


def names(found: Naming) -> Sheet:
    """Whether names are right, over all runs that were diagnosed."""
    rows = [
        ("nulls with a false name", bounded(found.nulls), _of(found.nulls)),
        *((f"  {name}", bounded(share), _of(share)) for name, share in _apart(found.nulls_by_motion)),
        ("runs with a false name", bounded(found.false), _of(found.false)),
        ("  and no remainder beside it", bounded(found.silent), _of(found.silent)),
        ("runs named exactly", bounded(found.exact), _of(found.exact)),
        ("refused", bounded(found.refused), _of(found.refused)),
    ]
    return Sheet("Names", ("what", "share", "runs"), rows)


def _apart(by_motion: Mapping[str, Share]) -> list[tuple[str, Share]]:
    """By motion, where there are several."""
    return [*by_motion.items()] if len(by_motion) > 1 else []


def by_name(found: Naming) -> Sheet:
    """Of each effect, how often it is named where it is, and where it is not."""
    every = {name: found.named.get(name, Share(0, 0)) for name in sorted({*found.named, *found.falsely})}
    rows = [(name, bounded(share), _of(share), str(found.falsely.get(name, 0))) for name, share in every.items()]
    return Sheet("By effect", ("effect", "named where it is", "runs", "where it is not"), rows)


def bounded(share: Share) -> str:
    """A share with its bounds."""
    if not share.of:
        return "-"
    low, high = share.bounds
    return f"{share.value:.1%} ({low:.1%} to {high:.1%})"


def _of(share: Share) -> str:
    return f"{share.count}/{share.of}"


def _percent(value: float, digits: int = 3) -> str:
    percent = 100.0 * value
    if not math.isfinite(percent):
        return "-"
    return f"{percent:.0f}" if abs(percent) >= 10.0 ** (digits - 1) else f"{percent:.{digits}g}"


def _number(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else "-"


def validation_json(found: Validation, provenance: Mapping[str, Any]) -> str:
    """The whole, as the contract's JSON; nan is null."""
    status = Counter(run.status for run in found.runs)
    return json_text(
        {
            "schema": SCHEMA,
            "runs": {"asked": len(found.runs), **{name: status[name] for name in ("done", "refused", "failed")}},
            "coverage": [_coverage_json(each) for each in found.coverage],
            "naming": None if found.naming is None else _naming_json(found.naming),
            "provenance": dict(provenance),
        }
    )


def _coverage_json(found: Coverage) -> dict[str, Any]:
    known = {
        key: (value if math.isfinite(value) else None) if isinstance(value, float) else value
        for key, value in ((field.name, getattr(found, field.name)) for field in dataclasses.fields(found))
        if key != "inside"
    }
    inside = [{"level": level, **_share_json(share)} for level, share in zip(LEVELS, found.inside, strict=True)]
    return known | {"inside": inside}


def _share_json(share: Share) -> dict[str, Any]:
    return {
        "count": share.count,
        "of": share.of,
        "share": share.value if share.of else None,
        "bounds95": list(share.bounds),
    }


def _naming_json(found: Naming) -> dict[str, Any]:
    shares = {name: _share_json(getattr(found, name)) for name in ("nulls", "false", "silent", "exact", "refused")}
    return {
        "nulls_with_false_name": shares["nulls"],
        "nulls_by_motion": {name: _share_json(share) for name, share in found.nulls_by_motion.items()},
        "with_false_name": shares["false"],
        "with_false_name_explained": shares["silent"],
        "named_exactly": shares["exact"],
        "refused": shares["refused"],
        "named": {name: _share_json(share) for name, share in found.named.items()},
        "falsely_named": dict(found.falsely),
        "confusion": {hidden: dict(counts) for hidden, counts in found.confusion.items()},
    }


def runs_table(runs: tuple[Run, ...]) -> pa.Table:
    """One row a run."""
    rows = []
    for run in runs:
        named = run.named
        rows.append(
            {
                **{name: getattr(run, name) for name in ("index", "plant", "motion", "kind", "noise")},
                "sample_period_s": run.sample_period,
                "duration_s": run.duration,
                "hidden": "+".join(run.hidden),
                "severity": run.severity,
                "identify": run.status,
                "reason": run.reason,
                "verdict": None if named is None else named.verdict or "refused",
                "named": None if named is None else "+".join(named.names),
                "false": None if named is None else "+".join(named.false),
                "missed": None if named is None else "+".join(named.missed),
                "diagnose_reason": None if named is None else named.reason,
            }
        )
    texts = ("verdict", "named", "false", "missed", "diagnose_reason")
    schema = pa.Table.from_pylist(rows).schema
    for name in texts:  # of type null, where none was diagnosed
        schema = schema.set(schema.get_field_index(name), pa.field(name, pa.string()))
    return pa.Table.from_pylist(rows, schema)


def quantities_table(runs: tuple[Run, ...]) -> pa.Table:
    """One row a quantity that a run tells."""
    return pa.Table.from_pylist(
        [
            {
                "index": run.index,
                "by": one.by,
                "effect": one.effect,
                "quantity": one.quantity,
                "unit": one.parameter.unit,
                "true": one.true,
                "value": one.parameter.value,
                "std_error": one.parameter.std_error,
                "low": one.parameter.ci95[0],
                "high": one.parameter.ci95[1],
            }
            for run in runs
            for one in run.scored
        ]
    )


def write_validation(folder: Path, found: Validation, provenance: Mapping[str, Any], command: str) -> list[Path]:
    """Write JSON, tables and figures into a folder; returns their paths.

    Raises:
        InputError: the folder cannot be written to.
    """
    with held(folder):
        return list(_written(folder, found, provenance, command))


def _written(folder: Path, found: Validation, provenance: Mapping[str, Any], command: str) -> Iterator[Path]:
    yield _text(folder / "validation.json", validation_json(found, provenance) + "\n")
    text = "\n\n".join([f"# Validation\n\n`{command}`", *(sheet.markdown() for sheet in sheets(found, every=True))])
    yield _text(folder / "validation.md", text + "\n")
    for name, table in (("runs", runs_table(found.runs)), ("quantities", quantities_table(found.runs))):
        with whole(folder / f"{name}.parquet") as temporary:
            pq.write_table(table, temporary)
        with whole(folder / f"{name}.csv") as temporary:
            csv.write_csv(table, temporary)
        yield from (folder / f"{name}.parquet", folder / f"{name}.csv")
    figures = {"coverage.png": coverage_figure(found.coverage)}
    if found.naming is not None:
        figures["confusion.png"] = confusion_figure(found.naming)
    for name, figure in figures.items():
        save(figure, folder / name)
        yield folder / name


def _text(path: Path, text: str) -> Path:
    write_text(path, text)
    return path
