"""Parts that documents share: parameters, recordings, checks, and what a result is based on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from bench import __version__
from bench.comparison.spread import Between
from bench.files import read_text, sha256
from bench.fit.estimate import Alone
from bench.gate.check import Check
from bench.names import readable, words
from bench.parameter import Parameter
from bench.report.document import MEDIA, Chart, File, Panel, Section, Series, Table, downloads, points, section, table
from bench.report.numbers import interval, number, unit_text

#: What pages of a model ask, and what to record next where nothing is open.
MOVES = "Does it move like the axis now?"
NO_FURTHER = "No further recording is needed."


def parameters_table(
    caption: str, parameters: Mapping[str, Parameter], truth: Mapping[str, float] | None = None
) -> Table:
    """Parameters with their intervals of 95 %; with the truth, in their units, and the error where it is known."""
    rows = []
    for name, found in parameters.items():
        known = truth.get(name) if truth else None
        compared = (
            (number(known, digits=5), f"{found.value / known - 1.0:+z.3%}".replace("-", "−")) if known else ("", "")
        )
        rows.append((words(name), interval(found, unit=False), *(compared if truth else ()), unit_text(found.unit)))
    beside = ("truth>", "error>") if truth else ()
    return table(caption, ("quantity", "value ± half interval (95 %)>", *beside, "unit"), rows)


def values_table(caption: str, values: Iterable[tuple[str, float, str]], digits: int = 5) -> Table:
    """Quantities by name with their values and units, without intervals."""
    rows = ((words(name), number(value, digits=digits), unit_text(unit)) for name, value, unit in values)
    return table(caption, ("quantity", "value>", "unit"), rows)


def recordings_table(
    recordings: Sequence[Alone], between: Mapping[str, Between], parameters: Mapping[str, Parameter]
) -> list[Table]:
    """The values of each of several recordings by itself, and where the next is to be expected; none where there is
    only one.

    Args:
        between: how they differ, by name of a quantity.
        parameters: of all together, whose units these have.
    """
    if not recordings:
        return []
    rows = [
        (
            Path(alone.origin).name,
            *(interval(alone.parameters[name], unit=False) if name in alone.parameters else "–" for name in between),
        )
        for alone in recordings
    ]
    following = [spread.predictive95 for spread in between.values()]
    rows.append(("the next one (95 %)", *(f"{number(low)} to {number(high)}" for low, high in following)))
    headings = (f"{words(name)} / {unit_text(parameters[name].unit)}>" for name in between)
    return [table("Each recording by itself", ("recording", *headings), rows)]


def one_panel(title: str, alternative: str, x: tuple[str, str], y: tuple[str, str], drawn: Iterable[Series]) -> Chart:
    """A chart of one panel, of series over `x`; each axis by its label and unit."""
    panel = Panel(x_label=x[0], x_unit=unit_text(x[1]), series=tuple(drawn))
    return Chart(title=title, alternative=alternative, y_label=y[0], y_unit=unit_text(y[1]), panels=(panel,))


def noise_band(x: Sequence[float], floor: float) -> Series:
    """Noise of a single row around zero, over the width of a panel."""
    ends = (min(x, default=0.0), max(x, default=1.0))
    return Series(name="noise floor", style="band", colour="floor", x=ends, low=(-floor, -floor), high=(floor, floor))


def checks_section(checks: Sequence[Check], warnings: Sequence[str], detail: bool = True) -> Section:
    """What was checked before anything was fitted, and what a user should know."""
    applicable = [check for check in checks if check.status != "not_applicable"]
    advised = any(check.advice and check.status in ("warn", "fail") for check in applicable)
    rows = (
        (words(check.name), words(check.status), check.found, *([check.advice or ""] if advised else []))
        for check in applicable
    )
    marked = (k for k, check in enumerate(applicable) if check.status in ("warn", "fail"))
    passed = sum(check.status == "pass" for check in applicable)
    caption = f"{passed} of {len(applicable)} checks of the recording passed before anything was fitted"
    headings = ("check", "status", "found~", *(["advice~"] if advised else []))
    notes = (points(warnings),) if warnings else ()
    tables = (table(caption, headings, rows, marked),) if applicable else ()
    return section("checks", "Checks and warnings", *notes, *tables, detail=detail)


def model_sections(model: Path, warnings: Sequence[str]) -> list[Section]:
    """What the user should know before believing a result, and the file of a model to take along.

    Raises:
        InputError: it cannot be read.
    """
    held = File(name=readable(model.name), about="the model", media=MEDIA["toml"], content=read_text(model, "a model"))
    warned = [points(warnings)] if warnings else []
    return [section("warnings", "Warnings", *warned), section("model", "The model", downloads(held))]


def origin(provenance: Mapping[str, Any] | None) -> tuple[str, ...]:
    """Version and digests of what a page is based on."""
    if provenance is None:
        return (f"servobench {__version__}",)
    rig = provenance["rig_sha256"]
    found = [f"servobench {provenance['version']}" + ("" if rig is None else f"; rig sha256 {rig}")]
    files = [*provenance["traces"], *([provenance["holdout"]] if "holdout" in provenance else [])]
    found += [f"{Path(one['file']).name} sha256 {one['sha256']}" for one in files]
    given = {key: value for key, value in provenance["options"].items() if value not in (None, [], False)}
    options = ", ".join(f"{key} {value}" for key, value in given.items())
    return (*found, f"options: {options}") if options else tuple(found)


def provenance(
    rig: Path | None,
    traces: Sequence[Path],
    options: Mapping[str, Any],
    holdout: Path | None = None,
    mjcf: Path | Sequence[Path] | None = None,
) -> dict[str, Any]:
    """The contract's `provenance`: from the same version, files and options come the same results.

    Args:
        rig: file of the axis; None of a joint that only an MJCF has, and without any file.
        traces: files of the recordings, in the order given.
        options: of the command that change its result.
        holdout: file of the recording that was not fitted.
        mjcf: file of the robot around the axis; several where its payload differs from log to log.

    Raises:
        InputError: a file cannot be read.
    """

    def checksum(path: Path) -> dict[str, str]:
        return {"file": readable(path), "sha256": sha256(path)}

    robots = [checksum(path) for path in ([mjcf] if isinstance(mjcf, Path) else mjcf or [])]
    return {
        "version": __version__,
        "rig_sha256": None if rig is None else sha256(rig),
        "traces": [checksum(trace) for trace in traces],
        "options": dict(options),
        **({} if holdout is None else {"holdout": checksum(holdout)}),
        **({"mjcf": robots if len(robots) > 1 else robots[0]} if robots else {}),
    }
