"""Fit of a servo to goal and position: starting values from a grid, then least squares on the free-running simulation.

The simulation is driven by the goal alone, so noise and counts of the measured position are in the output only and bias
nothing. The recording is cut into stretches that are simulated together; the first part of each, in which the loop
forgets where it started, is not compared. What each stretch would change if it were left out (the delete-one jackknife,
linearised) gives the covariance: residuals may be correlated in any way within a stretch.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
import scipy
from numpy.typing import NDArray

from bench.arrays import Array, rms
from bench.errors import UndeterminedError
from bench.parameter import Parameter
from bench.servos.model import NULL, STEP, Stretches, simulated

#: Time in which a loop forgets its start; a stretch compared is not longer than `LONGEST` - s. With about `STRETCHES`
#: of them the jackknife has enough to average.
FORGETS, SHORTEST, LONGEST, STRETCHES = 0.5, 0.25, 1.0, 24
#: Least number of them, below which there is no interval.
FEWEST = 6
#: Factor on the standard errors of the jackknife, which is linearised, of a model whose controller has neither counts
#: nor a period: without it intervals of 95 % cover 85 % (`python -m tests.studies.servos`, seeds 5 and 6).
WIDER = 1.7
#: Longest dead time that is tried - s.
LONGEST_DEAD_TIME = 0.25
#: What every servo has; `known torque per inertia` joins it where a torque is known.
BASE = ("stiffness", "damping", "friction", "dead_time", "offset")
#: What a servo may have in addition: names, and starting values of the first as shares of `_scales`.
ADDITIONS: dict[str, tuple[tuple[str, ...], tuple[float, ...]]] = {
    "limit": (("limit", "drive_damping"), (0.15, 0.25, 0.4, 0.6, 0.8, 0.95)),
    "gravity": (("sine", "cosine"), (-0.3, -0.1, 0.1, 0.3)),
    "play": (("play",), (0.004, 0.01, 0.02, 0.05)),
    "dead_band": (("dead_band",), (0.002, 0.005, 0.01, 0.03)),
    "feedforward": (("feedforward",), (0.3, 0.7, 1.0)),
    "speed_limit": (("speed_limit",), (0.2, 0.4, 0.6, 0.8)),
}
#: Those that may be negative.
SIGNED = frozenset({"offset", "sine", "cosine", "mobility"})
#: Relative step of a derivative: above the kinks that stops and limits leave in the simulated motion.
DIFFERENCE = 1e-3
#: A log-likelihood gain has to exceed this much per value, in addition to BIC's half ln(n).
MARGIN = 6.0
#: Squared error without an addition over that with it, which it has to reach: a controller's own period and its counts
#: change the motion by as much as that, and are none of the additions.
MATERIAL = 1.1
#: Fitted as logarithms: they have no scale of their own, and are never zero.
LOGARITHMIC = ("stiffness", "damping", "limit", "speed_limit")
#: Longest step of a fit, in its scaled coordinates; relative gain below which it has converged.
LONGEST_STEP, CONVERGED = 2.0, 1e-5
#: Static errors by a known torque that are tried, as shares of the range of the goal.
PULLS = (0.01, 0.1, 0.5)
#: By which the damping of a step is multiplied in trials.
FACTORS = (0.05, 1.0, 20.0)
#: Starts that are fitted from the grid, without and with a limit.
BEGUN = 6
#: Additions that are fitted in each round: those that promise most.
TRIED = 2


@dataclass(frozen=True)
class ServoLog:
    """A recording of a servo on one time base.

    Attributes:
        stretches: those that are simulated.
        position: measured - rad (m) - (n,).
        skipped: samples at the beginning of each stretch that are not compared.
    """

    stretches: Stretches
    position: Array
    skipped: int

    @cached_property
    def compared(self) -> Array:
        """Measured position of the stretches (w, samples)."""
        return self.position[self.stretches.samples()[:, self.skipped :]]

    def only(self, chosen: NDArray[np.int64]) -> ServoLog:
        """The same of some of its stretches."""
        of = self.stretches
        return ServoLog(
            replace(of, starts=of.starts[chosen], position=of.position[chosen], speed=of.speed[chosen]),
            self.position,
            self.skipped,
        )


def recorded(
    period: float, goal: Array, position: Array, known: tuple[Array, Array], parts: Sequence[slice]
) -> ServoLog:
    """Stretches of a recording without holes in them; UndeterminedError where there are too few.

    Args:
        period: of the samples - s.
        goal, position: rad (m) - (n,).
        known: torque known to act against the motion - N*m (N) - and its slope over position - N*m/rad (N/m) - (n,).
        parts: stretches without a hole.
    """
    total = sum(part.stop - part.start for part in parts) * period
    compared = max(2, round(float(np.clip(total / STRETCHES, SHORTEST, LONGEST)) / period))
    skipped = max(1, round(FORGETS / period))
    starts = [at for part in parts for at in range(part.start, part.stop - skipped - compared + 1, compared)]
    if len(starts) < FEWEST:
        raise UndeterminedError("gains of the servo", f"the log has {total:.3g} s of motion", "10 s or more of motion")
    first = np.array(starts)
    reach = max(1, round(0.01 / period))
    before, after = np.maximum(first - reach, 0), np.minimum(first + reach, position.size - 1)
    speed = (position[after] - position[before]) / ((after - before) * period)
    steps = int(np.ceil(period / STEP))
    stretches = Stretches(
        period, first, skipped + compared, goal, *around(known, position), position[first], speed, steps
    )
    return ServoLog(stretches, position, skipped)


def around(known: tuple[Array, Array], position: Array) -> tuple[Array, Array]:
    """A known torque where the position is zero, by its slope, and that slope."""
    torque, slope = known
    return torque - slope * position, slope


@dataclass(frozen=True)
class ServoFit:
    """A servo that was fitted.

    Attributes:
        values: of all parameters of `bench.servos.model.NULL`.
        names: of those that were fitted.
        residual: measured less simulated position - rad (m) - (w, samples).
        replicates: fitted values without each of the stretches (w, names).
        demand: largest torque that the controller requests, in units of the limit, or per J where there is none.
    """

    values: Mapping[str, float]
    names: tuple[str, ...]
    residual: Array
    replicates: Array
    demand: float

    @cached_property
    def error(self) -> float:
        """RMS of the residual - rad (m)."""
        return rms(self.residual)

    def parameter(self, of: Callable[[Mapping[str, float]], float], unit: str) -> Parameter:
        """A quantity that follows from the values, with its interval of 95 %."""
        value = of(self.values)
        others = np.array([of({**self.values, **dict(zip(self.names, one, strict=True))}) for one in self.replicates])
        count = others.size
        error = float(np.sqrt((count - 1) / count * np.sum((others - others.mean()) ** 2)))
        error *= WIDER
        reach = float(scipy.special.stdtrit(count - 1, 0.975)) * error
        return Parameter(float(value), unit, error, (float(value) - reach, float(value) + reach))


def fitted(
    recorded: ServoLog, given: Mapping[str, float], progress: Callable[[float], None] = lambda share: None
) -> ServoFit:
    """The servo that explains a recording: base parameters, and whichever additions it cannot do without.

    Args:
        given: values that are known, which are not fitted.
        progress: called with the share done.
    """
    names = tuple(name for name in (*BASE, "mobility") if name not in given)
    names = names if recorded.stretches.known.any() else tuple(name for name in names if name != "mobility")
    best = _from_grid(recorded, names, given)
    recorded = replace(recorded, stretches=recorded.stretches.resolving(best.values["stiffness"]))
    (best,) = descended(recorded, [(best.names, best.values)])
    for round_ in range(len(ADDITIONS)):
        progress((round_ + 1.0) / (round_ + 2.0))
        starts = [((*best.names, *ADDITIONS[key][0]), start) for key, start in _starts(recorded, best)[:TRIED]]
        chosen = max(descended(recorded, starts), key=lambda trial: gain(best, trial), default=best)
        if gain(best, chosen) <= 0.0:
            break
        best = chosen
    for added, _ in ADDITIONS.values():
        if added[0] in best.names:
            fewer = tuple(name for name in best.names if name not in added)
            (trial,) = descended(recorded, [(fewer, {**best.values, **{name: NULL[name] for name in added}})])
            best = trial if gain(trial, best) <= 0.0 else best
    return _with_replicates(recorded, best)


def gain(fewer: ServoFit, more: ServoFit) -> float:
    """Gain in log-likelihood of a fit with more values, less its price; residuals count by their correlation."""
    added = len(more.names) - len(fewer.names)
    count = _independent(more.residual)
    before, after = (float(np.mean(one.residual**2)) for one in (fewer, more))
    saved = np.log(before / after) if after > 0.0 else np.inf
    return 0.5 * count * float(saved) - added * (0.5 * np.log(count) + MARGIN) if before > MATERIAL * after else -np.inf


def _independent(residual: Array) -> float:
    """Number of independent samples with the same information on a variance: n/(1 + 2*sum of rho**2)."""
    samples = residual.shape[1]
    spectrum = np.abs(np.fft.rfft(residual, 2 * samples, axis=1)) ** 2
    covariance = np.fft.irfft(spectrum.sum(axis=0))[:samples]
    rho = covariance / max(covariance[0], 1e-300)
    return max(residual.size / (1.0 + 2.0 * float(np.sum(rho[1:] ** 2))), 2.0 * residual.shape[0])


def _from_grid(recorded: ServoLog, names: tuple[str, ...], given: Mapping[str, float]) -> ServoFit:
    """The base, with a limit where that is better, fitted from the best points of a grid."""
    period, size = recorded.stretches.period, float(np.ptp(recorded.stretches.goal))
    natural = np.geomspace(4.0, min(200.0, 0.7 * np.pi / period), 10)
    late = np.arange(0.0, LONGEST_DEAD_TIME * 0.4, max(0.015, 0.5 * period))
    pulls = "mobility" in names  # by what a known torque moves the servo off its goal, in shares of the goal's range
    grid = np.array(
        [*product(natural, (0.3, 0.7, 1.5, 4.0), late, (0.003,), (np.inf, 0.3, 0.1, 0.03), PULLS if pulls else (0.0,))]
    )
    values = {
        "stiffness": grid[:, 0] ** 2,
        "damping": 2.0 * grid[:, 0] * grid[:, 1],
        "dead_time": grid[:, 2],
        "friction": grid[:, 0] ** 2 * grid[:, 3] * size,
        "limit": grid[:, 0] ** 2 * grid[:, 4] * size,
    }
    if pulls:
        strongest = np.abs(recorded.stretches.known + recorded.stretches.known_slope * recorded.position).max()
        values["mobility"] = grid[:, 0] ** 2 * grid[:, 5] * size / strongest
    values |= {name: np.full(len(grid), value) for name, value in given.items()}
    count = recorded.stretches.starts.size
    some = recorded.only(np.unique(np.linspace(0, count - 1, min(count, 8)).astype(int)))
    found, demand = _errors(some, values)
    begun = []
    for limited in (False, True):
        fitting = np.flatnonzero(np.isfinite(grid[:, 4]) & (demand > 1.05) if limited else np.isinf(grid[:, 4]))
        chosen = list[int]()
        for k in fitting[np.argsort(found[fitting])]:  # the best of each frequency
            if all(grid[k, 0] != grid[j, 0] for j in chosen):
                chosen.append(int(k))
        wanted = (*names, *ADDITIONS["limit"][0]) if limited else names
        begun += [
            (wanted, {**NULL, **given, **{name: float(one[k]) for name, one in values.items()}}) for k in chosen[:BEGUN]
        ]
    near = sorted(descended(some, begun, 8), key=lambda fit: fit.error)
    each = [next((fit for fit in near if ("limit" in fit.names) is limited), None) for limited in (False, True)]
    fits = descended(recorded, [(fit.names, fit.values) for fit in each if fit is not None])
    return fits[-1] if len(fits) == 1 or gain(*fits) > 0.0 else fits[0]


def _starts(recorded: ServoLog, best: ServoFit) -> list[tuple[str, dict[str, float]]]:
    """Additions with their starting values, the one that promises most first.

    Promised is the squared error of a starting value with the other parameters refitted, to first order.
    """
    slopes = np.moveaxis(_slopes(recorded, best)[1], 0, -1).reshape(best.residual.size, -1)
    basis = np.linalg.qr(slopes)[0]
    scales, found = _scales(recorded, best), list[tuple[float, str, dict[str, float]]]()
    for key, (added, shares) in ADDITIONS.items():
        if added[0] in best.names or (key == "gravity" and best.values["mobility"] != 0.0):  # which is known then
            continue
        values = {name: np.full(len(shares), value) for name, value in best.values.items()}
        values[added[0]] = np.array(shares) * scales[key]
        if key == "limit":
            values["damping"] = values["drive_damping"] = 0.5 * values["damping"]
        position, _ = simulated(values, recorded.stretches)
        error = (recorded.compared - position[:, :, recorded.skipped :]).reshape(len(shares), -1)
        promised = np.sum(error**2, axis=1) - np.sum((error @ basis) ** 2, axis=1)
        k = int(np.argmin(promised))
        found.append((float(promised[k]), key, {name: float(one[k]) for name, one in values.items()}))
    return [(key, start) for _, key, start in sorted(found, key=lambda one: one[0])]


def _scales(recorded: ServoLog, best: ServoFit) -> dict[str, float]:
    """What starting values of additions are shares of."""
    goal, period = recorded.stretches.goal, recorded.stretches.period
    size, stiffness = float(np.ptp(goal)), best.values["stiffness"]
    speed = float(np.quantile(np.abs(np.diff(recorded.position)), 0.99)) / period
    asked = best.demand * (best.values["limit"] if np.isfinite(best.values["limit"]) else 1.0)
    return {
        "limit": asked,
        "gravity": stiffness * size,
        "play": size,
        "dead_band": size,
        "feedforward": best.values["damping"] + best.values["drive_damping"],
        "speed_limit": 1.5 * speed,
    }


def _errors(recorded: ServoLog, values: Mapping[str, Array]) -> tuple[Array, Array]:
    """Mean squared error of parameter sets (p,), and what each controller requests at most."""
    position, demand = simulated(values, recorded.stretches)
    return np.mean((recorded.compared - position[:, :, recorded.skipped :]) ** 2, axis=(1, 2)), demand


def descended(
    recorded: ServoLog, starts: Sequence[tuple[tuple[str, ...], Mapping[str, float]]], rounds: int = 25
) -> list[ServoFit]:
    """Least squares from several starts at once, each over the parameters of its names (Levenberg-Marquardt).

    One batch of simulations gives the slopes of all of them, a second one tries three dampings each. What has no scale
    of its own is fitted as its logarithm; a value at its bound stays there while the slope presses it on.
    """
    scales = [_typical(recorded, names, start) for names, start in starts]
    points = [_inner(start, names, scale) for (names, start), scale in zip(starts, scales, strict=True)]
    damping, running, names = np.full(len(starts), 1e-2), list(range(len(starts))), [one for one, _ in starts]

    def run(sets: Sequence[tuple[int, Array]]) -> tuple[Array, Array]:
        values = {name: np.array([starts[k][1][name] for k, _ in sets]) for name in NULL}
        for place, (k, point) in enumerate(sets):
            for name, value in zip(names[k], _outer(point, names[k], scales[k]), strict=True):
                values[name][place] = value
        position, demand = simulated({n: v for n, v in values.items() if (v != NULL[n]).any()}, recorded.stretches)
        return recorded.compared - position[:, :, recorded.skipped :], demand

    for _ in range(rounds):
        if not running:
            break
        shifted = [(k, points[k] + step) for k in running for step in (0.0, *DIFFERENCE * np.eye(points[k].size))]
        errors = run(shifted)[0].reshape(len(shifted), -1)
        at, trials, before = 0, list[tuple[int, Array]](), {}
        for k in running:
            count = points[k].size
            error, slopes = errors[at], (errors[at + 1 : at + 1 + count] - errors[at]) / DIFFERENCE
            at, before[k] = at + 1 + count, float(error @ error)
            bounds = _bounds(names[k], scales[k])
            trials += [(k, one) for one in _steps(points[k], error, slopes, damping[k], bounds)]
        after = np.sum(run(trials)[0] ** 2, axis=(1, 2)).reshape(-1, 3)
        for place, k in enumerate(tuple(running)):
            best = int(np.argmin(after[place]))
            if after[place, best] < before[k]:
                points[k], damping[k] = trials[3 * place + best][1], damping[k] * FACTORS[best]
            else:
                damping[k] *= 400.0
            if damping[k] > 1e6 or 0.0 <= before[k] - after[place, best] < CONVERGED * before[k]:
                running.remove(k)
    last, demand = run([*enumerate(points)])
    found = []
    for k, (of, start) in enumerate(starts):
        values = {**start, **dict(zip(of, _outer(points[k], of, scales[k]).tolist(), strict=True))}
        found.append(ServoFit(values, of, last[k], np.empty((0, 0)), float(demand[k])))
    return found


def _steps(point: Array, error: Array, slopes: Array, damping: float, bounds: tuple[Array, Array]) -> Iterator[Array]:
    """Where three dampings lead from a point (p,) with its error (n,) and the error's slopes (p, n), within bounds."""
    gram, slope, (low, high) = slopes @ slopes.T, slopes @ error, bounds
    free = ~((point <= low) & (slope > 0.0) | (point >= high) & (slope < 0.0))
    inner = gram[np.ix_(free, free)]
    for factor in FACTORS:
        change, ridge = np.zeros(point.size), np.diag(damping * factor * inner.diagonal() + 1e-12 * inner.trace())
        change[free] = -np.linalg.lstsq(inner + ridge, slope[free], rcond=None)[0]
        yield np.clip(point + np.clip(change, -LONGEST_STEP, LONGEST_STEP), low, high)


def _typical(recorded: ServoLog, names: Sequence[str], start: Mapping[str, float]) -> Array:
    """Scale of each parameter: a start that is not at zero, or what would just show."""
    stretches, a = recorded.stretches, start["stiffness"]
    size, rate = float(np.ptp(stretches.goal)), float(np.sqrt(a))
    known = max(float(np.abs(stretches.known).max()), 1e-30)
    typical = {"friction": 1e-2 * a * size, "offset": 1e-2 * a * size, "dead_time": max(0.1 / rate, stretches.period)}
    typical |= {"sine": 0.1 * a * size, "cosine": 0.1 * a * size, "mobility": 0.1 * a * size / known}
    typical |= {"play": 1e-2 * size, "dead_band": 1e-2 * size, "drive_damping": rate, "feedforward": rate}
    return np.array([max(abs(start[name]), 1e-12) if name in LOGARITHMIC else typical[name] for name in names])


def _inner(start: Mapping[str, float], names: Sequence[str], scale: Array) -> Array:
    """What is fitted: logarithms, or values over their scale."""
    values = np.array([start[name] for name in names])
    logs = np.isin(names, LOGARITHMIC)
    return np.where(logs, np.log(np.where(logs, np.maximum(values / scale, 1e-9), 1.0)), values / scale)


def _outer(point: Array, names: Sequence[str], scale: Array) -> Array:
    """Values of what is fitted."""
    logs = np.isin(names, LOGARITHMIC)
    return scale * np.where(logs, np.exp(np.where(logs, point, 0.0)), point)


def _bounds(names: Sequence[str], scale: Array) -> tuple[Array, Array]:
    """Of what is fitted: a dead time has a longest one, and only what is signed is negative."""
    low = np.array([-12.0 if name in LOGARITHMIC else -np.inf if name in SIGNED else 0.0 for name in names])
    late = np.array([name == "dead_time" for name in names])
    return low, np.where(late, LONGEST_DEAD_TIME / scale, np.where(np.isin(names, LOGARITHMIC), 25.0, np.inf))


def _slopes(recorded: ServoLog, fit: ServoFit) -> tuple[list[int], Array]:
    """Numbers of the fitted parameters that are not at zero, and the slope of the motion over each (p, w, samples)."""
    signed = np.array([name in SIGNED for name in fit.names])
    point = np.array([fit.values[name] for name in fit.names])
    free = np.flatnonzero(signed | (point > 1e-9))
    least = {"dead_time": 0.02 * recorded.stretches.period / DIFFERENCE}
    least |= dict.fromkeys(("offset", "sine", "cosine"), 1e-2 * fit.values["friction"] + 1e-6 * fit.values["stiffness"])
    step = DIFFERENCE * np.array([max(abs(fit.values[name]), least.get(name, 1e-12)) for name in fit.names])
    low = np.where(signed, -np.inf, 0.0)
    points = np.vstack([np.maximum(point + side * np.diag(step)[free], low) for side in (1.0, -1.0)])
    values = {name: np.full(len(points), value) for name, value in fit.values.items()}
    values |= {name: points[:, k] for k, name in enumerate(fit.names)}
    position = simulated(values, recorded.stretches)[0][:, :, recorded.skipped :]
    width = np.diagonal((points[: free.size] - points[free.size :])[:, free])
    return free.tolist(), (position[: free.size] - position[free.size :]) / width[:, None, None]


def _with_replicates(recorded: ServoLog, best: ServoFit) -> ServoFit:
    """The fit with what leaving out each stretch w changes: -(H - H_w)**-1 * J_w'*r_w."""
    free, slopes = _slopes(recorded, best)
    size = np.sqrt(np.sum(slopes**2, axis=(1, 2)))
    size = np.where(size > 0.0, size, 1.0)
    slopes = slopes / size[:, None, None]
    grams = np.einsum("iws,jws->wij", slopes, slopes)
    scores = np.einsum("iws,ws->wi", slopes, best.residual)
    replicates = np.tile([best.values[name] for name in best.names], (len(grams), 1))
    for w, (gram, score) in enumerate(zip(grams, scores, strict=True)):
        change = np.linalg.lstsq(grams.sum(axis=0) - gram, -score, rcond=1e-12)[0]
        replicates[w, free] += change / size
    return replace(best, replicates=replicates)
