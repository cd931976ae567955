"""Mistakes that students make, each known by the figures that it gives on their own recordings."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bench.course.answers import Alpha, Way
from bench.course.t08_fast_samples import WIDTH


@dataclass(frozen=True)
class Mistake:
    """A known mistake.

    Attributes:
        name: of it.
        says: what went wrong, to the student.
        ways: in which recordings are worked out with it.
    """

    name: str
    explanation: str
    ways: tuple[Way, ...]


MISTAKES = (
    Mistake(
        "degrees for radians",
        "The speed went in in deg/s: divide by 180/π to get rad/s before anything else.",
        (Way(velocity=180.0 / math.pi),),
    ),
    Mistake(
        "milliamperes for amperes",
        "The current went in in mA: divide by 1000 before kT(Iq).",
        (Way(current=1e3), Way(current=1e3, constant="stall"), Way(current=1e3, constant="zero")),
    ),
    Mistake(
        "no kT(Iq)",
        "One torque constant was used at every current: torque is kT(Iq)·Iq with the curve of task 4.",
        (Way(constant="stall"), Way(constant="peak"), Way(constant="zero")),
    ),
    Mistake(
        "half-sample lag",
        "The mean was set back by its own delay alone: the backward difference is half a sample late besides, and "
        "J·α of that half sample is taken for friction.",
        (*(Way(alpha=Alpha(width, (width - 1) // 2)) for width in (3, 5, 7)), Way(alpha=Alpha(WIDTH, 1))),
    ),
    Mistake(
        "filter not synchronised",
        "alpha_filt was used as the filter delivers it: set it back by its delay, so that it belongs to the "
        "same time as "
        "speed and torque.",
        tuple(Way(alpha=Alpha(width, 0)) for width in (3, WIDTH, 5, 7)),
    ),
    Mistake(
        "backward difference",
        "The bare backward difference went into least squares: it is noisy and half a sample late; use alpha_filt on "
        "t_sync.",
        (Way(alpha=Alpha(1, 0)),),
    ),
    Mistake(
        "2π",
        "A factor of 2π is missing: rad/s = 2π·(turns per second), n/rpm = 60/(2π)·ω.",
        (Way(velocity=0.5 / math.pi), Way(rpm=2.0 * math.pi), Way(velocity=2.0 * math.pi)),
    ),
)
