"""Task 5: the recording without friction: angle, speed, acceleration and torque in SI units on one time axis."""

from __future__ import annotations

import numpy as np

from bench.course.recordings import LabRecordings, LabRun
from bench.course.result import DoneTask, Number, chart, curve, panel

KEY, TITLE = "5", "Recording without friction"


def task(recordings: LabRecordings) -> DoneTask:
    """Draw the signals and say how far they reach."""
    return signals_of(recordings.without_friction, KEY, TITLE)


def signals_of(run: LabRun, key: str, title: str) -> DoneTask:
    """The signals of a recording one above the other, and how far they reach, under a task's key and title."""
    signals = {
        "angle φ / rad": run.angle,
        "speed ω / (rad/s)": run.velocity,
        "acceleration α / (rad/s²)": run.acceleration,
        "torque M / (N·m)": run.torque,
    }
    findings = (
        f"{run.time.size} samples, one each {run.sample_period * 1e3:.4g} ms, {run.time[-1]:.3g} s.",
        "The course asks for four graphs and names three: speed, acceleration and torque. The fourth here is the "
        "angle, which shows how far the disk turns and that the motion comes back.",
    )
    largest = {
        ("largest speed", "rad/s"): run.velocity,
        ("largest acceleration", "rad/s²"): run.acceleration,
        ("largest torque", "N·m"): run.torque,
    }
    numbers = tuple(Number(name, float(np.abs(values).max()), unit) for (name, unit), values in largest.items())
    panels = (panel("time / s", label, curve(run.time, values)) for label, values in signals.items())
    return DoneTask(key, title, findings, numbers, (chart(f"Task {key}: {title.lower()}", *panels),))
