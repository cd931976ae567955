"""Corruptions of signals: of time - s -, speed - rad/s - and current - A -, (n,) each."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

Signals = tuple[np.ndarray, np.ndarray, np.ndarray]

KINDS: dict[str, Callable[[np.random.Generator, np.ndarray, np.ndarray, np.ndarray], Signals]] = {}
#: Kinds that leave a recording which another axis would give: only who knows the axis can tell.
OF_ANOTHER_AXIS = {"time 5 % too long", "current 5 % too large", "speed 10 % too large", "current 10 % too small"}


def of_current(name: str, change: Callable) -> None:
    """A corruption of the current alone."""
    KINDS[name] = lambda rng, t, w, i: (t, w, change(rng, i.copy(), t))


def of_speed(name: str, change: Callable) -> None:
    """A corruption of the speed alone."""
    KINDS[name] = lambda rng, t, w, i: (t, change(rng, w.copy(), t), i)


def stretch(rng: np.random.Generator, size: int, share: float) -> slice:
    """A stretch of a share of the samples, anywhere."""
    length = int(share * size)
    start = int(rng.integers(0, size - length))
    return slice(start, start + length)


def within(change: Callable, share: float) -> Callable:
    """A change of a stretch."""

    def changed(rng: np.random.Generator, values: np.ndarray, _: np.ndarray) -> np.ndarray:
        part = stretch(rng, values.size, share)
        values[part] = change(rng, values[part])
        return values

    return changed


def late(seconds: float) -> Callable:
    """A delay; the ends hold their value."""

    def delayed(_: np.random.Generator, values: np.ndarray, time: np.ndarray) -> np.ndarray:
        return np.interp(time - seconds, time, values)

    return delayed


def low_passed(seconds: float) -> Callable:
    """A first-order lag."""

    def passed(_: np.random.Generator, values: np.ndarray, time: np.ndarray) -> np.ndarray:
        pole = np.exp(-(time[1] - time[0]) / seconds)
        return np.asarray(lfilter([1.0 - pole], [1.0, -pole], values))

    return passed


def spikes(rng: np.random.Generator, values: np.ndarray, _: np.ndarray) -> np.ndarray:
    """Twenty samples that are far off."""
    values[rng.integers(0, values.size, 20)] *= -30.0
    return values


def sometimes_zero(rng: np.random.Generator, values: np.ndarray, _: np.ndarray) -> np.ndarray:
    """Twenty gaps of twenty samples."""
    for start in rng.integers(0, values.size - 20, 20):
        values[start : start + 20] = 0.0
    return values


def scaled(factor: float) -> Callable:
    """Another scale throughout."""
    return lambda rng, values, time: values * factor


def clipped(share: float, low: bool = True) -> Callable:
    """A range that ends at a share of the largest value, to both sides or upwards."""
    return lambda rng, values, time: np.clip(
        values, -share * abs(values).max() if low else None, share * abs(values).max()
    )


def numbered_on(t: np.ndarray, w: np.ndarray, i: np.ndarray, times: np.ndarray) -> Signals:
    """Each sample so many times as of `times` (n,), at the times of the first ones."""
    places = np.repeat(np.arange(t.size), times)[: t.size]
    return t[: places.size], w[places], i[places]


def outside(part: slice, time: np.ndarray) -> np.ndarray:
    """Which samples do not lie in a stretch."""
    every = np.arange(time.size)
    return (every < part.start) | (every >= part.stop)


of_current("sign of the current turned from half on", lambda rng, i, t: np.where(t < t[t.size // 2], i, -i))
of_current("sign of the current turned for a tenth", within(lambda rng, i: -i, 0.1))
of_current("sign of the current turned for a third", within(lambda rng, i: -i, 0.33))
of_speed("sign of the speed turned from half on", lambda rng, w, t: np.where(t < t[t.size // 2], w, -w))
of_current("sign of the current turned throughout", scaled(-1.0))
of_current("current zero for a third", within(lambda rng, i: 0.0 * i, 0.33))
of_current("current zero for a tenth", within(lambda rng, i: 0.0 * i, 0.1))
of_current("current zero and noise for a third", within(lambda rng, i: 0.01 * rng.normal(size=i.size), 0.33))
of_current("current zero in twenty gaps", sometimes_zero)
of_speed("speed zero for a tenth", within(lambda rng, w: 0.0 * w, 0.1))
of_current("current clipped at 40 %", clipped(0.4))
of_current("current clipped at 70 %", clipped(0.7))
of_current("current clipped to one side", clipped(0.4, low=False))
of_speed("speed clipped at 60 %", clipped(0.6))
of_current("current held for a tenth", within(lambda rng, i: np.full(i.size, i[0]), 0.1))
of_speed("speed held for a tenth", within(lambda rng, w: np.full(w.size, w[0]), 0.1))
of_current("current 20 ms late", late(0.02))
of_current("current 20 ms early", late(-0.02))
of_current("current 50 ms late", late(0.05))
of_current("current 5 ms late", late(0.005))
of_speed("speed 20 ms late", late(0.02))
of_current("current filtered by 30 ms", low_passed(0.03))
of_speed("speed filtered by 30 ms", low_passed(0.03))
of_current("mA from half on", lambda rng, i, t: np.where(t < t[t.size // 2], i, 1e3 * i))
of_current("current half as large from half on", lambda rng, i, t: np.where(t < t[t.size // 2], i, 0.5 * i))
of_current("current 5 % too large", scaled(1.05))
of_current("current 10 % too small", scaled(0.9))
of_current("effective for peak", scaled(0.5**0.5))
of_current("mA for A", scaled(1e3))
of_speed("speed 10 % too large", scaled(1.1))
of_speed("rpm for rad/s", scaled(30.0 / np.pi))
of_speed("rad/s for rpm", scaled(np.pi / 30.0))
of_speed("Hz for rad/s", scaled(0.5 / np.pi))
of_current("magnitude of the current", lambda rng, i, t: abs(i))
of_speed("magnitude of the speed", lambda rng, w, t: abs(w))
of_current("current with an offset", lambda rng, i, t: i + 0.2 * abs(i).max())
of_current("current that drifts", lambda rng, i, t: i + 0.5 * abs(i).max() * t / t[-1])
of_current("spikes of the current", spikes)
of_speed("spikes of the speed", spikes)
of_current("current in steps of a tenth", lambda rng, i, t: np.round(i / abs(i).max() * 10.0) * abs(i).max() / 10.0)
of_speed("speed in steps of a tenth", lambda rng, w, t: np.round(w / abs(w).max() * 10.0) * abs(w).max() / 10.0)
of_current("current backwards", lambda rng, i, t: i[::-1])
of_current("current of another motion", lambda rng, i, t: np.roll(i, i.size // 3))
of_current("noise of the current for a third", within(lambda rng, i: i + 3.0 * rng.normal(size=i.size), 0.33))
of_speed("speed that wraps", lambda rng, w, t: (w + 50.0) % 100.0 - 50.0)

KINDS |= {
    "time twice as long": lambda rng, t, w, i: (2.0 * t, w, i),
    "time 5 % too long": lambda rng, t, w, i: (1.05 * t, w, i),
    "ms for s": lambda rng, t, w, i: (1e3 * t, w, i),
    "samples lost, numbered on": lambda rng, t, w, i: numbered_on(t, w, i, rng.random(t.size) > 0.02),
    "samples written twice, numbered on": lambda rng, t, w, i: numbered_on(t, w, i, 1 + (rng.random(t.size) < 0.02)),
    "a tenth cut out, numbered on": lambda rng, t, w, i: numbered_on(t, w, i, outside(stretch(rng, t.size, 0.1), t)),
    "clock jumps ahead": lambda rng, t, w, i: (t + (t > t[t.size // 2]) * 0.5, w, i),
    "clock jumps back": lambda rng, t, w, i: (t - (t > t[t.size // 2]) * 0.5, w, i),
    "times that jitter by half a period": lambda rng, t, w, i: (
        t + rng.uniform(-0.5, 0.5, t.size) * (t[1] - t[0]),
        w,
        i,
    ),
    "values missing": lambda rng, t, w, i: (t, w, np.where(rng.random(t.size) < 0.1, np.nan, i)),
    "columns swapped": lambda rng, t, w, i: (t, i, w),
    "two thirds in the other order": lambda rng, t, w, i: (t, np.roll(w, t.size // 3), np.roll(i, t.size // 3)),
}
