"""Friction emulated by the drive's software against friction in the mechanics: which current is recorded decides."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.course.axis import KG_CM2, simulated_with, torque_constant
from bench.course.recordings import LabRecordings, run_of
from bench.course.result import EXAMPLE, DoneTask, Number
from bench.course.t09_least_squares import EquationOfMotion, identify_friction
from bench.fit.identify import identify
from bench.plant.axis_model import AxisParameters
from bench.plant.sensing import Sensors
from bench.plant.simulate import simulate
from bench.rig.rig import Rig
from bench.trace.trace import Trace

KEY, TITLE = "emulation", "Friction in the drive's software and in the mechanics"

MECHANICS, SETPOINT, PHASES = "in the mechanics", "emulated", "emulated, phases"


def record_each(rig: Rig) -> dict[str, Trace]:
    """One motion with friction in the mechanics, and emulated with either current in the recording.

    The set-point is what the drive asks for before its software subtracts the friction; through the phases flows what
    is left of it.
    """
    mechanics = simulate(simulated_with(rig, friction="mechanics"), "fast_reversals").trace
    emulated = simulate(simulated_with(rig, friction="drive"), "fast_reversals")
    flowing = replace(emulated.states, torque=emulated.states.motor_torque)
    sensors = Sensors.from_rig(rig)
    phases = sensors.record(flowing, emulated.references, np.random.default_rng(0), f"{emulated.trace.origin}, phases")
    return {MECHANICS: mechanics, SETPOINT: emulated.trace, PHASES: phases}


def task(recordings: LabRecordings) -> DoneTask:
    """Simulate all three, identify each as the course does and by the default estimator.

    Raises:
        InputError: the example's rig lacks what the simulation needs.
    """
    rig = recordings.example
    torque_constant(rig)
    truth = AxisParameters.from_rig(rig)
    traces = record_each(rig)
    found = {words: identify_friction(run_of(trace, rig)) for words, trace in traces.items()}
    numbers = [number for words, trace in traces.items() for number in _numbers(words, found[words], trace, rig, truth)]
    return DoneTask(KEY, TITLE, _findings(found, truth), tuple(numbers), example=True)


def _numbers(words: str, found: EquationOfMotion, trace: Trace, rig: Rig, truth: AxisParameters) -> list[Number]:
    """Phases carry no friction: that is what is true of their current."""
    default = identify(trace, rig)
    share = 0.0 if words == PHASES else 1.0
    viscous, coulomb = share * truth.viscous_friction_coefficient, share * truth.coulomb_friction
    return [
        Number(f"J, {words}", found.inertia * KG_CM2, "kg·cm²", truth.inertia * KG_CM2, EXAMPLE),
        Number(f"K_fric_w, {words}", found.viscous, "N·m·s/rad", viscous, EXAMPLE),
        Number(f"K_fric_0, {words}", found.coulomb, "N·m", coulomb, EXAMPLE),
        Number(
            f"K_fric_w, {words}, bench", default["viscous_friction_coefficient"].value, "N·m·s/rad", viscous, EXAMPLE
        ),
        Number(f"K_fric_0, {words}, bench", default["coulomb_friction_torque"].value, "N·m", coulomb, EXAMPLE),
    ]


def _findings(found: dict[str, EquationOfMotion], truth: AxisParameters) -> tuple[str, ...]:
    mechanics, setpoint, phases = found[MECHANICS], found[SETPOINT], found[PHASES]
    return (
        "Which current is recorded decides whether software friction is seen.",
        f"The set-point, before the drive subtracts the friction: K_fric_w is "
        f"{abs(setpoint.viscous / mechanics.viscous - 1.0):.2%} and K_fric_0 "
        f"{abs(setpoint.coulomb / mechanics.coulomb - 1.0):.2%} off what the same friction in the mechanics gives. "
        "Whoever reads this current and the speed cannot tell where friction sits.",
        f"The current of the phases, from which the course computes I_q: the motor makes only what is left, the axis "
        f"turns without friction, and least squares finds none: {phases.coulomb:.2g} N·m of "
        f"{truth.coulomb_friction:.2g}, {phases.viscous:.2g} N·m·s/rad of {truth.viscous_friction_coefficient:.2g}. "
        "Friction that is found in such a recording sits in the mechanics.",
    )
