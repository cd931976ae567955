"""Task 5: the recording without friction: angle, speed, acceleration and torque in SI units on one time axis."""

from __future__ import annotations

from bench.course.result import Number, Task
from bench.course.run import Run, extent, signals_chart

KEY, TITLE = "5", "Recording without friction"


def task(run: Run, key: str = KEY, title: str = TITLE) -> Task:
    """Draw the signals and say how far they reach."""
    return Task(
        key,
        title,
        (
            f"{run.time.size} samples, one each {run.sample_period * 1e3:.4g} ms, {run.time[-1]:.3g} s.",
            "The course asks for four graphs and names three: speed, acceleration and torque. The fourth here is the "
            "angle, which shows how far the disk turns and that the motion comes back.",
        ),
        (
            Number("largest speed", extent(run.velocity), "rad/s"),
            Number("largest acceleration", extent(run.acceleration), "rad/s²"),
            Number("largest torque", extent(run.torque), "N·m"),
        ),
        (signals_chart(run, f"Task {key}: {title.lower()}"),),
    )
