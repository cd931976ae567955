"""A motor with few samples to its time constant: its voltage is held between them, and no derivative is taken.

    U - kS*sgn(w) = kV*w + kA*dw/dt                                  so over a period T, of a voltage that is held,
    U - kS*sgn(w) = kV*w + kV/(1 - q)*(w' - w),  q = exp(-T*kV/kA)

U - voltage - V; w, w' - speed at a sample and at the next, or mean speeds between positions - rad/s (m/s). Where the
voltage is sent late, or is not held, U is a mean of voltages next to each other, whose weights are fitted; q is that of
the motor in any case.
"""

from __future__ import annotations

import math

import numpy as np

from bench.arrays import NORMAL95, Array
from bench.errors import UndeterminedError
from bench.fit.regression import DETERMINED, STEPS, regressed
from bench.fit.solution import left_out
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.filter import GaussianFilter
from bench.trace.motion import condition, known_sign
from bench.trace.noise import white_noise
from bench.trace.trace import Trace

#: Of each source: noise of the change of a speed and of the speed (2, 2), in units of a sample's, and which voltages
#: act besides the one at the first of both speeds.
NOISE = {"velocity": np.array([[2.0, -1.0], [-1.0, 1.0]]), "position": np.array([[6.0, -3.0], [-3.0, 2.0]])}
BESIDES = {"velocity": (1, -1), "position": (2, 1, -1)}
#: Samples by which a voltage may be late, and turns in which the noise of the speed is found.
LATEST, TURNS = 12, 4
#: What to record where samples are too far apart.
FASTER = f"{STEPS}, at a higher rate"


def sampled(trace: Trace, rig: Rig, load: bool) -> tuple[dict[str, Parameter], float]:
    """kS, kV, kA and, with a load, kG of a recording with a voltage, and a delay of the voltage beyond its hold - s.

    Of the winding's L/R nothing is in kA; it may be in the delay. UndeterminedError where too few samples move clearly,
    or there are too few to the time constant.
    """
    voltage, period = rig.voltage(trace), trace.sample_period
    at = condition(trace, voltage)
    tables = [_table(trace, voltage, at.source, at.sign_threshold, late, load) for late in range(LATEST + 1)]
    late = min(range(LATEST + 1), key=lambda late: _left(tables[late][1]))
    loudest = white_noise(*(trace[at.source][part] for part in trace.segments)) / period ** (at.source == "position")
    fitted = _fitted(*tables[late], NOISE[at.source], loudest, at.filter)
    acceleration = _acceleration(fitted[0], fitted[1], period)
    names = ["kV", "kS", *(["kG"] if load else [])]
    feedforward = {**dict(zip(names, fitted[1:], strict=False)), "kA": acceleration}
    besides = sum(one.value * by for one, by in zip(fitted[1 + len(names) :], BESIDES[at.source], strict=True))
    delay = (_acts_after(at.source, acceleration.value / fitted[1].value / period) + late - besides) * period
    return feedforward, delay


def _fitted(time: Array, table: Array, noise: Array, loudest: float, smooth: GaussianFilter) -> list[Parameter]:
    """Coefficients of a table (p + 1, m), as of `_table`, with the noise of the speed in its first two rows.

    `noise`: of these two (2, 2), in units of that of a speed; `loudest`: most of that - rad/s (m/s).
    """
    power, fitted, left = 0.0, list[Parameter](), table[-1]
    for _ in range(TURNS):
        own = np.pad(power * noise, (0, len(table) - 3))
        fitted = regressed(time, table, own, 0.0, smooth, _too_slow(smooth.sample_period), FASTER)
        theta = np.array([one.value for one in fitted])
        left = table[-1] - theta @ table[:-1]
        power = min(float(np.mean(left**2)) / float(theta[:2] @ noise @ theta[:2]), loudest**2)
    # the few samples after each step may decide kA, which a covariance over blocks of time hardly shows
    wide = left_out(table[:-1].T, left).tolist()
    return [one.widened(by) for one, by in zip(fitted, wide, strict=True)]


def _table(trace: Trace, voltage: Array, source: str, threshold: float, late: int, load: bool) -> tuple[Array, Array]:
    """Times (m,), and change of speed, speed, its sign, a constant, differences of voltages and voltage (p + 1, m)."""
    times, tables = [], []
    for part in trace.segments:
        time, values, volts = trace.time[part], trace[source][part], voltage[part]
        speed = np.diff(values) / trace.sample_period if source == "position" else values
        sign = known_sign(speed, threshold)
        first = np.arange(late + 1, speed.size - 2)
        near = sign[first + np.arange(-1, 3)[:, None]]
        first = first[np.abs(near.sum(axis=0)) == len(near)]
        at, now = volts[first - late], speed[first]
        columns = [speed[first + 1] - now, now, sign[first], *([np.ones(first.size)] if load else [])]
        tables.append(np.array([*columns, *(at - volts[first - late + by] for by in BESIDES[source]), at]))
        times.append(time[first])
    return np.concatenate(times), np.concatenate(tables, axis=1)


def _left(table: Array) -> float:
    """Mean squared residual of the last row by the others - V**2 -; infinite with fewer samples than rows."""
    if table.shape[1] <= len(table):
        return math.inf
    found = np.linalg.lstsq(table[:-1].T, table[-1], rcond=None)[0]
    return float(np.mean((table[-1] - found @ table[:-1]) ** 2))


def _acceleration(change: Parameter, speed: Parameter, period: float) -> Parameter:
    """kA of kV/(1 - q) and kV - V*s**2/rad (V*s**2/m); UndeterminedError where there are too few samples for it."""
    ends = [one.value + by * one.half_width for one in (change, speed) for by in (-1.0, 1.0)]
    value = _of_hold(change.value, speed.value, period)
    low, high = _of_hold(ends[0], speed.value, period), _of_hold(ends[1], speed.value, period)
    moved = max(abs(_of_hold(change.value, end, period) - value) for end in ends[2:])
    half = 0.5 * (high - low) + moved
    if not 0.0 < half < DETERMINED * value:
        raise UndeterminedError("kA", _too_slow(period), FASTER)
    return Parameter(value, "", half / NORMAL95, (min(low, value) - moved, max(high, value) + moved))


def _too_slow(period: float) -> str:
    return f"samples every {1e3 * period:.3g} ms do not show how fast the motor follows its voltage"


def _of_hold(change: float, speed: float, period: float) -> float:
    """kA of kV/(1 - q) and kV; 0 where the speed has settled within a sample."""
    return -period * speed / math.log1p(-speed / change) if 0.0 < speed < change else 0.0


def _acts_after(source: str, constant: float) -> float:
    """Samples after the first of both speeds at which a held voltage acts in the mean, by kA/kV in samples.

    Of speeds all that acts between them is one voltage; of mean speeds it is the next one too, by (1 - m)/(1 - q),
    m = kA/(kV*T)*(1 - q).
    """
    if source == "velocity":
        return 0.0
    lost = -math.expm1(-1.0 / constant)
    return (1.0 - constant * lost) / lost
