"""A servo: its parameters with intervals, what cannot be separated and by which motion it would be.

As the contract's JSON (`bench.servo/1`) and as a document, with the free-running motion before and after, or a drive's
torque, and the MuJoCo actuator to take along.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from bench.export.actuator import isaaclab_actuators, mjlab_actuators, position_actuator
from bench.names import words
from bench.parameter import Parameter
from bench.report import document as doc
from bench.report.numbers import brief, interval, number, sentence, share, unit_text
from bench.report.over_time import Plotted, time_graph
from bench.report.parts import MOVES, NO_FURTHER, checks_section, one_panel, origin, parameters_table
from bench.report.serial import as_json, serialised
from bench.servos.drive import COMBINED, GAINS
from bench.servos.servo import Servo

SCHEMA = "bench.servo/1"
ACTUATOR, JSON = "actuator.xml", "servo.json"
#: What a stated value is next to an interval.
SAYS = {True: "agrees", False: "differs"}
#: Times of the glance - s.
GLANCE = 4.0


def servo_json(found: Servo, provenance: Mapping[str, Any] | None = None) -> str:
    """The servo as the contract's JSON."""
    return serialised({"schema": SCHEMA, **servo_content(found), "provenance": provenance})


def servo_content(found: Servo) -> dict[str, Any]:
    """What the JSON has of the servo itself."""
    of = found.found
    gaps = {name: {"before": gap.before, "after": gap.after} for name, gap in found.gaps.items()}
    signal, unit = found.compared
    stated = {name: {"value": one.value, "agrees": one.agrees} for name, one in of.stated.items()}
    return {
        "verdict": found.verdict,
        "effects": [{"name": name, "parameters": values} for name, values in of.effects.items()],
        "parameters": of.parameters,
        "inseparable": [{"combination": name, **as_json(value)} for name, value in of.inseparable.items()],
        "separated_by": of.advice,
        "refused": of.refused,
        "gap": {signal: {"unit": unit, "noise_floor": found.noise_floor, **gaps}},
        "checks": found.checks,
        "warnings": found.warnings,
        "actuator": of.actuator or None,
        **({"stated": stated} if stated else {}),
    }


def servo(found: Servo, title: str, provenance: Mapping[str, Any] | None = None) -> doc.Document:
    """The document of a servo that `title` names."""
    of, graph = found.found, _graph(found)
    tables = [parameters_table("The servo", {**of.parameters, **_flat(of.effects)})]
    if of.inseparable:
        rows = (
            (words(name), interval(value, unit=False), unit_text(value.unit)) for name, value in of.inseparable.items()
        )
        caption = "Cannot be separated: only these combinations are determined"
        tables.append(doc.table(caption, ("combination", "value ± half interval (95 %)>", "unit"), rows))
    if of.stated:
        rows = (
            (
                words(name),
                number(one.value, digits=5),
                interval(one.found, unit=False),
                unit_text(one.found.unit),
                SAYS[one.agrees],
            )
            for name, one in of.stated.items()
        )
        heads = "quantity", "stated>", "found ± half interval (95 %)>", "unit", "result"
        tables.append(doc.table("Compared with [drive] of the rig", heads, rows))
    if of.refused:
        rows = ((words(name), sentence(why)) for name, why in of.refused.items())
        tables.append(doc.table("Not determined", ("quantity", "why~"), rows))
    files = [doc.file(JSON, "all of it as numbers", servo_json(found, provenance) + "\n")]
    if of.actuator:
        of_mujoco = doc.file(ACTUATOR, "the MuJoCo actuator", position_actuator(found.joint, of.actuator))
        files = [of_mujoco, *of_trainers({found.joint: of.actuator}), *files]
    return doc.Document(
        title=title,
        subject=f"{'Position servo' if found.law is None else 'Drive'} of {title}",
        verdict=_verdict(found),
        tone="open" if found.verdict == "unexplained_remainder" else "sure",
        answers=servo_answers(found),
        glance=(_glance(found),),
        sections=doc.sections(
            doc.section("parameters", "Parameters", *tables),
            doc.section("separate", "What would separate them", *([doc.points(of.advice)] if of.advice else [])),
            doc.section("motion", "Goal, measured and simulated", graph, detail=True),
            checks_section(found.checks, found.warnings),
            doc.section("model", "The model", doc.downloads(*files), detail=True),
        ),
        origin=origin(provenance),
        pictures=(doc.Picture(name="servo", title=title, rows=((_glance(found),),)),),
        warnings=found.warnings,
    )


def of_trainers(servos: Mapping[str, Mapping[str, float]]) -> list[doc.File]:
    """The actuators of joints for what trains policies, to take along."""
    return [
        doc.file("mjlab.py", "the actuators for mjlab", mjlab_actuators(servos)),
        doc.file("isaaclab.py", "the actuators for Isaac Lab", isaaclab_actuators(servos)),
    ]


def _flat(effects: Mapping[str, Mapping[str, Parameter]]) -> dict[str, Parameter]:
    return {f"{name}: {quantity}": value for name, of in effects.items() for quantity, value in of.items()}


def _verdict(found: Servo) -> str:
    gap, unit = found.gaps["identify"], found.compared[1]
    change = f"{number(gap.before, unit, 3)} before, {number(gap.after, unit, 3)} after"
    if found.law is not None:
        part = "part of " * (found.verdict == "unexplained_remainder")
        return (
            f"The fitted cascade explains {part}the drive's torque: along the measured motion it differs by {change}."
        )
    if gap.after >= gap.before:
        return f"The fitted servo does not move like the measured one: its free-running position differs by {change}."
    if found.verdict == "unexplained_remainder":
        return f"The fitted servo explains part of the motion: its free-running position differs by {change}."
    return f"The fitted servo moves like the measured one: its free-running position differs by {change}."


def servo_answers(found: Servo) -> dict[str, str]:
    """Gains, dead time, what else the servo has, and how well it moves."""
    of, (signal, unit) = found.found, found.compared
    named = {**of.parameters, **of.inseparable}
    own = (*GAINS, *COMBINED) if found.law else [name for name in named if name.startswith(("kp", "kv", "(k"))]
    gains = [f"{words(name)} {brief(value)}" for name, value in named.items() if name in own]
    late = of.parameters.get("dead_time")
    if late is None:
        dead = f"Not determined: {of.refused['dead_time']}."
    else:
        half = number(1e3 * late.half_width, "ms", 2)
        dead = f"{number(1e3 * late.value, 'ms', 3)} ± {half}, of command and sensor together."
    gap = found.gaps.get("holdout", found.gaps["identify"])
    where = "on the holdout" if "holdout" in found.gaps else "on the log"
    more = ", ".join(words(name) for name in of.effects) or "nothing beyond gains, dead time, limit and friction"
    partly = found.verdict == "unexplained_remainder"
    record = "Record the current too: with it, diagnose finds the missing effect." if partly else NO_FURTHER
    moves = "No" if gap.after >= gap.before else "Partly" if partly else "Yes"
    how = (
        f"free-running {where}, the position"
        if found.law is None
        else f"{where}, along the measured motion, the {signal}"
    )
    return {
        "Gains?": f"{'; '.join(gains)}.",
        "Dead time?": dead,
        "What was missing?": f"{sentence(more)}.",
        "How sure?": f"Half widths are those of 95 % intervals{', which do not cover the residual' * partly}.",
        MOVES: f"{moves}: {how} differs "
        f"by {number(gap.after, unit, 3)} RMS, {number(gap.after / found.noise_floor, digits=2)} × the sensor noise; "
        f"with {found.before} by {number(gap.before, unit, 3)} ({share(gap.after / gap.before)} remains).",
        "What next?": f"For {of.advice[0]}" if of.advice else record,
    }


def _glance(found: Servo) -> doc.Chart:
    """The part of the log in which most of the motion is."""
    motion, (signal, unit) = found.motion, found.compared
    most = motion.measured if motion.goal is None else motion.goal
    size = max(2, int(GLANCE / max(float(motion.time[1] - motion.time[0]), 1e-9)))
    step = max(1, size // 4)
    starts = range(0, max(1, motion.time.size - size), step)
    start = max(starts, key=lambda at: float(np.ptp(most[at : at + size])))
    part = slice(start, start + size)
    drawn = [
        doc.series("measured", "wide", "ink", motion.time[part], motion.measured[part]),
        doc.series("before", "dashes", "residual", motion.time[part], motion.before[part]),
        doc.series("after", "line", "model", motion.time[part], motion.after[part]),
    ]
    if motion.goal is not None:
        drawn.insert(0, doc.series("goal", "dotted", "first", motion.time[part], motion.goal[part]))
    alternative = f"Goal, measured position, and free-running simulations: {found.before}, and the fitted servo."
    if found.law is not None:
        alternative = f"Measured {signal}, and that along the measured motion: {found.before}, and the fitted cascade."
    return one_panel(f"{signal.capitalize()}.", alternative, ("time", "s"), (signal, unit), drawn)


def _graph(found: Servo) -> doc.TimeGraph:
    motion, (signal, unit) = found.motion, found.compared
    left = (motion.measured - motion.before, motion.measured - motion.after)
    signals = [Plotted(signal, unit, motion.time, motion.measured, left)]
    if motion.goal is not None:
        signals.append(Plotted("goal", unit, motion.time, motion.goal, name="goal"))
    alternative = f"Measured {signal} and simulations over time, with the residual of each."
    fitted = "the fitted servo" if found.law is None else "the fitted cascade"
    return time_graph("Motion.", alternative, motion.time, signals, (found.before, fitted))
