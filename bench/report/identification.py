"""Everything an identification leaves in a folder: its figure and its JSON."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from bench.checks.gate import gate
from bench.files import write_text
from bench.identify.estimate import Estimate
from bench.report.estimate import estimate_json
from bench.report.figures import identification_figure, save
from bench.rig.rig import Rig
from bench.trace.conditioning import condition
from bench.trace.motion import motion
from bench.trace.stream import stream

if TYPE_CHECKING:  # MuJoCo: 0.1 s
    from bench.identify.refine import Refinement


def write_identification(
    out: Path, trace: Path, rig: Rig, estimate: Estimate, refinement: Refinement | None = None
) -> list[Path]:
    """Write `identification.png` and `identify.json` into a folder.

    Args:
        out: folder, made if it is not there.
        trace: file the estimate came from; the figure shows its first part where it is very long.
        rig: of the axis.
        estimate: what was identified.
        refinement: what polishing did, where it was asked for.

    Returns:
        Paths written.
    """
    first = gate(next(stream(trace, rig.trace)), rig).trace
    effort, _ = rig.net_effort(first)
    cutoff = estimate.cutoff if estimate.cutoff > 0.0 else None
    moved = motion(first, effort, condition(first, effort, cutoff))
    figure, text = out / "identification.png", out / "identify.json"
    save(identification_figure(moved, estimate, rig.axis_kind, f"{rig.name}: {trace.name}"), figure)
    write_text(text, estimate_json(estimate, refinement) + "\n")
    return [figure, text]
