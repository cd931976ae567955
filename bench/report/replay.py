"""A replay: a model run along a recording, measured and simulated on one time axis."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bench.arrays import Array, rms
from bench.diagnosis.refine import NULL
from bench.diagnosis.replay import LEFT, Replay
from bench.report.document import Document, Downloads, File, Points, Section
from bench.report.numbers import effort_word, number, share
from bench.report.over_time import Plotted, time_graph
from bench.report.parts import origin
from bench.trace.noise import white_noise


def replay(replayed: Replay, title: str, files: Sequence[File]) -> Document:
    """The document of a replay.

    Args:
        replayed: signals measured and simulated.
        title: model and recording.
        files: to take along: the model.
    """
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
    sections = [Section(key="motion", heading="Plotted and simulated", blocks=(graph,))]
    if replayed.warnings:
        sections.append(Section(key="warnings", heading="Warnings", blocks=(Points(items=replayed.warnings),)))
    sections.append(Section(key="model", heading="The model", blocks=(Downloads(files=tuple(files)),)))
    return Document(
        title=title,
        subject=f"Replay: {title}",
        verdict=f"{line}.",
        tone="sure" if alike and not replayed.warnings else "open",
        answers=answers,
        sections=tuple(sections),
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
