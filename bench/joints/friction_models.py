"""Friction of a servo by six models that include each other, compared by torque on motion that was not fitted.

    M = J*alpha + dp/dt + K_w*omega + M_load + sgn(omega)*(F + S*exp(-|omega/omega_s|**alpha_s))
    F = K_0 + G(K_m, K_e),   S = M_s + G(L_m, L_e) + Q,   G(m, e) = |m*M + e*M_load|

M - torque of the motor; M_load - load of the links that is not due to acceleration, p - their momentum in addition to
J*omega (`bench.trace.trace.with_known`), both known - N*m (N), N*m*s (N*s). M1 has K_0; M2 M_s, too; M3 K_0 and
K_m = K_e; M4 M_s, K_m = K_e and L_m = L_e; M5 all four; M6, where M and M_load are of one sign,

    Q = E*M_load**2 where |M_load| < |M|, else N*M**2

As friction depends on the motor torque that it opposes, M is solved for: what is measured predicts no part of itself.
Errors are of logs, or of parts of one, that the fit did not use. The model is the simplest whose squared error exceeds
the least by no more than one standard error of the difference between logs (L. Breiman, J. Friedman, R. Olshen,
C. Stone, Classification and Regression Trees, 1984, 3.4.3).
Source: M. Duclusaud, G. Passault, V. Padois, O. Ly, Extended friction models for the physics simulation of servo
actuators, 2024, arXiv 2410.08650; the names of quantities are those of its program BAM.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.effects.effect import LOSSIEST
from bench.effects.signals import Signals
from bench.errors import UndeterminedError
from bench.fit.hypothesis import lay_out, plain
from bench.fit.rows import Rows, effort_of
from bench.rig.rig import Rig
from bench.trace.filter import Column
from bench.trace.trace import Trace

#: Quantities that each model has in addition to those of M1.
LOADED, RISES = ("load_friction_base",), ("friction_stribeck", "dtheta_stribeck", "alpha")
DIRECTED = ("load_friction_motor", "load_friction_external")
DIRECTED_RISES = tuple(f"{name}_stribeck" for name in DIRECTED)
BASE = ("armature", "friction_viscous", "friction_base")
MODELS: dict[str, tuple[str, ...]] = {
    "M1": BASE,
    "M2": (*BASE, *RISES),
    "M3": (*BASE, *LOADED),
    "M4": (*BASE, *RISES, *LOADED, "load_friction_stribeck"),
    "M5": (*BASE, *RISES, *DIRECTED, *DIRECTED_RISES),
    "M6": (*BASE, *RISES, *DIRECTED, *DIRECTED_RISES, *(f"{name}_quad" for name in DIRECTED)),
}
#: Models whose fits others start from: the last of these that is included.
STARTS = {"M2": ("M1",), "M3": ("M1",), "M4": ("M2", "M3"), "M5": ("M4",), "M6": ("M5",)}
#: Fits, each of which predicts the rest; rows of all logs that are taken at most, evenly.
FITS, ROWS = 4, 6000
#: Rounds in which the motor torque is solved for: each reduces the error by the share that friction takes of it.
ROUNDS = 20
#: Evaluations of a search at most: quantities that the motion does not determine would wander on.
MOST = 60
#: Highest curvature of the rise, and its lowest speed as share of the highest, which rows just resolve.
CURVED, SLOWEST = 10.0, 1e-3


@dataclass(frozen=True)
class FrictionModel:
    """A friction model fitted to all rows.

    Attributes:
        name: M1 to M6.
        error: RMS error of the torque where it was not fitted - N*m (N).
        parameters: by the names that BAM gives them, armature without the links - SI.
        chosen: whether it is the simplest that predicts as well as the best.
    """

    name: str
    error: float
    parameters: Mapping[str, float]
    chosen: bool


@dataclass(frozen=True)
class LoadedMotion:
    """Filtered acceleration, speed, direction, load, rate of known momentum, measured torque, and of which log, or
    part of one, each row is (m,).
    """

    acceleration: Array
    speed: Array
    sign: Array
    load: Array
    momentum_rate: Array
    torque: Array
    log: NDArray[np.intp]

    def of(self, kept: NDArray[np.bool_]) -> LoadedMotion:
        """Some of the rows."""
        return LoadedMotion(*(values[kept] for values in vars(self).values()))


def friction_models(traces: Sequence[Trace], rig: Rig) -> tuple[FrictionModel, ...]:
    """The six models of a joint by its logs; UndeterminedError where no known load moves, on which four depend."""
    motion = _motion([Rows.of(trace, rig) for trace in traces])
    if not rms(motion.load) > SLOWEST * rms(motion.torque):
        reason = "no known weight of links or payload moves, on which friction could depend"
        raise UndeterminedError("friction models", reason, "a motion that lifts links or a payload of known mass")
    whole, logs = _fitted(motion), int(motion.log.max()) + 1
    squares = np.zeros((len(MODELS), logs))
    for fold in range(FITS):
        fitted = _fitted(motion.of(motion.log % FITS != fold))
        for log in range(fold, logs, FITS):
            held = motion.of(motion.log == log)
            for k, (name, values) in enumerate(fitted.items()):
                torque = predicted(held, dict(zip(MODELS[name], values.tolist(), strict=True)))
                squares[k, log] = float(np.mean((torque - held.torque) ** 2))
    means = squares.mean(axis=1)
    beyond = squares - squares[int(np.argmin(means))]
    near = beyond.mean(axis=1) <= beyond.std(axis=1, ddof=1) / np.sqrt(logs)
    links = rig.load.link_inertia if rig.load is not None and rig.load.link_inertia else 0.0
    found = []
    for k, (name, values) in enumerate(whole.items()):
        parameters = dict(zip(MODELS[name], values.tolist(), strict=True))
        parameters["armature"] -= links
        found.append(FrictionModel(name, float(np.sqrt(means[k])), parameters, k == int(np.argmax(near))))
    return tuple(found)


def _motion(rows: Sequence[Rows]) -> LoadedMotion:
    """Of several logs; fewer than there are fits are cut into as many parts each."""
    tables, parts = [], 1 if len(rows) >= FITS else FITS
    for k, one in enumerate(rows):
        columns = lay_out(one, plain(one)).columns[:, :3]
        log = k * parts + np.arange(len(columns)) * parts // len(columns)
        tables.append(np.column_stack([columns, one.kept(_known_parts), one.kept(effort_of), log]))
    table = np.concatenate(tables)
    *values, log = table[:: -(-len(table) // ROWS)].T
    return LoadedMotion(*values, log=np.unique(log, return_inverse=True)[1])


def _known_parts(signals: Signals) -> list[Column]:
    """Known load, and the rate of known momentum."""
    return [[term] for term in signals.known]


def predicted(motion: LoadedMotion, values: Mapping[str, float]) -> Array:
    """Torque of the motor (m,) by a model with some of the quantities - N*m (N)."""
    load, speed = motion.load, np.abs(motion.speed)
    free = values["armature"] * motion.acceleration + values["friction_viscous"] * motion.speed
    free = free + motion.momentum_rate + load
    rises = np.exp(-((speed / values["dtheta_stribeck"]) ** values["alpha"])) if "alpha" in values else 0.0 * speed
    both, rising = values.get("load_friction_base", 0.0), values.get("load_friction_stribeck", 0.0)
    motor, external = (values.get(name, both) for name in DIRECTED)
    motor_rise, external_rise = (values.get(name, rising) for name in DIRECTED_RISES)
    motor_quad, external_quad = (values.get(f"{name}_quad", 0.0) for name in DIRECTED)
    torque = free + motion.sign * values["friction_base"]
    for _ in range(ROUNDS):
        of_quad = np.where(np.abs(load) < np.abs(torque), external_quad * load**2, motor_quad * torque**2)
        rise = values.get("friction_stribeck", 0.0) + np.abs(motor_rise * torque + external_rise * load)
        level = values["friction_base"] + np.abs(motor * torque + external * load)
        torque = free + motion.sign * (level + rises * (rise + of_quad * (load * torque > 0.0)))
    return torque


def _fitted(motion: LoadedMotion) -> dict[str, Array]:
    """Values of each model (p,) by bounded least squares, each started from those that it includes."""
    from scipy.optimize import least_squares  # 0.2 s, which only a comparison has to pay

    found: dict[str, Array] = {}
    scale = rms(motion.torque) or 1.0
    for name, names in MODELS.items():
        low, high = np.transpose([_bounds(each, motion) for each in names])

        def residual(values: Array, names: Sequence[str] = names) -> Array:
            left = predicted(motion, dict(zip(names, values.tolist(), strict=True))) - motion.torque
            return np.nan_to_num(left, nan=1e3 * scale, posinf=1e3 * scale, neginf=-1e3 * scale)

        tried = [
            least_squares(residual, np.clip(start, low, high), bounds=(low, high), x_scale="jac", max_nfev=MOST)
            for start in _starts(name, found, motion)
        ]
        found[name] = min(tried, key=lambda one: one.cost).x
    return found


def _bounds(name: str, motion: LoadedMotion) -> tuple[float, float]:
    """Of a quantity: what the load or the motor takes is less than itself."""
    top = float(np.abs(motion.speed).max())
    if name == "dtheta_stribeck":
        return SLOWEST * top, top
    if name == "alpha":
        return 1.0, CURVED
    return (0.0, LOSSIEST if name.startswith("load_friction") and not name.endswith("_quad") else np.inf)


def _starts(name: str, found: Mapping[str, Array], motion: LoadedMotion) -> Iterator[Array]:
    """Where the search of a model starts: without what it has more than one that it includes."""
    top = float(np.abs(motion.speed).max())
    if name == "M1":
        columns = np.column_stack([motion.acceleration, motion.speed, motion.sign])
        own = motion.torque - motion.load - motion.momentum_rate
        yield np.linalg.lstsq(columns, own, rcond=None)[0].astype(np.float64)
    for before in STARTS.get(name, ()):
        known = dict(zip(MODELS[before], found[before].tolist(), strict=True))
        known |= dict.fromkeys(DIRECTED, known.get("load_friction_base", 0.01)) if name == "M5" else {}
        known |= dict.fromkeys(DIRECTED_RISES, known.get("load_friction_stribeck", 0.01)) if name == "M5" else {}
        for share in (0.03, 0.2) if before in ("M1", "M3") and "alpha" in MODELS[name] else (0.1,):
            usual = {"dtheta_stribeck": share * top, "alpha": 2.0, "friction_stribeck": 0.1 * known["friction_base"]}
            yield np.array([known.get(each, usual.get(each, 0.01)) for each in MODELS[name]])
