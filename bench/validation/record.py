"""Recordings of cases, by the plant that each asks for: side by side, or one after the other in MuJoCo."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.effects.present import Present
from bench.errors import BenchError
from bench.plant.references import References
from bench.plant.simulate import simulate
from bench.rig.rig import Rig
from bench.rig.simulation import Simulation
from bench.trace.trace import Trace
from bench.validation.case import Case
from bench.validation.independent.sensors import NoiseStream, rounded
from bench.validation.independent.simulate import simulate as integrate

#: Of the independent integrator, as the blind set has it - s.
LONGEST_STEP = 31.25e-6


def record(cases: Sequence[Case], seed: int) -> list[Trace | BenchError]:
    """One recording a case, or why MuJoCo makes none; it depends on case and seed, and not on the cases beside it.

    Args:
        cases: each with its index, from which its noise is drawn.
        seed: of the noise.
    """
    beside = [case for case in cases if case.plant == "independent"]
    integrated = integrate(
        [case.axis for case in beside],
        [case.motion for case in beside],
        [case.effects for case in beside],
        [case.sensors for case in beside],
        seed,
        numbers=[case.index for case in beside],
        longest_step=LONGEST_STEP,
    )
    made: dict[int, Trace | BenchError] = {}
    made |= {case.index: run.trace for case, run in zip(beside, integrated, strict=True)}
    for case in cases:
        if case.plant == "mujoco":
            try:
                made[case.index] = simulated(case, seed)
            except BenchError as error:  # it diverged, or the axis cannot have the effect
                made[case.index] = error
    return [made[case.index] for case in cases]


def simulated(case: Case, seed: int) -> Trace:
    """A recording of MuJoCo's motion, with the same noise on it as the independent axis would have."""
    axis, sensors = case.axis, case.sensors
    ticks = int(case.motion.duration / axis.control_period + 1e-9) + 1
    time = axis.control_period * np.arange(ticks, dtype=float)
    present = [Present.of(effect.name, effect.quantities(axis)) for effect in case.effects]
    made = simulate(
        with_truth(case), case.motion_name, references=References(time, *case.motion.at(time)), effects=present
    )
    trace = made.trace
    signals = dict(trace.signals)
    for place, (name, noise) in enumerate((("velocity", sensors.velocity), ("current", sensors.current))):
        stream = NoiseStream(noise, sensors.sample_period, np.random.default_rng([seed, case.index, place]))
        signals[name] = rounded(signals[name] + stream.at(trace.time), noise.resolution)
    if not sensors.position_recorded:
        del signals["position"], signals["position_reference"]
    units = {name: trace.units[name] for name in signals}
    return Trace(trace.time, signals, units, f"MuJoCo {axis.name}")


def with_truth(case: Case) -> Rig:
    """The rig with what the simulation has to know, without noise."""
    axis, sensors = case.axis, case.sensors
    truth = {
        case.rig.axis_kind.inertia: axis.inertia,
        "viscous_friction_coefficient": axis.viscous,
        "coulomb_friction": axis.coulomb,
        "encoder_resolution": sensors.encoder_resolution,
        "sample_period": sensors.sample_period,
    }
    stated = case.rig.simulation or Simulation()
    own = stated.model_copy(update=truth | {"velocity_noise": 0.0, "current_noise": 0.0})
    return case.rig.model_copy(update={"simulation": own})
