"""Sound recordings damaged one way at a time, as recorders do it."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from bench.trace.trace import Trace


def with_samples(trace: Trace, kept: np.ndarray, period: float | None = None) -> Trace:
    """Samples `kept` (m,) of a recording, numbered on at its period or another one - s."""
    time = trace.time[0] + np.arange(kept.size) * (period or trace.sample_period)
    return Trace(time, {name: values[kept] for name, values in trace.signals.items()}, trace.units, trace.origin)


def hit(trace: Trace, share: float, seed: int = 0) -> np.ndarray:
    """A share of the samples, none at the ends, as flags (n,)."""
    chosen = np.random.default_rng(seed).random(len(trace)) < share
    chosen[:3] = chosen[-3:] = False
    return chosen


def losing(trace: Trace, share: float, seed: int = 0) -> Trace:
    """Samples lost, the rest renumbered."""
    return with_samples(trace, np.flatnonzero(~hit(trace, share, seed)))


def stale(trace: Trace, share: float, seed: int = 0) -> Trace:
    """Samples that repeat the one before in its place."""
    every = np.arange(len(trace))
    return with_samples(trace, np.where(hit(trace, share, seed), every - 1, every))


def doubled(trace: Trace, share: float, seed: int = 0) -> Trace:
    """Samples written twice, the rest renumbered."""
    return with_samples(trace, np.repeat(np.arange(len(trace)), 1 + hit(trace, share, seed)))


def without(trace: Trace, *names: str) -> Trace:
    """The recording without some signals."""
    return keeping(trace, [name for name in trace.signals if name not in names])


def keeping(trace: Trace, names: Collection[str]) -> Trace:
    """The recording with some signals only."""
    signals = {name: trace[name] for name in names}
    return Trace(trace.time, signals, {name: trace.units[name] for name in names}, trace.origin)


def changed(trace: Trace, **signals: np.ndarray) -> Trace:
    """The recording with other values of some signals."""
    return trace.with_signals(signals, {})
