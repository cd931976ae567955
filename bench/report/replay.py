"""A replay: a model run along a recording, measured and simulated on one time axis."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from bench.arrays import Array, rms
from bench.diagnosis.refine import NULL
from bench.diagnosis.replay import LEFT, Replay
from bench.names import readable
from bench.report.document import Document, Section
from bench.report.numbers import effort_word, number, share
from bench.report.over_time import Plotted, time_graph
from bench.report.parts import model_section, origin, warnings_sections
from bench.trace.noise import white_noise


def replay(replayed: Replay, model: Path, along: str) -> Document:
    """The document of a replay.

    Args:
        replayed: signals measured and simulated.
        model: file that was run.
        along: name of the recording.

    Raises:
        InputError: the model cannot be read.
    """
    title = f"{readable(model.name)} along {along}"
    effort = effort_word(replayed.effort_unit)
    torque = _left(replayed.torque, replayed.torque_simulated)
    speed = _left(replayed.velocity, replayed.velocity_simulated)
    alike = torque[0] < LEFT
    line = f"The model leaves {share(torque[0])} of the {effort}"
    simulated = math.isfinite(speed[1])
    if simulated:
        line += f" and is off by {number(speed[1], replayed.speed_unit, 3)} in simulated speed"
    noise = white_noise(replayed.velocity)
    answers = {
        f"How much {effort} is left?": f"{number(torque[1], replayed.effort_unit, 3)} RMS",
        "Does it move like the axis?": _moves(speed[1], noise, replayed.speed_unit),
        "Is it this axis?": " ".join(replayed.warnings) or "Nothing speaks against it.",
    }
    signals = [
        _signal("speed", replayed.speed_unit, replayed.time, replayed.velocity, replayed.velocity_simulated),
        _signal(effort, replayed.effort_unit, replayed.time, replayed.torque, replayed.torque_simulated),
    ]
    shown = f"Speed and {effort} of the recording as measured and as the model has them, and what is left of each."
    graph = time_graph("Over time.", shown, replayed.time, signals)
    sections = [Section(key="motion", heading="Measured and simulated", blocks=(graph,))]
    return Document(
        title=title,
        subject=f"Replay: {title}",
        verdict=f"{line}.",
        tone="sure" if alike and not replayed.warnings else "open",
        answers=answers,
        sections=(*sections, *warnings_sections(replayed.warnings), model_section(model)),
        origin=origin(None),
    )


def _signal(label: str, unit: str, time: Array, measured: Array, simulated: Array) -> Plotted:
    return Plotted(label, unit, time, measured, [measured - simulated])


def _left(measured: Array, simulated: Array) -> tuple[float, float]:
    """Share of a signal that is left, and its RMS; nan where the model says nothing."""
    known = np.isfinite(simulated) & np.isfinite(measured)
    if not known.any():
        return math.nan, math.nan
    left = rms(measured[known] - simulated[known])
    return left / max(rms(measured[known]), 1e-300), left


def _moves(left: float, noise: float, unit: str) -> str:
    """Whether simulated speed is measured speed, but for noise."""
    if not math.isfinite(left):
        return "The model holds no motion, only torque."
    like = "Yes" if left <= NULL * noise else "Not wholly"
    return f"{like}: off by {number(left, unit, 3)} RMS; the sensor's noise is {number(noise, digits=3)}."
