"""Tables that several pages have: parameters, checks, recordings; and what a page rests on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench import __version__
from bench.comparison.spread import Between
from bench.fit.estimate import Alone
from bench.fit.parameter import Parameter
from bench.gate.check import Check
from bench.names import words
from bench.report.page.blocks import Column, Points, Section, Series, Table
from bench.report.page.numbers import interval, number, unit_text


def effort_word(unit: str) -> str:
    """What an effort in a unit is: torque, force, current or voltage."""
    return {"N*m": "torque", "N": "force", "A": "current", "V": "voltage"}.get(unit, "effort")


def coordinate_word(coordinate: str, unit: str) -> str:
    """What a coordinate of the gap is called on an axis; the current is the torque where no current was recorded."""
    labels = {"current": effort_word(unit), "reversal": "time since reversal"}
    return labels.get(coordinate, coordinate)


def parameters_table(caption: str, parameters: Mapping[str, Parameter]) -> Table:
    """Parameters with their intervals of 95 %."""
    columns = (
        Column(heading="quantity"),
        Column(heading="value ± half interval (95 %)", number=True),
        Column(heading="unit"),
    )
    rows = tuple(
        (words(name), interval(found, unit=False), unit_text(found.unit)) for name, found in parameters.items()
    )
    return Table(caption=caption, columns=columns, rows=rows)


def recordings_table(recordings: Sequence[Alone], between: Mapping[str, Between], units: Mapping[str, str]) -> Table:
    """What each of several recordings tells alone, and where the next one is to be expected."""
    columns = [Column(heading="recording")]
    columns += [Column(heading=f"{words(name)} / {unit_text(units[name])}", number=True) for name in between]
    rows = [
        (
            Path(alone.origin).name,
            *(interval(alone.parameters[name], unit=False) if name in alone.parameters else "–" for name in between),
        )
        for alone in recordings
    ]
    following = [spread.predictive95 for spread in between.values()]
    rows.append(("the next one (95 %)", *(f"{number(low)} to {number(high)}" for low, high in following)))
    return Table(caption="Each recording alone", columns=tuple(columns), rows=tuple(rows))


def noise_band(x: Sequence[float], floor: float) -> Series:
    """Noise of a single row around zero, over the width of a panel."""
    ends = (min(x, default=0.0), max(x, default=1.0))
    return Series(name="noise floor", style="band", colour="floor", x=ends, low=(-floor, -floor), high=(floor, floor))


def checks_section(checks: Sequence[Check], warnings: Sequence[str]) -> Section:
    """What was checked before anything was fitted, and what a user should know."""
    applicable = [check for check in checks if check.status != "not_applicable"]
    advised = any(check.advice and check.status in ("warn", "fail") for check in applicable)
    rows = tuple(
        (words(check.name), words(check.status), check.found, *([check.advice or ""] if advised else []))
        for check in applicable
    )
    marked = tuple(k for k, check in enumerate(applicable) if check.status in ("warn", "fail"))
    texts = [Column(heading=heading, prose=True) for heading in ("found", *(["advice"] if advised else []))]
    columns = (Column(heading="check"), Column(heading="status"), *texts)
    passed = sum(check.status == "pass" for check in applicable)
    caption = f"{passed} of {len(applicable)} checks of the recording passed before anything was fitted"
    table = Table(caption=caption, columns=columns, rows=rows, marked=marked)
    notes = (Points(items=tuple(warnings)),) if warnings else ()
    return Section(key="checks", heading="Checks and warnings", blocks=(*notes, table))


def origin(provenance: Mapping[str, Any] | None) -> tuple[str, ...]:
    """Version and digests of what a page rests on."""
    if provenance is None:
        return (f"servobench {__version__}",)
    rig = provenance["rig_sha256"]
    found = [f"servobench {provenance['version']}" + ("" if rig is None else f"; rig sha256 {rig}")]
    files = [*provenance["traces"], *([provenance["holdout"]] if "holdout" in provenance else [])]
    found += [f"{Path(one['file']).name} sha256 {one['sha256']}" for one in files]
    given = {key: value for key, value in provenance["options"].items() if value not in (None, [], False)}
    options = ", ".join(f"{key} {value}" for key, value in given.items())
    return (*found, f"options: {options}") if options else tuple(found)
