"""A model in motion: the simulated axis, the measured one as a ghost, and both over time."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import numpy as np

from bench.arrays import Array, rms
from bench.names import readable
from bench.report.document import Document, Moving, Section, Slowed, TimeGraph
from bench.report.numbers import number, unit_text
from bench.report.over_time import Plotted, time_graph
from bench.report.parts import model_section, origin, warnings_sections
from bench.view.side_by_side import SideBySide

#: Instants that a page holds of a motion, 8 bytes each and a third more as text: 0.4 MB.
MOST = 40_000
#: Part of what a page may hold of graphs over time that is left beside them.
PART = 0.8
#: How much slower a page plays; what turns plays at first so that it goes round at most once a second.
SLOWED: tuple[Slowed, ...] = get_args(Slowed)


def view(shown: SideBySide, model: Path, along: str, warnings: Sequence[str] = ()) -> Document:
    """The document of a motion.

    Args:
        shown: model and ghost.
        model: file that was run.
        along: name of the recording, or of the profile.
        warnings: what the user should know before believing it.

    Raises:
        InputError: the model cannot be read.
    """
    title = f"{readable(model.name)} along {along}"
    kind, apart = shown.kind, shown.apart[np.isfinite(shown.apart)]
    furthest = number(float(np.abs(apart).max()), kind.length_unit, 3)
    seconds = number(float(shown.time[-1] - shown.time[0]), "s", 3)
    answers = {
        "What moves?": shown.simulated_is,
        "How far apart?": f"{number(rms(apart), kind.length_unit, 3)} RMS, {furthest} at most",
    }
    sections = [
        Section(key="moving", heading="Moving", blocks=(motion_of(shown),)),
        Section(key="motion", heading="Over time", blocks=(_graph(shown),)),
    ]
    return Document(
        title=title,
        subject=f"View: {title}",
        verdict=f"The simulated axis stays within {furthest} of the motion {shown.ghost_is}, over {seconds}.",
        tone="open" if warnings else "sure",
        answers=answers,
        sections=(*sections, *warnings_sections(warnings), model_section(model)),
        origin=origin(None),
    )


def motion_of(shown: SideBySide) -> Moving:
    """The motion at instants of equal distance, each as of the sample next to it; nan in holes."""
    time = shown.time
    period = float(np.median(np.diff(time)))
    count = min(round(float(time[-1] - time[0]) / period) + 1, MOST)
    instants, step = np.linspace(time[0], time[-1], count, retstep=True)
    after = np.clip(np.searchsorted(time, instants), 1, time.size - 1)
    nearest = after - (instants - time[after - 1] < time[after] - instants)
    known = np.abs(time[nearest] - instants) <= 0.75 * max(float(step), period)
    ghost, apart = (np.where(known, values[nearest], np.nan) for values in (shown.ghost, shown.apart))
    low, high = _range(np.concatenate([shown.ghost, shown.position]))
    return Moving(
        title="The axis.",
        alternative=f"{shown.simulated_is} The ghost is the motion {shown.ghost_is}.",
        turns=shown.kind.turns,
        unit=unit_text(shown.kind.length_unit),
        ghost=shown.ghost_is,
        start=float(time[0]),
        step=float(step),
        count=count,
        low=low,
        high=high,
        slowed=_slowed(shown),
        position=_packed(ghost),
        apart=_packed(apart),
    )


def _slowed(shown: SideBySide) -> Slowed:
    if not shown.kind.turns:
        return 1
    turns = float(np.nanmax(np.abs(shown.ghost_velocity))) / (2.0 * np.pi)
    return SLOWED[min(int(np.searchsorted(SLOWED, turns)), len(SLOWED) - 1)]


def _range(values: Array) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return (low, high) if high > low else (low - 0.5, low + 0.5)


def _packed(values: Array) -> str:
    return base64.b64encode(values.astype("<f4").tobytes()).decode("ascii")


def _graph(shown: SideBySide) -> TimeGraph:
    kind = shown.kind
    signals = [
        Plotted(label, unit, shown.time, ghost, [ghost - model], name=shown.ghost_is)
        for label, unit, ghost, model in (
            ("speed", kind.speed_unit, shown.ghost_velocity, shown.velocity),
            ("position", kind.length_unit, shown.ghost, shown.position),
        )
    ]
    alternative = f"Speed and position as {shown.ghost_is} and simulated; a line goes along with the drawing above."
    return time_graph("Over time.", alternative, shown.time, signals, part=PART)
