"""Servos of `tests.studies.servos`: `bench servo` next to SciPy's least squares, CMA-ES and MuJoCo's sysid toolbox.

The other three fit the plain model, kp, kv, K_w, K_0, force limit and dead time per moment of inertia, to the whole
log: a position actuator in MuJoCo, free-running from the goal, with friction that holds. All start from the same rough
values and have the same CPU time; a method that is stopped keeps its best values and has no interval. Intervals of the
least squares are those of its slopes and of white noise as large as the residual, as the toolbox states them.

    python -m tests.studies.servo_methods --count 20 --seed 4 --out docs/servo

A method whose package is not installed (`cma`; `mujoco[sysid]`) is left out, with a line that says so.
"""

from __future__ import annotations

import argparse
import io
import math
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import redirect_stdout, suppress
from importlib import import_module
from itertools import product
from pathlib import Path
from typing import Any

import mujoco
import mujoco.rollout
import numpy as np
import scipy

from bench.arrays import NORMAL95
from bench.trace.trace import Trace
from tests.studies.frame import publish, running, table
from tests.studies.servos import Found, by_bench, judged, servo_of

#: Timestep of the simulation, and CPU time that a method may take - s.
STEP, CAP = 1e-3, 15.0
NAMES = "kp", "kv", "viscous", "friction", "limit", "dead_time"
#: What is compared.
COMPARED = "kp", "damping", "friction", "limit", "dead_time"
#: Where every search begins - 1/s**2, 1/s, 1/s, rad/s**2, rad/s**2, s -, and the factors of it that bound it.
BEGIN, REACH = (625.0, 20.0, 15.0, 6.0, 300.0, 0.01), (1.0 / 50.0, 50.0)
MJCF = f"""<mujoco><option timestep="{STEP}" integrator="implicitfast"><flag contact="disable"/></option><worldbody>
<body><joint name="j" axis="0 0 1" damping="{BEGIN[2]}" frictionloss="{BEGIN[3]}" solreffriction="{2.0 * STEP} 1"
solimpfriction=".9999 .9999 .001 .5 2"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></worldbody>
<actuator><position name="a" joint="j" kp="{BEGIN[0]}" kv="{BEGIN[1]}" forcerange="-{BEGIN[4]} {BEGIN[4]}"/></actuator>
<sensor><jointpos name="q" joint="j"/></sensor></mujoco>"""


class SpentError(Exception):
    """The CPU time of a method is over."""


class Motion:
    """A log, and the residual of the plain model along it; it keeps the best values so far.

    Attributes:
        times, measured, control: of the samples - s, rad - (n,), and the goal at every step of the simulation (m, 1).
        best: squared residual and values of NAMES.
    """

    def __init__(self, recording: Trace) -> None:
        self.times, self.measured = recording.time - recording.time[0], recording["position"]
        steps = round(float(self.times[-1]) / STEP) + 1
        held = np.minimum((np.arange(steps) * STEP / recording.sample_period + 1e-9).astype(int), len(recording) - 1)
        self.control = recording["position_reference"][held][:, None]
        self.best = (math.inf, np.array(BEGIN))
        self._end = time.process_time() + CAP
        self._model = mujoco.MjModel.from_xml_string(MJCF)
        self._data = mujoco.MjData(self._model)

    @property
    def state(self) -> np.ndarray:
        """Where a simulation begins."""
        start = np.zeros(mujoco.mj_stateSize(self._model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
        start[1] = self.measured[0]
        return start

    def residual(self, values: np.ndarray) -> np.ndarray:
        """Measured less simulated position - rad - (n,)."""
        kp, kv, viscous, friction, limit, _ = values
        self._model.actuator_gainprm[0, 0] = kp
        self._model.actuator_biasprm[0, 1:3] = -kp, -kv
        self._model.actuator_forcerange[0] = -limit, limit
        self._model.dof_damping[0], self._model.dof_frictionloss[0] = viscous, friction
        state, _ = mujoco.rollout.rollout(self._model, self._data, self.state, self.control)
        return self.noted(values, np.asarray(state)[0])

    def noted(self, values: np.ndarray, state: np.ndarray) -> np.ndarray:
        """The residual of simulated states (m, 3): time, position, speed; SpentError once time is over."""
        late = np.interp(self.times - values[-1], np.r_[0.0, state[:, 0]], np.r_[self.measured[0], state[:, 1]])
        error = np.nan_to_num(self.measured - late, nan=1e3, posinf=1e3, neginf=-1e3)
        self.best = min(self.best, (float(error @ error), np.array(values)), key=lambda one: one[0])
        if time.process_time() > self._end:
            raise SpentError
        return error


def _found(motion: Motion, covariance: np.ndarray | None) -> Found:
    """The best values with intervals of 95 %; without a covariance of NAMES the search was stopped."""
    best = dict(zip(NAMES, motion.best[1].tolist(), strict=True))
    parts = {
        key: [NAMES.index(name) for name in ("kv", "viscous")] if key == "damping" else [NAMES.index(key)]
        for key in COMPARED
    }
    quantities = {}
    for key, of in parts.items():
        value = float(motion.best[1][of].sum())
        variance = math.nan if covariance is None else float(covariance[np.ix_(of, of)].sum())
        half = NORMAL95 * math.sqrt(max(variance, 0.0)) if covariance is not None else math.nan
        quantities[key] = (value, value - half, value + half)
    values = {"stiffness": best["kp"], "drive_damping": best["kv"], "damping": best["viscous"]}
    return Found("", values | {name: best[name] for name in NAMES[3:]}, quantities)


def by_scipy(recording: Trace) -> Found:
    """`scipy.optimize.least_squares` over logarithms of the values."""
    motion = Motion(recording)
    reach = np.log(REACH)[:, None] * np.ones(len(NAMES))
    try:
        done = scipy.optimize.least_squares(
            lambda point: motion.residual(np.array(BEGIN) * np.exp(point)),
            np.zeros(len(NAMES)),
            bounds=(reach[0], reach[1]),
            x_scale="jac",
            diff_step=1e-3,
        )
    except SpentError:
        return _found(motion, None)
    free, count = len(NAMES), motion.times.size
    covariance = np.linalg.pinv(done.jac.T @ done.jac) * motion.best[0] / (count - free)
    return _found(motion, covariance * np.outer(motion.best[1], motion.best[1]))


def by_cma(recording: Trace) -> Found:
    """CMA-ES over logarithms of the values, with its default population; it has no intervals."""
    cma = import_module("cma")

    motion = Motion(recording)
    options = {"bounds": np.log(REACH).tolist(), "seed": 1, "verbose": -9}

    def misfit(point: np.ndarray) -> float:
        error = motion.residual(np.array(BEGIN) * np.exp(point))
        return math.log(float(error @ error))

    with suppress(SpentError):  # the best values so far are the answer
        cma.fmin2(misfit, np.zeros(len(NAMES)), 0.7, options)
    return _found(motion, None)


def by_sysid(recording: Trace) -> Found:
    """MuJoCo's sysid toolbox with its own optimiser and intervals; the dead time shifts the simulated signal."""
    sysid = import_module("mujoco.sysid")
    motion, params = Motion(recording), sysid.ParameterDict()

    def set_kp(spec: Any, one: Any) -> None:
        spec.actuator("a").gainprm[0], spec.actuator("a").biasprm[1] = one.value[0], -one.value[0]

    def set_kv(spec: Any, one: Any) -> None:
        spec.actuator("a").biasprm[2] = -one.value[0]

    def set_viscous(spec: Any, one: Any) -> None:
        spec.joint("j").damping[0] = one.value[0]

    def set_friction(spec: Any, one: Any) -> None:
        spec.joint("j").frictionloss = one.value[0]

    def set_limit(spec: Any, one: Any) -> None:
        spec.actuator("a").forcerange[:] = -one.value[0], one.value[0]

    setters: tuple[Callable[..., None] | None, ...] = set_kp, set_kv, set_viscous, set_friction, set_limit, None
    for name, begin, setter in zip(NAMES, BEGIN, setters, strict=True):
        params.add(sysid.Parameter(name, begin, begin * REACH[0], begin * REACH[1], modifier=setter))

    def modified(params: Any, predicted: Any, measured: Any, model: Any, every: bool, state: Any = None, **_: Any):
        return motion.noted(params.as_vector(), state)[:, None], measured, measured

    spec, rows = mujoco.MjSpec.from_string(MJCF), np.arange(len(motion.control)) * STEP
    control = sysid.TimeSeries(rows, motion.control)
    sensors = sysid.TimeSeries.from_names(motion.times, motion.measured[:, None], spec.compile())
    sequences = sysid.ModelSequences("servo", spec, "log", motion.state, control, sensors)
    residual = sysid.build_residual_fn(models_sequences=[sequences], modify_residual=modified, n_threads=1)
    try:
        with redirect_stdout(io.StringIO()):  # its optimiser prints every iteration
            best, done = sysid.optimize(params, residual, verbose=False, x_scale="jac")
        covariance, _ = sysid.calculate_intervals(residual(best.as_vector(), best)[0], done.jac)
    except SpentError:
        return _found(motion, None)
    return _found(motion, covariance)


METHODS: dict[str, Callable[[Trace], Found]] = {
    "bench servo": by_bench,
    "SciPy least squares": by_scipy,
    "CMA-ES": by_cma,
    "MuJoCo sysid": by_sysid,
}


def installed() -> dict[str, Callable[[Trace], Found]]:
    """Methods whose packages are there; a line for each that is not."""
    methods = dict(METHODS)
    for name, has, package in (
        ("CMA-ES", lambda: import_module("cma"), "cma"),
        ("MuJoCo sysid", lambda: import_module("mujoco.sysid").optimize, "mujoco[sysid]"),
    ):
        try:
            has()
        except (ImportError, AttributeError) as error:
            print(f"{name} is left out: {package} is not installed ({error})", file=sys.stderr)
            del methods[name]
    return methods


def one_servo(seed: int, number: int, name: str) -> tuple[bool, dict[str, object]]:
    """Whether a servo has play, and what a method finds of it."""
    rng = np.random.default_rng([seed, number])
    servo = servo_of(rng)
    return servo.gap > 0.0, judged(servo, rng, METHODS[name])


def row(name: str, results: Sequence[dict[str, Any]]) -> list[str]:
    """A method's line of the table: errors and coverage of what is finite, held-out error and CPU time."""
    line, covered = [name], []
    for key in COMPARED:
        found = [one[key] for one in results if key in one and math.isfinite(one[key][1])]
        scale = 1e3 if key == "dead_time" else 100.0
        errors = [scale * abs(error) / (1.0 if key == "dead_time" else truth) for error, truth, _ in found]
        line.append(f"{np.median(errors):.2g}" if errors else "")
        covered += [contained for _, _, contained in found if contained is not None]
    line.append(f"{sum(covered)} of {len(covered)}" if covered else "none")
    ratios = [one["held out"] for one in results if "held out" in one]
    line += [f"{np.median(ratios):.3g}", f"{max(ratios):.3g}"]
    return [*line, f"{np.median([one['seconds'] for one in results if 'seconds' in one]):.2g}"]


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="Methods on the same servos.")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=4)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--out", type=Path, help="folder for the table")
    options = parser.parse_args()
    methods = [*installed()]
    work = [(options.seed, k, name) for k, name in product(range(options.count), methods)]
    with running(options.jobs) as run:
        results = run.each("servo and method", one_servo, work)
    heads = ("method", "kp/J, %", "(kv + K_w)/J, %", "K_0/J, %", "limit/J, %", "dead time, ms", "truth in 95 %")
    heads += ("held-out error", "largest", "CPU, s")
    text = "Medians; held-out error over the true servo's.\n\n"
    for title, play in (("Without play", False), ("With play", True)):
        chosen = {
            name: [r for (_, _, of), (has, r) in zip(work, results, strict=True) if of == name and has is play]
            for name in methods
        }
        if any(chosen.values()):
            count = len(next(iter(chosen.values())))
            lines = [row(name, found) for name, found in chosen.items()]
            text += f"{title}, {count} servos:\n\n{table(heads, lines)}\n\n"
    print(text)
    publish(options.out, {"methods.md": text})


if __name__ == "__main__":
    main()
