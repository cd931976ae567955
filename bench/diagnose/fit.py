"""A hypothesis fitted to a recording by least squares, held against what noise alone would leave."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.columns import MISALIGNMENT, build, lags, prepared
from bench.diagnose.dead_zone import sensitivity
from bench.diagnose.friction_levels import alike, levels_of, multiply
from bench.diagnose.hypothesis import (
    BACKLASH,
    ECCENTRICITY,
    ELASTIC,
    Hypothesis,
)
from bench.diagnose.load_side import loads_of
from bench.diagnose.noise import noise_floor
from bench.diagnose.outside import physics_of
from bench.diagnose.transforms import two_mass
from bench.diagnose.workbench import Workbench
from bench.effects.effect import Base

Array = NDArray[np.float64]

#: Effects whose columns are made of the measured torque, and so hold its noise.
OF_EFFORT = ("load_dependent_friction", "torque_ripple", "torque_constant_saturation")
#: Rounds in which levels of dry friction that multiply are brought in line.
LEVEL_ROUNDS = 4
#: Share of the noise floor by which a row's torque may hang on the contact of a dead zone.
UNTOLD_SHARE = 0.3


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
        white: the part of the floor that is white noise's - N*m (N).
        held: whether the misalignment is at its bound.
        told: (m,) rows whose torque the recording determines: not those that hang on the instant of an impact.
    """

    hypothesis: Hypothesis
    columns: Array
    theta: Array
    owners: NDArray[np.int64]
    residual: Array
    floor: float
    white: float
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


def fit(bench: Workbench, hypothesis: Hypothesis) -> Fit:
    """Least squares of a hypothesis; the levels that scaled frictions see are brought in line with what is found."""
    columns, owners, theta = _solved(bench, hypothesis)
    for _ in range(LEVEL_ROUNDS):
        levels, loads = levels_of(hypothesis, theta, owners), loads_of(hypothesis, theta, owners)
        settled = alike(levels, hypothesis.levels) or not multiply(hypothesis)
        settled &= loads is None or alike(loads, hypothesis.loads or ())
        hypothesis = replace(hypothesis, levels=levels, loads=loads)
        if settled:
            break
        columns, owners, theta = _solved(bench, hypothesis)
    residual = bench.effort - columns @ theta
    floor, white = noise_floor(bench, white_power(bench, hypothesis, theta, owners), residual)
    told = _told(bench, hypothesis, theta, owners, floor)
    if not told.all():
        theta = _balanced(bench, columns[told], bench.effort[told])
        residual = (bench.effort - columns @ theta) * told
    held = abs(theta[MISALIGNMENT]) >= bench.latched
    return Fit(hypothesis, columns, theta, owners, residual, floor, white, held, told)


def _told(
    bench: Workbench, hypothesis: Hypothesis, theta: Array, owners: NDArray[np.int64], floor: float
) -> NDArray[np.bool_]:
    """Rows whose modelled torque a contact that the recording does not tell from this one would not change (m,)."""
    effect = hypothesis.shape_of(BACKLASH)
    if effect is None:
        return np.ones(bench.effort.size, dtype=bool)
    seen, (moving, _) = prepared(bench, hypothesis), lags(bench, hypothesis)
    made_of = ("sensitivity", effect, moving, hypothesis.shape_of(ECCENTRICITY))
    moved = seen.memory.get(made_of, lambda: sensitivity(seen, effect, moving))
    load = abs(theta[owners == hypothesis.names.index(BACKLASH)][0])
    return moved * load < UNTOLD_SHARE * floor


def _solved(bench: Workbench, hypothesis: Hypothesis) -> tuple[Array, NDArray[np.int64], Array]:
    columns, owners = build(bench, hypothesis)
    return columns, owners, _balanced(bench, columns, bench.effort)


def _balanced(bench: Workbench, columns: Array, effort: Array) -> Array:
    """Least squares; torque and speed are no further apart in time than they were latched, else it is a lag."""
    theta = least_squares(columns, effort)
    if abs(theta[MISALIGNMENT]) > bench.latched:
        held = np.copysign(bench.latched, theta[MISALIGNMENT])
        rest = least_squares(np.delete(columns, MISALIGNMENT, 1), effort - held * columns[:, MISALIGNMENT])
        theta = np.insert(rest, MISALIGNMENT, held)
    return theta


def least_squares(columns: Array, effort: Array) -> Array:
    """Strengths (p,) of columns (m, p), scaled before they are solved."""
    scale = np.sqrt(np.mean(columns**2, axis=0)) + 1e-300
    return np.linalg.lstsq(columns / scale, effort, rcond=1e-10)[0] / scale


def white_power(
    bench: Workbench, hypothesis: Hypothesis, theta: Array, owners: NDArray[np.int64]
) -> Callable[[Array], Array]:
    """Power of white noise of effort and speed in the torque balance, over angular frequency - (N*m)**2 (N**2).

    s_M**2*|1 + tau*s|**2*<(1 - dM_model/dM)**2> + s_w**2*|(J*s + K_w)*(1 + lag*s) + ...|**2
    """
    conditioning = bench.conditioning
    left = _left_of_effort(bench, hypothesis, theta, owners)
    moving, _ = lags(bench, hypothesis)
    elastic = hypothesis.shape_of(ELASTIC)

    def power(omega: Array) -> Array:
        s = 1j * omega
        kinetic = theta[0] * s + theta[1]
        if BACKLASH in hypothesis.names:
            kinetic = kinetic - theta[owners == hypothesis.names.index(BACKLASH)][0] * s
        if elastic is not None:
            relative = two_mass(*elastic)(omega)
            kinetic = kinetic + theta[owners == hypothesis.names.index(ELASTIC)][0] * s * relative
        kinetic = kinetic * (1.0 + moving * s) * (s if conditioning.source == "position" else 1.0)
        effort = left * conditioning.effort_noise**2 * np.abs(1.0 + theta[MISALIGNMENT] * s) ** 2
        return effort + conditioning.source_noise**2 * np.abs(kinetic) ** 2

    return power


def _left_of_effort(bench: Workbench, hypothesis: Hypothesis, theta: Array, owners: NDArray[np.int64]) -> float:
    """Mean of (1 - dM_model/dM)**2: what effects made of the measured torque leave of its noise's power.

    An effect that copies the torque copies its noise, and so would take all of it for explained.
    """
    made = [k for k, effect in enumerate(hypothesis.effects) if effect.name in OF_EFFORT]
    if not made:
        return 1.0
    total, count = 0.0, 0
    for part in bench.stretches:
        signals = part.signals
        step = 1e-6 * signals.peak_effort
        more, slope = replace(signals, torque=signals.torque + step), np.zeros(signals.torque.size)
        for k in made:
            physics, shape = physics_of(hypothesis.effects[k].name), hypothesis.effects[k].shape
            pairs = zip(physics.columns(more, shape), physics.columns(signals, shape), theta[owners == k], strict=True)
            for ((high, _),), ((low, _),), strength in pairs:
                slope += strength * (high - low) / step
        total, count = total + float(np.sum((1.0 - slope) ** 2)), count + slope.size
    return total / count
