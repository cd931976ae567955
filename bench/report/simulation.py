"""What MuJoCo simulates: a recording with its truth, a model run along a recording, and either of them in motion."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import get_args

import numpy as np

from bench.arrays import Array, rms
from bench.axis_kind import INERTIA, AxisKind
from bench.diagnosis.add import NULL
from bench.diagnosis.replay import LEFT, Replay
from bench.names import readable, words
from bench.plant.axis_model import parameter_quantities
from bench.plant.simulate import Simulated
from bench.report import document as doc
from bench.report.numbers import effort_word, number, sentence, share, unit_text
from bench.report.over_time import Plotted, in_steps, time_graph
from bench.report.parts import MOVES, NO_FURTHER, model_sections, one_panel, origin, values_table
from bench.report.robot_drawing import robot_drawing
from bench.trace.noise import white_noise
from bench.view.free_running import BARE, HELD, HORIZONS, FreeRun
from bench.view.joint_motion import JointMotion
from bench.view.side_by_side import RobotAlong, SideBySide

#: Numbers of a motion on a page, twice as many instants for each run: at most 0.25 MB.
MOST = 40_000
#: The axis of a model that is not coupled.
FREE_RUNNING = ("time since it was started", "s")
#: Points that are drawn of the curve of how far off it is.
DRAWN = 300
#: How much slower a page plays; what turns plays at first so that it goes round at most once a second.
SLOWED: tuple[doc.Slowed, ...] = get_args(doc.Slowed)


def simulation(simulated: Simulated, name: str, following: str = "") -> doc.Document:
    """The document of a simulated recording of a name; `following`: the command that shows what it determines."""
    truth, trace = simulated.truth, simulated.trace
    kind, values = truth.parameters.kind, dict[str, list[tuple[str, float, str]]]()
    for present in truth.effects:
        units = {quantity.name: kind.unit(quantity) for quantity in present.effect.quantities}
        values[words(present.name)] = [(words(quantity), value, units[quantity]) for quantity, value in present.values]
    effects = (
        f"{effect} ({', '.join(f'{quantity} {number(value, unit)}' for quantity, value, unit in found)})"
        for effect, found in values.items()
    )
    seconds = number(float(trace.time[-1] - trace.time[0]), "s", 3)
    hidden = f", with {', '.join(values)} in it" if values else ""
    axis = (
        (quantity.name, getattr(truth.parameters, field), quantity.unit)
        for field, quantity in parameter_quantities(kind).items()
    )
    rows = (
        (effect, quantity, number(value, digits=5), unit_text(unit))
        for effect, found in values.items()
        for quantity, value, unit in found
    )
    added = doc.table("Effects", ("effect", "quantity", "value>", "unit"), rows)
    true = (
        values_table("The axis, on the motor's side", axis),
        added if values else doc.Paragraph(text="No effect was added."),
    )
    return doc.Document(
        title=name,
        subject=f"Simulation of {truth.rig}: {name}",
        verdict=f"{seconds} of the profile {words(truth.profile)} were simulated{hidden}.",
        tone="open" if simulated.warnings else "sure",
        answers={
            f"{kind.in_words(INERTIA).capitalize()}?": number(truth.parameters.inertia, kind.inertia_unit, 5),
            "What is hidden?": "; ".join(effects) or "Nothing beyond inertia and friction.",
            "Where is the friction?": f"In the {truth.friction}.",
            "How sure?": "These values are exact; the recorded signals have the noise and resolution of the sensors.",
            **({"What next?": f"`{following}`; compare its result with these values."} if following else {}),
        },
        sections=doc.sections(
            doc.section("warnings", "Warnings", *([doc.points(simulated.warnings)] if simulated.warnings else [])),
            doc.section("motion", "Recorded and true", _recorded(simulated)),
            doc.section("truth", "The truth", *true),
            doc.section("files", "The numbers", doc.downloads(doc.file("truth.json", "the truth", truth.as_json()))),
        ),
        origin=(*origin(None), f"seed {truth.seed}"),
        warnings=simulated.warnings,
    )


def _recorded(simulated: Simulated) -> doc.TimeGraph:
    """Speed and position as recorded and as they were, and the recorded effort."""
    trace, states = simulated.trace, simulated.states
    ticks = ((trace.time - states.time[0]) / (states.time[1] - states.time[0])).round().astype(int)
    was = {"velocity": ("speed", states.velocity), "position": ("position", states.position)}
    signals = []
    for name, (label, true) in was.items():
        if name in trace:
            left = trace[name] - true[ticks]
            signals.append(Plotted(label, trace.units[name], trace.time, trace[name], [left], "true", "recorded"))
    efforts = [name for name in ("current", "torque", "force") if name in trace]
    signals += [Plotted(name, trace.units[name], trace.time, trace[name], name="recorded") for name in efforts]
    alternative = (
        f"Speed, position and {', '.join(efforts)} as the sensors recorded them, and speed and position as they were."
    )
    return time_graph("Over time.", alternative, trace.time, signals)


def matches(replayed: Replay) -> bool:
    """Whether a model explains a recording and moves as it does, and nothing speaks against it."""
    torque = _residual(replayed.torque, replayed.torque_simulated)[0]
    speed = _residual(replayed.velocity, replayed.velocity_simulated)[1]
    differs = speed > NULL * white_noise(replayed.velocity)  # not of a model that contains no motion
    return torque < LEFT and not differs and not replayed.warnings


def replay(replayed: Replay, model: Path, along: str, following: str = NO_FURTHER) -> doc.Document:
    """The document of a model's file that was run along a recording of a name; `following`: what to do next.

    Raises:
        InputError: the model cannot be read.
    """
    title, effort = f"{readable(model.name)} along {along}", effort_word(replayed.effort_unit)
    torque = _residual(replayed.torque, replayed.torque_simulated)
    speed = _residual(replayed.velocity, replayed.velocity_simulated)[1]
    line, moves = (
        f"The model does not explain {share(torque[0])} of the {effort}",
        "The model contains no motion, only torque.",
    )
    if math.isfinite(speed):
        off, noise = number(speed, replayed.speed_unit, 3), white_noise(replayed.velocity)
        line += f" and is off by {off} in simulated speed"
        like = "Yes" if speed <= NULL * noise else "Not wholly"
        moves = f"{like}: off by {off} RMS; the sensor's noise is {number(noise, digits=3)}."
    answers = {
        f"How large is the residual {effort}?": f"{number(torque[1], replayed.effort_unit, 3)} RMS",
        MOVES: moves,
        "Is it this axis?": sentence(" ".join(replayed.warnings)) or "Nothing speaks against it.",
        "What next?": following,
    }
    both = {
        ("speed", replayed.speed_unit): (replayed.velocity, replayed.velocity_simulated),
        (effort, replayed.effort_unit): (replayed.torque, replayed.torque_simulated),
    }
    signals = [Plotted(*of, replayed.time, seen, [seen - made]) for of, (seen, made) in both.items()]
    shown = f"Speed and {effort} of the recording as measured and as the model predicts them, and the residual of each."
    graph = time_graph("Over time.", shown, replayed.time, signals)
    motion = doc.section("motion", "Measured and simulated", graph)
    return doc.Document(
        title=title,
        subject=f"Replay: {title}",
        verdict=f"{line}.",
        tone="sure" if matches(replayed) else "open",
        answers=answers,
        sections=doc.sections(motion, *model_sections(model, replayed.warnings)),
        origin=origin(None),
    )


def _residual(measured: Array, simulated: Array) -> tuple[float, float]:
    """Share of a signal that is residual, and its RMS; nan where the model predicts nothing."""
    known = np.isfinite(simulated) & np.isfinite(measured)
    if not known.any():
        return math.nan, math.nan
    left = rms(measured[known] - simulated[known])
    return left / max(rms(measured[known]), 1e-300), left


def view(
    shown: SideBySide,
    model: Path,
    along: str,
    warnings: Sequence[str] = (),
    free: FreeRun | None = None,
    robot: RobotAlong | None = None,
    following: str = NO_FURTHER,
) -> doc.Document:
    """The document of a model's file in motion with its ghost, along a recording or profile of a name.

    `free` is how far off it runs by itself; a robot is drawn in place of the axis. `following`: what to do next.

    Raises:
        InputError: the model cannot be read.
    """
    title = f"{readable(model.name)} along {along}"
    kind, apart = shown.kind, shown.apart[np.isfinite(shown.apart)]
    furthest = number(float(np.abs(apart).max()), kind.length_unit, 3)
    seconds = number(float(shown.time[-1] - shown.time[0]), "s", 3)
    answers = {
        "What moves?": shown.simulated_is,
        "How large is the difference?": f"{number(rms(apart), kind.length_unit, 3)} RMS, {furthest} at most",
        **({} if free is None else {"And free-running?": _after(free, kind)}),
        "What next?": following,
    }
    both = {
        ("speed", kind.speed_unit): (shown.ghost_velocity, shown.velocity),
        ("position", kind.length_unit): (shown.ghost, shown.position),
    }
    signals = [
        Plotted(*of, shown.time, ghost, [ghost - simulated], name=shown.ghost_is)
        for of, (ghost, simulated) in both.items()
    ]
    alternative = f"Speed and position as {shown.ghost_is} and simulated; a line goes along with the drawing above."
    graph = time_graph("Over time.", alternative, shown.time, signals)
    return doc.Document(
        title=title,
        subject=f"View: {title}",
        verdict=f"The simulated axis stays within {furthest} of the motion {shown.ghost_is}, over {seconds}.",
        tone="open" if warnings else "sure",
        answers=answers,
        sections=doc.sections(
            doc.section("moving", "Moving", motion_of(shown, robot)),
            doc.section("motion", "Over time", graph),
            doc.section("free", "Free-running simulation", *([] if free is None else _let_free(free, kind))),
            *model_sections(model, warnings),
        ),
        origin=origin(None),
    )


def _after(free: FreeRun, kind: AxisKind) -> str:
    """How far off it is a while after it was started."""
    at = [(horizon, int(np.searchsorted(free.time, horizon * (1.0 - 1e-6)))) for horizon in HORIZONS]
    at = [(number(horizon, "s"), k) for horizon, k in at if k < free.time.size]
    at = at or [(number(float(free.time[-1]), "s", 3), -1)]
    off = (f"after {when} {number(float(free.position[k]), kind.length_unit, 3)}" for when, k in at)
    return f"{', '.join(off)} RMS, of {free.windows} windows"


def _let_free(free: FreeRun, kind: AxisKind) -> Iterator[doc.Chart]:
    """How far off position and speed are over the time since it was started."""
    every = max(free.time.size // DRAWN, 1)
    alternative = (
        f"RMS of simulated less measured over the time since the model was started: {free.windows} windows begin "
        "at the sensors' values, and then only the recorded effort drives the model."
    )
    for name, unit, off in (("position", kind.length_unit, free.position), ("speed", kind.speed_unit, free.velocity)):
        label = f"{name} off (RMS)"
        drawn = doc.series(label, "line", "model", free.time[::every], off[::every])
        yield one_panel(f"{sentence(name)}.", alternative, FREE_RUNNING, (label, unit), [drawn])


def motion_of(shown: SideBySide, robot: RobotAlong | None = None) -> doc.Moving:
    """The motion at instants of equal distance, each as of the sample next to it; nan in holes."""
    time = shown.time
    period = float(np.median(np.diff(time)))
    runs = {HELD: shown.position, **shown.others}
    count = min(round(float(time[-1] - time[0]) / period) + 1, 2 * MOST // (1 + len(runs)))
    instants, step = np.linspace(time[0], time[-1], count, retstep=True)
    after = np.clip(np.searchsorted(time, instants), 1, time.size - 1)
    nearest = after - (instants - time[after - 1] < time[after] - instants)
    known = np.abs(time[nearest] - instants) <= 0.75 * max(float(step), period)
    ghost = np.where(known, shown.ghost[nearest], np.nan)
    apart = {how: np.where(known, (values - shown.ghost)[nearest], np.nan) for how, values in runs.items()}
    both = np.concatenate([shown.ghost, shown.position])
    low, high = float(np.nanmin(both)), float(np.nanmax(both))
    low, high = (low, high) if high > low else (low - 0.5, low + 0.5)
    slowed: doc.Slowed = 1
    if shown.kind.turns:
        turns = float(np.nanmax(np.abs(shown.ghost_velocity))) / (2.0 * np.pi)
        slowed = SLOWED[min(int(np.searchsorted(SLOWED, turns)), len(SLOWED) - 1)]
    otherwise = " How it is run otherwise is chosen below." if shown.others else ""
    return doc.Moving(
        title="The axis." if robot is None else f"The robot, and {readable(robot.joint)} of it as measured.",
        alternative=f"{shown.simulated_is}{otherwise} The ghost is the motion {shown.ghost_is}.",
        turns=shown.kind.turns,
        unit=unit_text(shown.kind.length_unit),
        ghost=shown.ghost_is,
        start=float(time[0]),
        step=float(step),
        count=count,
        low=low,
        high=high,
        slowed=slowed,
        position=doc.packed(ghost),
        runs=tuple(doc.ModelRun(name=how, apart=in_steps(values)) for how, values in apart.items()),
        robot=None if robot is None else robot_drawing(robot),
    )


def moving_section(mjcf: Path, motions: Mapping[str, JointMotion]) -> doc.Section:
    """The robot along the log that most joints were identified from, and the error of each when free-running."""
    origins = [motion.origin for motion in motions.values()]
    charts = []
    for unit, move in (("rad", "turn"), ("m", "slide")):
        free = {name: one for name, one in motions.items() if one.unit == unit and one.off.size}
        colours: Iterator[doc.Colour] = cycle(doc.COLOURS)
        drawn = [doc.series(readable(name), "line", next(colours), one.horizon, one.off) for name, one in free.items()]
        if drawn:
            alternative = (
                f"RMS of simulated less measured position of the joints that {move}, over the time since the model of"
                " each was started, driven by its recorded torque, with the others as measured."
            )
            charts.append(
                one_panel("Free-running simulation.", alternative, FREE_RUNNING, ("position off (RMS)", unit), drawn)
            )
    robot = _robot_motion(mjcf, max(origins, key=origins.count), motions)
    return doc.section("moving", "Moving", robot, *charts)


def _robot_motion(mjcf: Path, along: str, motions: Mapping[str, JointMotion]) -> doc.Moving:
    """A robot along a log by its joints' motions, the first of which is given in numbers; those of other logs stand as
    measured in this one.
    """
    here = {name: one for name, one in motions.items() if one.origin == along}
    first, motion = next(iter(here.items()))
    robot = RobotAlong(mjcf, first, 1.0, motion.time, motion.measured)
    ways = dict.fromkeys(how for one in here.values() for how in one.runs)
    runs = sorted(ways, key=lambda how: [HELD, BARE, how].index(how))

    def apart(name: str, how: str) -> Array:
        """Of a joint that the log contains; as weakly coupled where its model has nothing to leave out."""
        one = here.get(name)
        return np.zeros_like(motion.time) if one is None else one.runs.get(how, one.runs[HELD]) - one.measured[name]

    measured = motion.measured[first]
    low, high = float(measured.min()), float(measured.max())
    return doc.Moving(
        title=f"The robot along {readable(Path(along).name)}; the numbers are of {readable(first)}.",
        alternative="Each joint's recorded torque drives its model with the others as measured. How it is run is"
        " chosen below. The ghost is the robot as measured.",
        turns=motion.unit == "rad",
        unit=motion.unit,
        ghost="measured",
        start=float(motion.time[0]),
        step=float(motion.time[1] - motion.time[0]),
        count=motion.time.size,
        low=low,
        high=max(high, low + 1e-9),
        position=doc.packed(measured),
        runs=tuple(
            doc.ModelRun(
                name=how,
                apart=in_steps(apart(first, how)),
                others=tuple(in_steps(apart(name, how)) for name in motion.measured if name != first),
            )
            for how in runs
        ),
        robot=robot_drawing(robot),
    )
