"""The rail that a slide is drawn on: geometry only; the page's style sheet draws it."""

from __future__ import annotations

from bench.report.page.chart import Scale, Tick, ticks
from bench.report.page.scripted import Motion

#: Ends of the travel in the drawing, which is 760 wide.
LEFT, RIGHT = 80.0, 680.0


def ruler(motion: Motion) -> list[Tick]:
    """Places along the rail with their labels."""
    scale = Scale(motion.low, motion.high, LEFT, RIGHT)
    return [Tick(scale(value), label) for value, label in ticks(motion.low, motion.high, 8)]
