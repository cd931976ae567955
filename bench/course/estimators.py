"""The course's estimators beside the bench's: the same motions, recorded again and again with fresh sensor noise."""

from __future__ import annotations

import numpy as np

from bench.arrays import Array, column_rms
from bench.course.axis import without_friction
from bench.course.recordings import LabRecordings, run_of
from bench.course.result import EXAMPLE, DoneTask, Number
from bench.course.t09_least_squares import identify_friction
from bench.fit.identify import identify
from bench.fit.lab import identify_as_in_the_lab, mean_inertia
from bench.plant.axis_model import AxisParameters
from bench.plant.sensing import Sensors
from bench.plant.simulate import simulate
from bench.rig.rig import Rig
from bench.trace.trace import Trace

KEY, TITLE = "estimators", "The course's estimators and the bench's"

#: Recordings of each motion.
REPETITIONS = 20
NAMES = ("moment_of_inertia", "viscous_friction_coefficient", "coulomb_friction_torque")


def task(recordings: LabRecordings) -> DoneTask:
    """RMS error of each way over recordings of the example.

    Raises:
        InputError: its rig lacks what the simulation needs.
    """
    rig = recordings.example
    truth = AxisParameters.from_rig(rig)
    known = np.array([truth.inertia, truth.viscous_friction_coefficient, truth.coulomb_friction])
    bare = [run_of(trace, rig) for trace in _recordings(without_friction(rig))]
    mean = np.array([[mean_inertia(run.acceleration, run.torque)[0]] for run in bare])
    rows: dict[str, list[list[float]]] = {"least squares, in step": [], "least squares, out of step": [], "bench": []}
    for trace in _recordings(rig):
        found = identify_friction(run_of(trace, rig))
        rows["least squares, in step"].append([found.inertia, found.viscous, found.coulomb])
        for words, estimate in (
            ("least squares, out of step", identify_as_in_the_lab(trace, rig)),
            ("bench", identify(trace, rig)),
        ):
            rows[words].append([estimate[name].value for name in NAMES])
    numbers = [Number("J, mean of M/α", _rms(mean, known[:1])[0], "%", source=EXAMPLE)]
    errors = {words: _rms(np.array(values), known) for words, values in rows.items()}
    for words, error in errors.items():
        numbers += [
            Number(f"{q}, {words}", e, "%", source=EXAMPLE)
            for q, e in zip(("J", "K_fric_w", "K_fric_0"), error, strict=True)
        ]
    late, step, bench = (errors[words] for words in ("least squares, out of step", "least squares, in step", "bench"))
    findings = (
        f"RMS error over {REPETITIONS} recordings of the fast run. The backward difference is half a sample late: "
        f"taken as it is, J·α of that half sample goes into friction ({late[1]:.0f} % and {late[2]:.0f} %). In step "
        f"(t_sync) {step[1]:.2g} % and {step[2]:.2g} % remain.",
        f"The bench's own is better still, J within {bench[0]:.2g} % against {step[0]:.2g} %, as one filter serves "
        "torque, speed, acceleration and sign alike: smoothing α alone shortens its peaks against the torque's, and "
        "its noise draws J towards zero (or, in the mean of M/α, away from it, as 1/α is convex).",
    )
    return DoneTask(KEY, TITLE, findings, tuple(numbers), example=True)


def _recordings(rig: Rig) -> list[Trace]:
    """One motion as the sensors record it, with noise of its own each time."""
    simulated, sensors = simulate(rig, "fast_reversals"), Sensors.from_rig(rig)
    return [
        sensors.record(simulated.states, simulated.references, np.random.default_rng(seed), f"recording {seed}")
        for seed in range(1, REPETITIONS + 1)
    ]


def _rms(found: Array, known: Array) -> list[float]:
    """RMS error of estimates (n, p) - percent of the truth (p,)."""
    return (100.0 * column_rms(found / known - 1.0)).tolist()
