"""An estimate as JSON (contract `bench.identify/1`) and as a table for a person."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich import box
from rich.table import Table

from bench.axis_kind import AxisKind
from bench.comparison.spread import Between
from bench.fit.estimate import Alone, Estimate
from bench.fit.parameter import Parameter
from bench.names import words
from bench.report.gate import checks_json
from bench.structured import json_text

if TYPE_CHECKING:  # MuJoCo: 0.1 s
    from bench.fit.refine import Refinement

SCHEMA = "bench.identify/1"


def _number(value: float) -> float | None:
    """JSON has no nan: what is not known is null."""
    return value if math.isfinite(value) else None


def parameters_json(parameters: Mapping[str, Parameter]) -> dict[str, Any]:
    """Parameters with unit, standard error and interval."""
    return {
        name: {
            "value": found.value,
            "unit": found.unit,
            "std_error": _number(found.std_error),
            "ci95": [_number(bound) for bound in found.ci95],
        }
        for name, found in parameters.items()
    }


def estimate_json(
    estimate: Estimate,
    refinement: Refinement | None = None,
    refused: str | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> str:
    """The estimate as the contract's JSON.

    Args:
        estimate: what was identified.
        refinement: what polishing did, where it was asked for.
        refused: why the recording cannot answer, where it cannot.
        provenance: of the files it came from (`bench.report.provenance`); null where it came from none.
    """
    residual = estimate.residual
    polish = {} if refinement is None else {"refinement": dataclasses.asdict(refinement)}
    return json_text(
        {
            "schema": SCHEMA,
            "estimator": estimate.estimator,
            "parameters": parameters_json(estimate.parameters),
            "explained": _number(estimate.explained),
            "refused": refused,
            "recordings": recordings_json(estimate.recordings, provenance),
            "between": between_json(estimate.between) if estimate.recordings else None,
            "provenance": provenance,
            "residual": {
                "rms": residual.rms,
                "noise_floor": _number(residual.noise_floor),
                "unit": residual.unit,
                "relative": residual.relative,
            },
            "samples": {"read": estimate.samples_read, "used": estimate.samples_used},
            "filter": {"cutoff": _number(estimate.cutoff), "unit": "Hz", "source": estimate.source},
            "checks": checks_json(estimate.checks),
            "warnings": list(estimate.warnings),
            **polish,
        }
    )


def recordings_json(recordings: Sequence[Alone], provenance: Mapping[str, Any] | None) -> list[dict[str, Any]]:
    """Each of several recordings alone; `reason`: why it leaves some of the parameters open, null where none."""
    digests = {each["file"]: each["sha256"] for each in provenance["traces"]} if provenance else {}
    return [
        {
            "file": alone.origin,
            "sha256": digests.get(alone.origin),
            "parameters": parameters_json(alone.parameters),
            "reason": alone.reason or None,
        }
        for alone in recordings
    ]


def between_json(between: Mapping[str, Between]) -> dict[str, Any]:
    """Spread of each quantity over the recordings, and where the next one is to be expected."""
    return {
        name: {"std_dev": spread.std_dev, "predictive95": list(spread.predictive95)} for name, spread in between.items()
    }


def recordings_table(estimate: Estimate) -> Table:
    """What each of several recordings tells alone, and what the next one would."""
    table = Table(title="each recording alone", title_justify="left", box=box.SIMPLE_HEAD)
    names = [name for name in estimate.parameters if name in estimate.between]
    table.add_column("recording")
    for name in names:
        table.add_column(f"{name.replace('_', ' ')}\n{estimate[name].unit}", justify="right")
    for alone in estimate.recordings:
        found_alone = [alone.parameters.get(name) for name in names]
        values = ["-" if found is None else f"{found.value:.4g} ± {found.half_width:.2g}" for found in found_alone]
        table.add_row(Path(alone.origin).name, *values)
    following = [estimate.between[name].predictive95 for name in names]
    table.add_row("the next one (95 %)", *(f"{low:.4g} to {high:.4g}" for low, high in following))
    return table


def refinement_line(refinement: Refinement, kind: AxisKind) -> str:
    """What polishing by simulation did, for a person."""
    before, after = refinement.held_out
    return (
        f"simulation error on held-out motion {before:.4g} -> {after:.4g} {kind.speed_unit} "
        f"(held at {refinement.bandwidth:g} rad/s): {'polish kept' if refinement.accepted else 'polish not kept'}"
    )


def estimate_table(estimate: Estimate, title: str, truth: Mapping[str, float] | None = None) -> Table:
    """Parameters with their 95 % intervals; beside the truth and the error where it is known.

    Args:
        estimate: what was identified.
        title: of the table.
        truth: true values by the parameters' names, in their units.
    """
    residual = estimate.residual
    floor = f", noise floor {residual.noise_floor:.3g}" if math.isfinite(residual.noise_floor) else ""
    cutoff = (
        f"; cut-off {estimate.cutoff:.3g} Hz, speed from {estimate.source}" if math.isfinite(estimate.cutoff) else ""
    )
    explained = f", {estimate.explained:.2%} of its variance explained" if math.isfinite(estimate.explained) else ""
    caption = (
        f"residual {residual.rms:.3g} {residual.unit} ({residual.relative:.2%} of the effort{explained}{floor})\n"
        f"{estimate.samples_used} of {estimate.samples_read} samples{cutoff}"
    )
    table = Table(title=title, caption=caption, title_justify="left", caption_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("quantity", no_wrap=True)
    for heading in ("estimate", "± (95 %)", *(("truth", "error") if truth else ())):
        table.add_column(heading, justify="right", no_wrap=True)
    table.add_column("unit", no_wrap=True)
    for name, found in estimate.parameters.items():
        known = truth.get(name) if truth else None
        compared = (f"{known:.5g}", f"{found.value / known - 1.0:+.3%}") if known else ("", "")
        reach = f"{found.half_width:.2g}"
        row = [words(name), f"{found.value:.5g}", reach, *(compared if truth else ()), found.unit]
        table.add_row(*row)
    return table
