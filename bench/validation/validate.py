"""Validation: draw cases, carry them out wherever there are workers, and see how often results hold.

A case is recorded by its plant, identified and, if wanted, diagnosed; results are listed with the truth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from bench.diagnosis.diagnosis import diagnose
from bench.effects.present import Present
from bench.errors import BenchError
from bench.fit.estimate import RefusedEstimateError
from bench.fit.identify import identify
from bench.jobs.each import each
from bench.jobs.process import Failure, Limits
from bench.plant.drive import References
from bench.plant.simulate import simulate
from bench.rig.rig import Rig, Simulation
from bench.trace.trace import Trace
from bench.validation.coverage import Coverage, Named, Naming, Run, base, coverage, naming, of_effects
from bench.validation.independent.sensors import NoiseStream, rounded
from bench.validation.independent.simulate import simulate as integrate
from bench.validation.plan import Case, Plan


def record(cases: Sequence[Case], seed: int) -> list[Trace | BenchError]:
    """One recording a case, or why MuJoCo makes none.

    Noise is drawn from the seed and a case's index: a recording does not depend on other cases.
    """
    beside = [case for case in cases if case.plant == "independent"]
    integrated = integrate(
        [case.axis for case in beside],
        [case.motion for case in beside],
        [case.effects for case in beside],
        [case.sensors for case in beside],
        seed,
        numbers=[case.index for case in beside],
    )
    made: dict[int, Trace | BenchError] = {k.index: run.trace for k, run in zip(beside, integrated, strict=True)}
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


#: Runs simulated side by side in one piece of work: more cost no less each.
TOGETHER = 64


def pieces(count: int) -> list[range]:
    """Indices of so many runs, cut for the work."""
    return [range(first, min(first + TOGETHER, count)) for first in range(0, count, TOGETHER)]


def carried_out(plan: Plan, indices: Sequence[int]) -> list[Run]:
    """Runs of a plan, by their indices; each is the same whatever else is simulated."""
    cases = [plan.case(index) for index in indices]
    return [judged(case, made, plan) for case, made in zip(cases, record(cases, plan.seed), strict=True)]


def judged(case: Case, made: Trace | BenchError, plan: Plan) -> Run:
    """Results on a recording, compared with its case."""
    run = drawn(case)
    if isinstance(made, BenchError):
        return replace(run, status="failed", reason=str(made))
    run = identified(run, case, made)
    return diagnosed(run, case, made) if plan.diagnose else run


def identified(run: Run, case: Case, trace: Trace) -> Run:
    """With the result of `identify`, or its refusal."""
    try:
        estimate, status, reason = identify(trace, case.rig), "done", ""
    except RefusedEstimateError as refused:
        estimate, status, reason = refused.estimate, "refused", str(refused)
    except BenchError as refused:
        return replace(run, status="refused", reason=str(refused))
    return replace(run, status=status, reason=reason, scored=tuple(base("identify", case, estimate.parameters)))


def diagnosed(run: Run, case: Case, trace: Trace) -> Run:
    """With the result of `diagnose`, or its refusal."""
    try:
        found = diagnose(trace, case.rig)
    except BenchError as refused:
        return replace(run, named=Named(missed=case.hidden, reason=str(refused)))
    scored = (*run.scored, *base("diagnose", case, found.parameters), *of_effects(case.effects, case.axis, found))
    return replace(run, scored=scored, named=Named.of(found.verdict, found.effects, case.hidden))


def drawn(case: Case) -> Run:
    """A run before its evaluation."""
    sensors = case.sensors
    return Run(
        index=case.index,
        plant=case.plant,
        motion=case.motion_name,
        kind=case.rig.kind,
        noise=f"{sensors.velocity.kind}/{sensors.current.kind}",
        sample_period=sensors.sample_period,
        duration=case.motion.duration,
        hidden=case.hidden,
        severity=case.severity,
    )


#: For one piece of work: ten times of what it takes where it is slowest, several effects in each run - s.
DEADLINE = 3600.0


@dataclass(frozen=True)
class Validation:
    """What a Monte Carlo comes to.

    Attributes:
        runs: by their index.
        coverage: of every quantity by groups of runs.
        naming: None where nothing was diagnosed.
    """

    runs: tuple[Run, ...]
    coverage: tuple[Coverage, ...]
    naming: Naming | None


def validate(
    plan: Plan,
    count: int,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[float], None] = lambda share: None,
) -> Validation:
    """Carry out the first runs of a plan; the same for any number of workers.

    Args:
        plan: that defines each run.
        count: of runs.
        workers: processes on this machine; None: one a core.
        scheduler: address of a Dask cluster that does the work instead.
        progress: called with the share done.

    Raises:
        InputError: no Dask scheduler answers at the address.
    """
    work = pieces(count)
    runs: dict[int, Run] = {}
    for place, outcome in each(partial(carried_out, plan), work, Limits(deadline=DEADLINE), workers, scheduler):
        if isinstance(outcome, Failure):
            lost = (drawn(plan.case(index)) for index in work[place])
            outcome = [replace(run, status="failed", reason=outcome.reason) for run in lost]
        runs |= {run.index: run for run in outcome}
        progress(len(runs) / count)
    ordered = tuple(runs[index] for index in range(count))
    return Validation(ordered, tuple(coverage(ordered)), naming(ordered))
