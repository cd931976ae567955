"""Everything an identification leaves in a folder: its figure and its JSON."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.axis_kind import MISALIGNMENT
from bench.files import held, write_text
from bench.fit.estimate import Estimate
from bench.gate.gate import gate
from bench.names import in_a_row, readable
from bench.report.estimate import estimate_json
from bench.report.figures import save
from bench.report.identification_figure import identification_figure
from bench.report.page.blocks import File
from bench.report.page.folder import write_page
from bench.report.pages.identification import identification_page
from bench.rig.rig import Rig
from bench.trace.conditioning import condition
from bench.trace.motion import Motion, motion
from bench.trace.stream import stream
from bench.trace.trace import Trace

if TYPE_CHECKING:  # MuJoCo: 0.1 s
    from bench.fit.refine import Refinement


def write_identification(
    out: Path,
    traces: Sequence[Path],
    rig: Rig,
    estimate: Estimate,
    refinement: Refinement | None = None,
    provenance: Mapping[str, Any] | None = None,
    read: Callable[[Path], Trace] | None = None,
    ending: str = ".png",
) -> list[Path]:
    """Write the page, `identification.png` (`identification-2.png`, ... of further recordings) and `identify.json`.

    Args:
        out: folder, made if it is not there.
        traces: files the estimate came from; figure and page show the first part of one that is very long.
        rig: of the axis.
        estimate: what was identified.
        refinement: what polishing did, where it was asked for.
        provenance: of the estimate.
        read: how its files are read, unless part by part as the rig says.
        ending: of the figures' files, one of `bench.report.figures.FORMATS`.

    Returns:
        Paths written.
    """
    figures, text, motions = [], out / "identify.json", []
    json = estimate_json(estimate, refinement, None, provenance) + "\n"
    names = in_a_row(traces)
    with held(out):
        for number, trace in enumerate(traces, 1):
            moved, along = _motion(trace, rig, estimate, read), _along(estimate, number - 1, rig)
            motions.append((readable(trace.name), moved, along))
            figures.append(out / f"identification{'' if number == 1 else f'-{number}'}{ending}")
            save(identification_figure(moved, along, rig.axis_kind, f"{rig.name}: {readable(trace.name)}"), figures[-1])
        write_text(text, json)
        file = File(name=text.name, about="all of it as numbers", media="application/json", content=json)
        page = identification_page(f"{rig.name}: {names}", rig.axis_kind, estimate, motions, [file], provenance)
        return [*write_page(out, page), *figures, text]


def _motion(trace: Path, rig: Rig, estimate: Estimate, read: Callable[[Path], Trace] | None) -> Motion:
    """The first part of a recording through the filter that the estimate was made with."""
    first = gate(read(trace) if read is not None else next(stream(trace, rig.trace)), rig).trace
    (effort, _), (own, _) = rig.net_effort(first), rig.own_effort(first)
    return motion(first, effort, condition(first, own, estimate.cutoff if estimate.cutoff > 0.0 else None))


def _along(estimate: Estimate, index: int, rig: Rig) -> Estimate:
    """The estimate along one of its recordings, which has a shift of torque against speed of its own."""
    shift = rig.axis_kind.parameter(MISALIGNMENT)
    if not estimate.recordings or shift not in estimate.recordings[index].parameters:
        return estimate
    own = estimate.recordings[index].parameters[shift]
    return replace(estimate, parameters={**estimate.parameters, shift: own})
