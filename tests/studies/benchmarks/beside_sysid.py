"""Beside `mujoco.sysid` on the same recordings: how long each takes, how far off it is, what its intervals cover.

Recordings are of the independent integrator, so that neither is judged by its own model. `mujoco.sysid` gets the
bench's MuJoCo model with its stiff dry friction, the recorded torque, the simulated speed at the recorded instants,
residuals in shares of the signal, parameters scaled by the Jacobian (`x_scale="jac"`), and a start that the rig file
lets expect. Its model takes steps of a sample, as is its habit, or of the drive's period, with which it errs less.
"""

from __future__ import annotations

import io
import logging
import statistics
import time
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import mujoco
import numpy as np
from mujoco import sysid
from mujoco.sysid import optimize  # noqa: F401  # an extra of MuJoCo, which hides that it is not there

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.effects.mjcf import AXIS, DRIVE, LOAD
from bench.fit.identify import identify
from bench.plant.axis_model import AxisParameters, build_spec, disk_inertia, half_step_inertia
from bench.rig.rig import Rig
from bench.validation.independent.references import random_motion
from bench.validation.independent.rig import Axis, random_rig, rig_text
from bench.validation.independent.sensors import Noise, Sensors
from bench.validation.independent.simulate import Recorded, simulate
from tests.studies.benchmarks.table import Table

PARAMETERS = ("J", "viscous", "Coulomb")
SAMPLE_PERIOD, CONTROL_PERIOD = 1e-3, 250e-6
#: Of the independent integrator - s.
LONGEST_STEP = 31.25e-6
#: Of the peak torque: dry friction from which the optimiser starts, and viscous friction as much at top speed. Axes are
#: drawn with 0.8 to 3 % of dry friction and 0.3 to 2 times as much of viscous. Bounds are a tenth and ten times.
FRICTION = 0.01


@dataclass(frozen=True)
class Answer:
    """What one way says of one recording.

    Attributes:
        seconds: that it took.
        values, low, high: J, viscous and Coulomb friction with their intervals of 95 %, over the true ones (3,).
    """

    seconds: float
    values: Array
    low: Array
    high: Array


def recordings(count: int, duration: float) -> list[Recorded]:
    """One of each seed, at 1 kHz with noise as drives have it."""
    rngs = [np.random.default_rng([11, seed]) for seed in range(count)]
    axes = [replace(random_rig(rng, f"axis {k}"), control_period=CONTROL_PERIOD) for k, rng in enumerate(rngs)]
    motions = [random_motion(axis, rng, duration) for axis, rng in zip(axes, rngs, strict=True)]
    sensors = [
        Sensors(SAMPLE_PERIOD, velocity=Noise(1.5e-4 * axis.top_speed), current=Noise(2e-3 * axis.peak_current))
        for axis in axes
    ]
    return simulate(axes, motions, [()] * count, sensors, longest_step=LONGEST_STEP)


def by_bench(recorded: Recorded) -> Answer:
    """`identify` with all its checks."""
    rig, true = Rig.of(tomllib.loads(rig_text(recorded.axis)), recorded.axis.name), truth(recorded.axis)
    began = time.perf_counter()
    estimate = identify(recorded.trace, rig)
    seconds = time.perf_counter() - began
    found = [estimate.parameters[rig.axis_kind.parameter(term)] for term in (INERTIA, VISCOUS, COULOMB)]
    low, high = np.array([one.ci95 for one in found]).T
    return Answer(seconds, np.array([one.value for one in found]) / true, low / true, high / true)


def by_sysid(recorded: Recorded, step: float) -> Answer:
    """`mujoco.sysid` with steps of so many seconds; its own intervals."""
    axis, trace = recorded.axis, recorded.trace
    friction = FRICTION * axis.peak_torque
    start = AxisParameters(axis.inertia_feedforward, friction / axis.top_speed, friction)
    spec = build_spec(start, step)
    model = spec.compile()
    control = np.zeros((len(trace), model.nu))
    control[:, model.actuator_ctrladr[model.actuator(DRIVE).id]] = axis.torque_constant * trace["current"]
    speed = {f"{AXIS}_qvel": (sysid.SignalType.MjStateQVel, np.array([0]))}
    sequences = sysid.ModelSequences(
        "axis",
        spec,
        "run",
        sysid.create_initial_state(model, trace["position"][:1], trace["velocity"][:1]),
        sysid.TimeSeries(trace.time, control),
        sysid.TimeSeries(trace.time, trace["velocity"][:, None], speed),
        allow_missing_sensors=True,
    )
    residual = sysid.build_residual_fn(models_sequences=[sequences], build_model=built)
    began = time.perf_counter()
    # it prints each of its iterations, to where it is directed
    found, result = sysid.optimize(parameters(start), residual, verbose=False, x_scale="jac", output=io.StringIO())
    seconds = time.perf_counter() - began
    values, true = found.as_vector(), truth(axis)
    reach = sysid.calculate_intervals(residual(values, found)[0], result.jac)[1]
    return Answer(seconds, values / true, (values - reach) / true, (values + reach) / true)


def truth(axis: Axis) -> Array:
    """J, viscous and Coulomb friction (3,)."""
    return np.array([axis.inertia, axis.viscous, axis.coulomb])


def parameters(start: AxisParameters) -> sysid.ParameterDict:
    """What `mujoco.sysid` looks for, from where and how far."""
    values = start.inertia, start.viscous_friction_coefficient, start.coulomb_friction
    found = sysid.ParameterDict()
    for name, value in zip(PARAMETERS, values, strict=True):
        found.add(sysid.Parameter(name, value, value / 10.0, value * 10.0))
    return found


def built(values: sysid.ParameterDict, spec: mujoco.MjSpec) -> mujoco.MjModel:
    """The model with other parameters."""
    inertia, viscous, coulomb = values.as_vector().tolist()
    joint = spec.joint(AXIS)
    spec.body(LOAD).inertia = disk_inertia(inertia)
    joint.damping = [viscous, 0.0, 0.0]
    joint.armature = half_step_inertia(inertia, viscous, spec.option.timestep)
    joint.frictionloss = coulomb
    return spec.compile()


def measured(count: int = 20, duration: float = 3.0, steps: Sequence[float] = (1e-3, 250e-6)) -> list[Table]:
    """All recordings by every way, recording by recording in turn.

    Args:
        count: of recordings, a seed and an axis each.
        duration: about, of each - s.
        steps: of the model of `mujoco.sysid` - s.
    """
    logging.getLogger("absl").setLevel(logging.ERROR)  # it warns that speed is taken from the state, not from a sensor
    runs = recordings(count, duration)
    by_bench(runs[0])  # so that what is imported late is there
    answers: dict[str, list[Answer]] = {OURS: [], **{theirs(step): [] for step in steps}}
    for run in runs:
        answers[OURS].append(thrice_by_bench(run))
        for step in steps:
            answers[theirs(step)].append(by_sysid(run, step))
    return [compared(answers, duration)]


OURS = "`bench.identify`"


def theirs(step: float) -> str:
    """Name of a way."""
    return f"`mujoco.sysid`, steps of {step * 1e3:g} ms"


def thrice_by_bench(run: Recorded) -> Answer:
    """The answer of `identify`, always the same, with the median time of three."""
    thrice = [by_bench(run) for _ in range(3)]
    return replace(thrice[0], seconds=statistics.median(one.seconds for one in thrice))


def compared(answers: Mapping[str, Sequence[Answer]], duration: float) -> Table:
    """Time, error and coverage of each way, and what they are to those of `identify`."""
    ours = answers[OURS]
    ours_off = errors(ours)
    rows = []
    for name, theirs in answers.items():
        times = [one.seconds / other.seconds for one, other in zip(theirs, ours, strict=True)]
        off = errors(theirs)
        inside = np.sum([(one.low <= 1.0) & (one.high >= 1.0) for one in theirs], axis=0)
        rows.append(
            (
                name,
                f"{statistics.median(one.seconds for one in theirs):.3g} s",
                f"{statistics.median(times):.3g} ({min(times):.3g} to {max(times):.3g})",
                *(f"{100.0 * error:.2g} % ({error / best:.2g})" for error, best in zip(off, ours_off, strict=True)),
                ", ".join(f"{count}" for count in inside) + f" of {len(theirs)}",
            )
        )
    says = (
        f"{len(ours)} recordings of about {duration:g} s at 1 kHz, each of another axis, moved by the independent "
        "integrator. Both start from the rig file: `mujoco.sysid` at the drive's inertia feed-forward and friction of "
        '1 % of the peak torque, with `x_scale="jac"`, its steps as long as a sample or as the period of the drive. '
        "Errors are RMS over the recordings, in brackets how many times that of `identify`; covered are true values of "
        "J, viscous and Coulomb friction that lie within the interval of 95 %."
    )
    heads = ("", "time, median", "times `identify`'s, median (range)", *(f"error of {name}" for name in PARAMETERS))
    return Table(says, (*heads, "covered"), tuple(rows))


def errors(answers: Sequence[Answer]) -> Array:
    """Relative RMS errors of J, viscous and Coulomb friction (3,)."""
    return np.sqrt(np.mean([(one.values - 1.0) ** 2 for one in answers], axis=0))
