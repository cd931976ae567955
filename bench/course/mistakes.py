"""Known mistakes, one a row: what a form, a recording or a flight shows of it, and what undoes it there.

Forms are compared with the figures that a mistake gives on the student's own recordings. Recordings and flights that
contradict the axis or each other are freed of mistakes until nothing contradicts any more.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from bench.arrays import Array
from bench.course.axis import TURN
from bench.course.methods import RPM, WIDTH
from bench.course.plausible import LATE, balance, glitches
from bench.course.run import LabRun, made_run
from bench.course.ways import LATE_METHODS, Way
from bench.rig.rig import Rig

DEG = math.pi / 180.0
#: Units of speed that are mistaken for each other, in rad/s.
SPEEDS = {"rad/s": 1.0, "deg/s": DEG, "rpm": 1.0 / RPM, "turns/s": 2.0 * math.pi}
#: Rounds in which a delay is searched, as a long one is not linear.
ROUNDS = 6
TOGETHER = "record both in one task of the drive"
HALF_SAMPLE, BARE = "half-sample lag", "backward difference"
#: What the text's equations give literally: its backward difference (16) is half a sample late, in the bare and in the
#: filtered acceleration.
AS_THE_TEXT_SAYS = (HALF_SAMPLE, BARE)


@dataclass(frozen=True)
class Mistake:
    """A mistake, by what it shows in; the rest is empty.

    Attributes:
        name, why: of an answer: for the teacher, and what went wrong, to the student.
        ways: in which recordings are worked out with it.
        slip: what it changes of the figures where it is made after the work is done.
        kind: of two of a kind a recording has only one.
        words: of a recording or a flight: what is wrong, and what to do.
        undo: gives a recording without it; None where it cannot have been made.
        undo_of_flight: gives a flight (n, 2) without it.
    """

    name: str = ""
    why: str = ""
    ways: tuple[Way, ...] = ()
    slip: Callable[[Mapping[str, float]], dict[str, float]] | None = None
    kind: str = ""
    words: str = ""
    undo: Callable[[LabRun, Rig], LabRun | None] | None = None
    undo_of_flight: Callable[[Array], Array] | None = None


def scaled(velocity: float = 1.0, current: float = 1.0, period: float = 1.0) -> Callable[[LabRun, Rig], LabRun]:
    """A function that gives a recording with its speed, current and sample period times these factors."""

    def undo(run: LabRun, rig: Rig) -> LabRun:
        return made_run(run.velocity * velocity, run.current * current, run.sample_period * period, rig)

    return undo


def _in_time(run: LabRun, rig: Rig) -> LabRun | None:
    """With the current set back by as many samples as it is late."""
    late = 0
    for _ in range(ROUNDS):
        size = run.time.size - abs(late)
        velocity, current = run.velocity[max(-late, 0) :][:size], run.current[max(late, 0) :][:size]
        shifted = made_run(velocity, current, run.sample_period, rig)
        found = balance(shifted)
        if found is None or abs(found.late) <= LATE:
            return shifted if late and found is not None else None
        late += round(found.late) or int(math.copysign(1, found.late))
        if abs(late) > run.time.size // 4:
            return None
    return None


def _without_glitches(run: LabRun, rig: Rig) -> LabRun | None:
    """With samples that stand alone replaced by the line through their neighbours."""
    alone = (run.velocity, glitches(run.velocity, smooth=True)), (run.current, glitches(run.current, smooth=False))
    if not any(places.size for _, places in alone):
        return None
    velocity, current = (
        np.interp(run.time, np.delete(run.time, places), np.delete(values, places)) for values, places in alone
    )
    return made_run(velocity, current, run.sample_period, rig)


def _columns_swapped(run: LabRun, rig: Rig, speed: float = 1.0, ampere: float = 1.0) -> LabRun:
    """With the numbers of speed and current exchanged, as both were written in units worth so much in SI."""
    return made_run(run.current / ampere * speed, run.velocity / speed * ampere, run.sample_period, rig)


def _speeds(*pairs: tuple[str, str]) -> list[Mistake]:
    """Speeds that are in the first unit of a pair and labelled with the second."""
    words = "the speed looks like {} that is labelled {}: correct its unit"
    return [
        Mistake(kind="speed", words=words.format(unit, label), undo=scaled(velocity=SPEEDS[unit] / SPEEDS[label]))
        for unit, label in pairs
    ]


def _inertias(figures: Mapping[str, float], factor: float) -> dict[str, float]:
    return {name: factor * value for name, value in figures.items() if name.startswith("J")}


#: Those with both show in forms and in recordings.
MISTAKES: tuple[Mistake, ...] = (
    Mistake(kind="columns", words="the columns of speed and current look exchanged", undo=_columns_swapped),
    Mistake(
        kind="columns",
        words="the columns of speed (deg/s) and current (mA) look exchanged",
        undo=lambda run, rig: _columns_swapped(run, rig, DEG, 1e-3),
    ),
    Mistake(
        name="degrees for radians",
        why="The speed went in in deg/s: divide by 180/π to get rad/s before anything else.",
        ways=(Way(velocity=1.0 / DEG),),
    ),
    *_speeds(("deg/s", "rad/s"), ("rad/s", "deg/s"), ("rpm", "rad/s"), ("rad/s", "rpm"), ("deg/s", "rpm")),
    *_speeds(("rpm", "deg/s"), ("turns/s", "rad/s"), ("rad/s", "turns/s")),
    Mistake(
        name="milliamperes for amperes",
        why="The current went in in mA: divide by 1000 before kT(Iq).",
        ways=(Way(current=1e3), Way(current=1e3, constant="stall"), Way(current=1e3, constant="zero")),
        kind="current",
        words="the current looks like mA that is labelled A: correct its unit",
        undo=scaled(current=1e-3),
    ),
    Mistake(
        kind="current", words="the current looks like A that is labelled mA: correct its unit", undo=scaled(current=1e3)
    ),
    Mistake(
        name="no kT(Iq)",
        why="One torque constant was used at every current: torque is kT(Iq)·Iq with the curve of task 4.",
        ways=(Way(constant="stall"), Way(constant="peak"), Way(constant="zero")),
    ),
    Mistake(
        name=HALF_SAMPLE,
        why="The mean was set back by its own delay alone: the backward difference is half a sample late, too, and "
        "J·α of that half sample appears as friction.",
        ways=(
            *(Way(width=width, set_back=(width - 1) // 2) for width in (3, 5, 7)),
            Way(set_back=1),
            *(Way(method=method) for method in LATE_METHODS),
        ),
    ),
    Mistake(
        name="filter not synchronised",
        why="alpha_filt was used as the filter delivers it: set it back by its delay, so that it belongs to the same "
        "time as speed and torque.",
        ways=tuple(Way(width=width, set_back=0) for width in (3, WIDTH, 5, 7)),
    ),
    Mistake(
        name=BARE,
        why="The bare backward difference went into least squares: it is noisy and half a sample late; use alpha_filt "
        "on t_sync.",
        ways=(Way(width=1, set_back=0),),
    ),
    Mistake(
        name="2π",
        why="A factor of 2π is missing: rad/s = 2π·(turns per second), n/rpm = 60/(2π)·ω.",
        ways=(Way(velocity=0.5 / math.pi), Way(rpm=2.0 * math.pi), Way(velocity=2.0 * math.pi)),
    ),
    Mistake(
        name="rpm for rad/s",
        why="The speed went in in rpm: rad/s = 2π/60·n.",
        ways=(Way(velocity=RPM),),
    ),
    Mistake(
        name="wrong sign",
        why="Current and speed are counted in opposite directions: an inertia is positive. Turn one of them.",
        ways=(Way(current=-1.0),),
        kind="sign",
        words=f"current and speed are counted in opposite directions: {TURN}",
        undo=scaled(current=-1.0),
    ),
    Mistake(
        name="peak value for RMS",
        why="The current is √2 times too large: kT of the datasheet is per ampere RMS.",
        ways=(Way(current=math.sqrt(2.0)),),
        kind="amplitude",
        words="the current looks like a peak value where kT takes the RMS value, √2 times too large: divide it by √2",
        undo=scaled(current=math.sqrt(0.5)),
    ),
    Mistake(
        kind="amplitude",
        words="the current looks √2 times too small: multiply it by √2",
        undo=scaled(current=math.sqrt(2)),
    ),
    Mistake(
        kind="time", words="the times look like ms that are labelled s: correct their unit", undo=scaled(period=1e-3)
    ),
    Mistake(
        kind="time", words="the times look like s that are labelled ms: correct their unit", undo=scaled(period=1e3)
    ),
    Mistake(kind="delay", words=f"current and speed are not of the same instants: {TOGETHER}", undo=_in_time),
    Mistake(kind="glitch", words="a glitch: take these samples out, or record again", undo=_without_glitches),
    Mistake(
        name="J_motor not subtracted",
        why="J_load = J - J_motor: the rotor turns, too, and is no part of the load.",
        slip=lambda f: {f"J_load{of}": f[f"J{of}"] for of in ("", "_without_friction") if f"J{of}" in f},
    ),
    Mistake(
        name="K_w and K_0 exchanged",
        why="The second column of A is ω and has K_w - N*m*s/rad -, the third sgn(ω) and has K_0 - N*m.",
        slip=lambda f: {"K_fric_w": f["K_fric_0"], "K_fric_0": f["K_fric_w"]} if "K_fric_w" in f else {},
    ),
    Mistake(
        name="kg·m² as kg·cm²",
        why="1 kg·m² = 10⁴ kg·cm²: the number is in kg·m².",
        slip=lambda f: _inertias(f, 1e-4),
    ),
    Mistake(
        name="kg·cm² as kg·m²",
        why="1 kg·m² = 10⁴ kg·cm²: the number is in kg·cm².",
        slip=lambda f: _inertias(f, 1e4),
    ),
    Mistake(
        name="rad/s as rpm",
        why="The number is in rad/s: n/rpm = 60/(2π)·ω.",
        slip=lambda f: {"corner": f["corner"] / RPM} if "corner" in f else {},
    ),
    Mistake(words="its y and z are exchanged", undo_of_flight=lambda flight: flight[:, ::-1]),
    Mistake(words="it is in mm where the others are in m", undo_of_flight=lambda flight: flight * 1e-3),
    Mistake(words="it is in cm where the others are in m", undo_of_flight=lambda flight: flight * 1e-2),
    Mistake(words="it is in m where the others are in mm", undo_of_flight=lambda flight: flight * 1e3),
    Mistake(words="it is in m where the others are in cm", undo_of_flight=lambda flight: flight * 1e2),
    Mistake(words="its y is counted the other way", undo_of_flight=lambda flight: flight * [-1.0, 1.0]),
    Mistake(words="its z is counted the other way", undo_of_flight=lambda flight: flight * [1.0, -1.0]),
)
#: Slips by name, and what they change of the figures.
SLIPS = {mistake.name: mistake.slip for mistake in MISTAKES if mistake.slip is not None}
