"""A hypothesis: which effects there are and of what shape; and its fit to a recording."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.dead_zone import dead_zone_columns, sensitivity
from bench.diagnose.friction_levels import alike, levels_of, multiply, rubbing
from bench.diagnose.noise import noise_floor
from bench.diagnose.outside import physics_of
from bench.diagnose.transforms import corrected, lagged, two_mass
from bench.diagnose.workbench import Workbench
from bench.effects.effect import Base, Column, Signals

Array = NDArray[np.float64]

CURRENT_LAG, VELOCITY_LAG = "current_loop_lag", "velocity_filter_lag"
BACKLASH = "backlash"
ELASTIC, ECCENTRICITY, DIRECTION = "elastic_coupling", "encoder_eccentricity", "direction_dependent_friction"
#: Owners of columns that belong to no effect.
BASE, MAINS = -1, -2
#: Column of the time by which torque is behind speed.
MISALIGNMENT = 3
#: Rounds in which levels of dry friction that multiply are brought in line.
LEVEL_ROUNDS = 4
#: Share of the noise floor by which a row's torque may hang on the contact of a dead zone.
UNTOLD_SHARE = 0.3
#: Effects that change how columns are made instead of adding columns of raw products.
TRANSFORMS = (CURRENT_LAG, VELOCITY_LAG, ECCENTRICITY, ELASTIC, BACKLASH)


@dataclass(frozen=True)
class Named:
    """An effect with its shape quantities, in the order in which the effect lists them."""

    name: str
    shape: tuple[float, ...] = ()


@dataclass(frozen=True)
class Hypothesis:
    """Effects beyond inertia, viscous and Coulomb friction.

    Attributes:
        effects: in the order they were added.
        levels: strengths over K_0 of each effect that is dry friction, () of the others.
        mains: frequencies of the hum in this recording's sensors - Hz.
    """

    effects: tuple[Named, ...] = ()
    levels: tuple[tuple[float, ...], ...] = ()
    mains: tuple[float, ...] = ()

    def with_effect(self, named: Named) -> Hypothesis:
        """This hypothesis and one effect more."""
        return replace(self, effects=(*self.effects, named))

    def with_mains(self, mains: tuple[float, ...]) -> Hypothesis:
        """This hypothesis with hum at frequencies - Hz."""
        return replace(self, mains=mains)

    def without(self, index: int) -> Hypothesis:
        """This hypothesis less one of its effects."""
        effects, levels = self.effects, self.levels
        return replace(
            self,
            effects=(*effects[:index], *effects[index + 1 :]),
            levels=(*levels[:index], *levels[index + 1 :]),
        )

    def reshaped(self, index: int, shape: tuple[float, ...]) -> Hypothesis:
        """This hypothesis with another shape of one effect."""
        effect = replace(self.effects[index], shape=shape)
        return replace(self, effects=(*self.effects[:index], effect, *self.effects[index + 1 :]))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(effect.name for effect in self.effects)

    def shape_of(self, name: str) -> tuple[float, ...] | None:
        """Shape of an effect, None where it is not in."""
        return next((effect.shape for effect in self.effects if effect.name == name), None)


@dataclass(frozen=True)
class Fit:
    """A hypothesis fitted to a recording by least squares.

    Attributes:
        hypothesis: what was fitted.
        columns: (m, p).
        theta: (p,): J, K_w, K_0, misalignment, sines and cosines of hum, then the strengths of the effects in order.
        owners: (p,) index of the effect a column belongs to, BASE or MAINS.
        residual: (m,), 0 at rows that are not told - N*m (N).
        floor: RMS that sensor noise alone leaves under this model, see `bench.diagnose.noise` - N*m (N).
        held: whether the misalignment is at its bound.
        told: (m,) rows whose torque the recording determines: not those that hang on the instant of an impact.
    """

    hypothesis: Hypothesis
    columns: Array
    theta: Array
    owners: NDArray[np.int64]
    residual: Array
    floor: float
    held: bool
    told: NDArray[np.bool_]

    @property
    def rms(self) -> float:
        """RMS residual - N*m (N)."""
        return float(np.sqrt(np.mean(self.residual[self.told] ** 2)))

    @property
    def chi(self) -> float:
        """RMS residual over noise floor: 1 where the model explains all but noise."""
        return self.rms / self.floor

    @property
    def excess(self) -> float:
        """Squares above the noise floor, summed over rows - (N*m)**2, not negative."""
        return max(float(np.sum(self.residual**2)) - np.count_nonzero(self.told) * self.floor**2, 0.0)

    @property
    def base(self) -> Base:
        """J, K_w and K_0."""
        return Base(*(float(value) for value in self.theta[:3]))

    @property
    def span(self) -> Array:
        """Orthonormal basis of the columns that were free (m, p)."""
        free = np.delete(self.columns, MISALIGNMENT, 1) if self.held else self.columns
        return np.linalg.qr(free)[0]

    def strengths(self, index: int) -> Array:
        """Strengths of one effect."""
        return self.theta[self.owners == index]


def prepared(bench: Workbench, hypothesis: Hypothesis) -> Workbench:
    """The recording as the hypothesis sees it: angle corrected, torque as it acts."""
    eccentricity = hypothesis.shape_of(ECCENTRICITY)
    lag = (hypothesis.shape_of(CURRENT_LAG) or (0.0,))[0]

    def change(signals: Signals) -> Signals:
        signals = corrected(signals, eccentricity) if eccentricity else signals
        effort = lagged(signals.effort, lag, signals.sample_period) if lag else signals.effort
        return replace(signals, torque=effort)

    return bench.with_signals(change) if eccentricity or lag else bench


def kinematic(bench: Workbench, order: int) -> tuple[str, int]:
    """Raw signal and derivative that give the `order`-th derivative of speed."""
    return ("position", order + 1) if bench.conditioning.source == "position" else ("velocity", order)


def lags(bench: Workbench, hypothesis: Hypothesis) -> tuple[float, float]:
    """Lag to undo on speed and acceleration, and on everything else - s."""
    current = (hypothesis.shape_of(CURRENT_LAG) or (0.0,))[0]
    velocity = (hypothesis.shape_of(VELOCITY_LAG) or (0.0,))[0] if bench.conditioning.source == "velocity" else 0.0
    return current + velocity, current


def build(bench: Workbench, hypothesis: Hypothesis) -> tuple[Array, NDArray[np.int64]]:
    """Columns (m, p) of a hypothesis and the effect each belongs to (p,)."""
    seen = prepared(bench, hypothesis)
    moving, resting = lags(bench, hypothesis)
    speed, acceleration = kinematic(bench, 0), kinematic(bench, 1)

    def motion(signals: Signals) -> list[Column]:
        return [[(getattr(signals, name), order)] for name, order in (acceleration, speed)]

    parts = [seen.table(motion, moving), seen.table(lambda s: [[(s.sign, 0)], [(-s.effort, 1)]], resting)]
    owners = [BASE] * 4
    if hypothesis.mains:
        parts.append(seen.table(lambda s: [wave for f in hypothesis.mains for wave in _hum(s, f)], resting))
        owners += [MAINS] * 2 * len(hypothesis.mains)
    for index, effect in enumerate(hypothesis.effects):
        table = effect_columns(rubbing(seen, hypothesis, index), effect, moving, resting)
        parts.append(table)
        owners += [index] * table.shape[1]
    return np.concatenate(parts, axis=1), np.array(owners)


def _hum(signals: Signals, frequency: float) -> list[Column]:
    angle = 2.0 * np.pi * frequency * signals.time
    return [[(np.sin(angle), 0)], [(np.cos(angle), 0)]]


def effect_columns(seen: Workbench, effect: Named, moving: float, resting: float) -> Array:
    """Columns (m, k) of one effect; none for one that only changes how the others are made."""
    if effect.name == ELASTIC:
        return seen.table(lambda s: [[(s.velocity, 1)]], moving, two_mass(seen, *effect.shape))
    if effect.name == BACKLASH:
        key = (effect, moving, seen.stretches[0].signals.position[-1])
        if key not in seen.memory:
            seen.memory[key] = dead_zone_columns(seen, np.array([effect.shape]), moving)
        return seen.memory[key]
    if effect.name in TRANSFORMS:
        return np.empty((seen.effort.size, 0))
    physics = physics_of(effect.name)
    return seen.table(lambda s: physics.columns(s, effect.shape), resting)


def fit(bench: Workbench, hypothesis: Hypothesis) -> Fit:
    """Least squares of a hypothesis; the levels that scaled frictions see are brought in line with what is found."""
    columns, owners, theta = _solved(bench, hypothesis)
    for _ in range(LEVEL_ROUNDS):
        levels = levels_of(hypothesis, theta, owners)
        settled = alike(levels, hypothesis.levels) or not multiply(hypothesis)
        hypothesis = replace(hypothesis, levels=levels)
        if settled:
            break
        columns, owners, theta = _solved(bench, hypothesis)
    residual = bench.effort - columns @ theta
    floor = noise_floor(bench, white_power(bench, hypothesis, theta, owners), residual)
    told = _told(bench, hypothesis, theta, owners, floor)
    if not told.all():
        theta = _balanced(bench, columns[told], bench.effort[told])
        residual = (bench.effort - columns @ theta) * told
    held = abs(theta[MISALIGNMENT]) >= bench.latched
    return Fit(hypothesis, columns, theta, owners, residual, floor, held, told)


def _told(
    bench: Workbench, hypothesis: Hypothesis, theta: Array, owners: NDArray[np.int64], floor: float
) -> NDArray[np.bool_]:
    """Rows whose modelled torque a contact that the recording does not tell from this one would not change (m,)."""
    effect = hypothesis.shape_of(BACKLASH)
    if effect is None:
        return np.ones(bench.effort.size, dtype=bool)
    seen, (moving, _) = prepared(bench, hypothesis), lags(bench, hypothesis)
    key = ("sensitivity", effect, moving, seen.stretches[0].signals.position[-1])
    if key not in seen.memory:
        seen.memory[key] = sensitivity(seen, effect, moving)
    load = abs(theta[owners == hypothesis.names.index(BACKLASH)][0])
    return seen.memory[key] * load < UNTOLD_SHARE * floor


def _solved(bench: Workbench, hypothesis: Hypothesis) -> tuple[Array, NDArray[np.int64], Array]:
    columns, owners = build(bench, hypothesis)
    return columns, owners, _balanced(bench, columns, bench.effort)


def _balanced(bench: Workbench, columns: Array, effort: Array) -> Array:
    """Least squares; torque and speed are no further apart in time than they were latched, else it is a lag."""
    theta = _least_squares(columns, effort)
    if abs(theta[MISALIGNMENT]) > bench.latched:
        held = np.copysign(bench.latched, theta[MISALIGNMENT])
        rest = _least_squares(np.delete(columns, MISALIGNMENT, 1), effort - held * columns[:, MISALIGNMENT])
        theta = np.insert(rest, MISALIGNMENT, held)
    return theta


def _least_squares(columns: Array, effort: Array) -> Array:
    scale = np.sqrt(np.mean(columns**2, axis=0)) + 1e-300
    return np.linalg.lstsq(columns / scale, effort, rcond=1e-10)[0] / scale


def white_power(
    bench: Workbench, hypothesis: Hypothesis, theta: Array, owners: NDArray[np.int64]
) -> Callable[[Array], Array]:
    """Power of white noise of effort and speed in the torque balance, over angular frequency - (N*m)**2 (N**2).

    s_M**2*|1 + tau*s|**2 + s_w**2*|(J*s + K_w)*(1 + lag*s) + ...|**2
    """
    conditioning = bench.conditioning
    moving, _ = lags(bench, hypothesis)
    elastic = hypothesis.shape_of(ELASTIC)

    def power(omega: Array) -> Array:
        s = 1j * omega
        kinetic = theta[0] * s + theta[1]
        if BACKLASH in hypothesis.names:
            kinetic = kinetic - theta[owners == hypothesis.names.index(BACKLASH)][0] * s
        if elastic is not None:
            relative = two_mass(bench, *elastic)(omega)
            kinetic = kinetic + theta[owners == hypothesis.names.index(ELASTIC)][0] * s * relative
        kinetic = kinetic * (1.0 + moving * s) * (s if conditioning.source == "position" else 1.0)
        effort = conditioning.effort_noise**2 * np.abs(1.0 + theta[MISALIGNMENT] * s) ** 2
        return effort + conditioning.source_noise**2 * np.abs(kinetic) ** 2

    return power
