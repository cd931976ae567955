"""Sliders in the report's page: what `data/lab/sliders.js` needs to work out tasks 8 to 11 anew, in SI."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from bench.assets import asset
from bench.course import peak_torque
from bench.course.axis import MAINS, RPM, circuit, motor_value, torque_constant
from bench.course.corner import EVERY, SHARES, TIME_CONSTANTS
from bench.course.friction import DELAY, EDGE, SMOOTHING, WIDTH, steepest
from bench.course.recordings import LabRecordings, LabRun
from bench.course.result import TaskResult
from bench.course.winding import CURRENT_LOOP, LENGTH, STEP, VELOCITY_GAIN, identified_axis
from bench.fit.lab import LEAST_SPEED
from bench.report.document import packed
from bench.report.html import Program
from bench.rig.limits import COLD, HOT, peak_curve
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter

#: Tasks that sliders redraw.
REDRAWN = ("8", "9", "10", "11")
#: What the script gets of each slider, beside the tasks that it redraws.
OF_A_SLIDER = ("key", "label", "unit", "start", "step", "below", "above")
SCRIPT = asset("data", "lab", "sliders.js")


def sliders(results: Sequence[TaskResult], recordings: LabRecordings) -> Program | None:
    """The page's program for those of REDRAWN that were done; None without one."""
    done = {result.key: result for result in results if result.reason is None and result.key in REDRAWN}
    if not done:
        return None
    data: dict[str, Any] = {"charts": {key: _looks(result) for key, result in done.items()}}
    if {"8", "9"} & done.keys():
        data["friction"] = _friction(recordings.with_friction, recordings.rig)
        if "8" in done:
            in_step = done["8"].charts[1].panels[2].series[0]
            data["friction"]["close"] = in_step.x, in_step.y
    if "10" in done:
        data["fastest"] = _fastest(recordings.fastest, recordings.rig, done["10"])
    if "11" in done:
        data["winding"] = _winding(recordings)
    return Program(SCRIPT.read_text(encoding="utf-8"), {**data, "sliders": _sliders(data)})


def _looks(result: TaskResult) -> list[list[list[dict[str, str]]]]:
    """How each series of each panel of each chart is drawn."""
    return [
        [[{"style": one.style, "colour": one.colour} for one in panel.series] for panel in chart.panels]
        for chart in result.charts
    ]


def _sliders(data: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Each starts where the report stands and goes so many steps below and above."""
    found = []

    def slider(key: str, label: str, unit: str, start: float, step: float, ends: tuple[int, int], *tasks: str) -> None:
        own = zip(OF_A_SLIDER, (key, label, unit, start, step, *ends), strict=True)
        found.append({**dict(own), "tasks": [task for task in tasks if task in data["charts"]]})

    slider("kT", "kT(Iq) times", "", 1.0, 0.01, (10, 10), *REDRAWN)
    if friction := data.get("friction"):
        later = "8", "9", *(("11",) if "9" in data["charts"] else ())  # whose axis is that of task 9
        slider("late", "samples that α is late", "", 0.0, 0.5, (2 * DELAY, 2 * DELAY), *later)
        found[-1]["also"] = 1e3 * friction["period"], "ms"
        slider("least", "least |ω|", "rad/s", LEAST_SPEED, 1.0, (int(LEAST_SPEED), 60), *later)
    if winding := data.get("winding"):
        own = winding["circuit"]
        cold = own["cold_share"] * own["resistance"]
        slider("T", "R(T) cold, at", "°C", COLD, 5.0, (4, 20), "10", "11")
        inductance = 1e3 * own["time_constant"] * cold
        slider("L", "inductance L", "mH", inductance, inductance / 6.0, (5, 10), "11")
        found[-1]["also"] = 1.0 / cold, "ms L/R"
    return found


def _friction(run: LabRun, rig: Rig) -> dict[str, Any]:
    smooth = GaussianFilter(SMOOTHING * run.sample_period, run.sample_period)
    impulse = np.zeros(4 * smooth.margin + 1)
    impulse[2 * smooth.margin] = 1.0
    return {
        "velocity": packed(run.velocity, "<f8"),
        "torque": packed(run.torque, "<f8"),
        "period": run.sample_period,
        "width": WIDTH,
        "delay": DELAY,
        "kernels": smooth(impulse, 0, 1, 2)[:, ::-1].tolist(),
        "edge": steepest(run),
        "reach": EDGE,
        "rotor": rig.motor.rotor_inertia,
    }


def _fastest(run: LabRun, rig: Rig, task: TaskResult) -> dict[str, Any]:
    speed, torque = peak_torque.datasheet_curve(rig)
    corner = next(one for one in task.charts[0].panels[0].series if one.name == "corner")
    return {
        "velocity": packed(run.velocity, "<f8"),
        "torque": packed(run.torque, "<f8"),
        "full": peak_torque.FULL_SHARE * (rig.motor.peak_torque or 0.0),
        "least": peak_torque.LEAST_TORQUE,
        "speeds": peak_torque.SPEEDS,
        "bin": peak_torque.HALF_BIN,
        "tail": peak_torque.STILL_RISING,
        "sheet": [speed.tolist(), torque.tolist()],
        "corner": [corner.x[0] / RPM, corner.y[0]],
    }


def _winding(recordings: LabRecordings) -> dict[str, Any]:
    rig, axis = recordings.rig, identified_axis(recordings)
    own, constant = circuit(rig), torque_constant(rig)
    low, others = peak_curve(rig.motor, MAINS, rig.source), rig.motor.peak_curves
    corners = [low, *(one for one in others if one.mains_voltage != MAINS)][:2]
    return {
        "circuit": {**asdict(own), "ke": own.back_emf_constant, "per_kelvin": own.temperature_coefficient},
        "constant": constant.constant,
        "curvature": constant.curvature,
        "peak": motor_value(rig, "peak_current"),
        "axis": [axis.inertia, axis.viscous_friction_coefficient, axis.coulomb_friction],
        "corners": [[one.mains_voltage, one.corner_speed, one.no_load_speed] for one in corners],
        "points": peak_torque.POINTS,
        "sheet": [values.tolist() for values in peak_torque.datasheet_curve(rig)],
        "fall": {name.lower(): getattr(peak_torque, name) for name in ("TOP", "FROM", "TO")}
        | {"tail": peak_torque.STILL_RISING},
        "hot": HOT,
        "cold": COLD,
        "step": STEP,
        "loop": CURRENT_LOOP,
        "gain": VELOCITY_GAIN,
        "length": LENGTH,
        "taus": TIME_CONSTANTS,
        "shares": SHARES,
        "every": EVERY,
    }
