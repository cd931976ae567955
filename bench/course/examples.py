"""Two sections on the embedded example, in addition to the tasks: emulated friction, and gear with load torque.

Each raises InputError where the example's rig lacks what the simulation needs.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.axis_kind import OFFSET
from bench.course.axis import KG_CM2, motor_value, simulated_with, torque_constant
from bench.course.friction import identify_friction
from bench.course.recordings import LabRecordings, run_of
from bench.course.result import Number, TaskResult
from bench.fit.identify import identify
from bench.plant.axis_model import AxisParameters
from bench.plant.sensing import Sensors
from bench.plant.simulate import simulate
from bench.rig.rig import Load, Rig
from bench.trace.trace import Trace

#: Where friction sits, and which current is recorded.
MECHANICS, SETPOINT, PHASES = "in the mechanics", "emulated", "emulated, phases"
#: Motor turns per turn of the load; inertia of the gear on the motor's side - kg*m**2; load torque, behind it - N*m.
RATIO, GEAR_INERTIA, LOAD_TORQUE = 3.0, 0.1e-4, 1.2
#: A disk so many times as heavy as the lab's turns behind the gear.
HEAVIER = 6.0


def record_each(rig: Rig) -> dict[str, Trace]:
    """One motion with friction in the mechanics, and emulated by the drive's software with either current recorded.

    The set-point is what the drive asks for before its software subtracts the friction; through the phases flows what
    is left of it.
    """
    mechanics = simulate(simulated_with(rig, friction="mechanics"), "fast_reversals").trace
    emulated = simulate(simulated_with(rig, friction="drive"), "fast_reversals")
    flowing = replace(emulated.states, torque=emulated.states.motor_torque)
    sensors = Sensors.from_rig(rig)
    phases = sensors.record(flowing, emulated.references, np.random.default_rng(0), f"{emulated.trace.origin}, phases")
    return {MECHANICS: mechanics, SETPOINT: emulated.trace, PHASES: phases}


def emulated_friction(recordings: LabRecordings) -> TaskResult:
    """Simulate friction in mechanics and software, identify each as the course does and by the default estimator."""
    rig = recordings.example
    torque_constant(rig)
    truth = AxisParameters.from_rig(rig)
    traces = record_each(rig)
    found = {words: identify_friction(run_of(trace, rig)) for words, trace in traces.items()}
    numbers = []
    for words, own in found.items():
        bench, share = identify(traces[words], rig), 0.0 if words == PHASES else 1.0  # phases carry no friction
        viscous, coulomb = share * truth.viscous_friction_coefficient, share * truth.coulomb_friction
        numbers += [
            Number(f"J, {words}", own.inertia * KG_CM2, "kg·cm²", truth.inertia * KG_CM2),
            Number(f"K_fric_w, {words}", own.viscous, "N·m·s/rad", viscous),
            Number(f"K_fric_0, {words}", own.coulomb, "N·m", coulomb),
            Number(f"K_fric_w, {words}, bench", bench["viscous_friction_coefficient"].value, "N·m·s/rad", viscous),
            Number(f"K_fric_0, {words}, bench", bench["coulomb_friction_torque"].value, "N·m", coulomb),
        ]
    mechanics, setpoint, phases = found[MECHANICS], found[SETPOINT], found[PHASES]
    findings = (
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
    return TaskResult(findings, tuple(numbers))


def geared(rig: Rig) -> Rig:
    """The lab's axis with a gear, a heavier disk and a load torque; identification fits a constant torque too."""
    load = rig.load or Load()
    mass = HEAVIER * (load.disk_mass or 0.0)
    load = load.model_copy(update={"gear_ratio": RATIO, "gear_inertia": GEAR_INERTIA, "mass": mass, "density": None})
    total = motor_value(rig, "rotor_inertia") + GEAR_INERTIA + load.reflected(load.disk_inertia or 0.0)
    rig = simulated_with(rig, moment_of_inertia=total, load_torque=LOAD_TORQUE, friction="mechanics")
    drive = rig.drive.model_copy(update={"inertia_feedforward": total}) if rig.drive else None
    return rig.model_copy(update={"load": load, "drive": drive, "offset": True})


def equation_of_motion(recordings: LabRecordings) -> TaskResult:
    """Simulate and identify M = J*alpha + K_w*omega + K_0*sgn(omega) + M_load/i, J = J_motor + J_load/i**2."""
    axis = geared(recordings.example)
    truth = AxisParameters.from_rig(axis)
    found = {name: parameter.value for name, parameter in identify(simulate(axis).trace, axis).parameters.items()}
    load, offset = (truth.inertia - truth.motor_inertia) * RATIO**2, axis.axis_kind.parameter(OFFSET)
    viscous, coulomb = found["viscous_friction_coefficient"], found["coulomb_friction_torque"]
    numbers = (
        Number("J", found["moment_of_inertia"] * KG_CM2, "kg·cm²", truth.inertia * KG_CM2),
        Number("J_load behind the gear", found["load_moment_of_inertia"] * KG_CM2, "kg·cm²", load * KG_CM2),
        Number("K_fric_w", viscous, "N·m·s/rad", truth.viscous_friction_coefficient),
        Number("K_fric_0", coulomb, "N·m", truth.coulomb_friction),
        Number("M_load behind the gear", found[offset] * RATIO, "N·m", LOAD_TORQUE),
    )
    findings = (
        f"With i = {RATIO:g} the motor feels J_load/i² and M_load/i. Simulated with {LOAD_TORQUE:g} N·m on the load "
        "and identified with a constant torque beside inertia and friction.",
    )
    return TaskResult(findings, numbers)
