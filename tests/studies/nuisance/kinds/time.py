"""Samples that are lost, old, doubled, late, averaged, or stamped wrong."""

from __future__ import annotations

import numpy as np

from tests.studies.nuisance.nuisance import PERIOD, Nuisance
from tests.studies.nuisance.signals import FINE, Signals, sampled


class SamplesLost(Nuisance):
    """The scope drops samples and numbers the rest as if there were none missing."""

    strengths = (0.001, 0.005)
    unit = "of samples"
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        # a few at least, or some short recordings would lose none
        lost = rng.choice(signals.time.size, max(round(strength * signals.time.size), 3), replace=False)
        return signals.rows(np.delete(np.arange(signals.time.size), lost)).renumbered()


class SamplesLostWithoutPosition(SamplesLost):
    """The same where only speed and current are recorded: less shows it, and less is spoiled by it."""

    def in_file(self, signals, strength, axis, rng):
        kept = signals.without("position", "position_reference", "velocity_reference")
        return super().in_file(kept, strength, axis, rng)


class BlockLost(Nuisance):
    """The scope's buffer overruns once while the axis moves; stamps go on as if nothing had been."""

    strengths = (20.0, 100.0)
    unit = "samples"
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        middle = signals.time.size // 4 + int(np.argmax(np.abs(signals["velocity"][signals.time.size // 4 :])))
        rows = np.arange(signals.time.size)
        return signals.rows((rows < middle) | (rows >= middle + int(strength))).renumbered()


class SamplesStale(Nuisance):
    """A bus cycle now and then brings the values of the one before."""

    strengths = (0.01, 0.05)
    unit = "of samples"
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        rows = np.arange(signals.time.size)
        stale = rng.random(rows.size) < strength
        stale[0] = False
        source = np.maximum.accumulate(np.where(stale, 0, rows))
        return signals.rows(source).stamped(signals.time)


class SamplesDoubled(Nuisance):
    """Some rows are written twice, stamps and all."""

    strengths = (0.01, 0.05)
    unit = "of samples"

    def in_file(self, signals, strength, axis, rng):
        return signals.rows(_doubled(signals, strength, rng))


class SamplesDoubledRenumbered(SamplesDoubled):
    """Some rows are written twice and all numbered on."""

    strengths = (0.001, 0.005)
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        return super().in_file(signals, strength, axis, rng).renumbered()


def _doubled(signals: Signals, share: float, rng: np.random.Generator) -> np.ndarray:
    twice = rng.choice(signals.time.size, max(round(share * signals.time.size), 3), replace=False)
    return np.sort(np.concatenate([np.arange(signals.time.size), twice]))


class Jitter(Nuisance):
    """A computer that polls the drive stamps each sample with its own, irregular time."""

    strengths = (0.05, 0.2)
    unit = "of a period"

    def sampled(self, fine, strength, rng):
        time = sampled(fine, PERIOD).time
        return fine.at(time + PERIOD * strength * rng.uniform(-1.0, 1.0, time.size) * (time > 0.0))


class JitterNotStamped(Jitter):
    """It samples irregularly and stamps regularly."""

    strengths = (0.05, 0.2)
    refusal_is_right = True
    remainder_is_right = True

    def sampled(self, fine, strength, rng):
        return super().sampled(fine, strength, rng).stamped(sampled(fine, PERIOD).time)


class SlowSampling(Nuisance):
    """A controller's cycle instead of a scope."""

    strengths = (2.0, 4.0)
    unit = "ms"

    def sampled(self, fine, strength, rng):
        return sampled(fine, strength * 1e-3)


class VerySlowSampling(SlowSampling):
    """A logger that the motion is too fast for."""

    strengths = (8.0, 100.0)
    refusal_is_right = True


class Averaged(Nuisance):
    """The recorder averages speed and current over each sample."""

    strengths = (1.0, 4.0)
    unit = "ms"

    def sampled(self, fine, strength, rng):
        many = round(strength * 1e-3 / FINE)
        total = {name: np.cumsum(np.pad(fine[name], (many, 0), "edge")) for name in ("velocity", "current")}
        means = {name: (sums[many:] - sums[:-many]) / many for name, sums in total.items()}
        return sampled(fine.but(**means), strength * 1e-3)


class TimeUnit(Nuisance):
    """Milliseconds read as seconds, or seconds as milliseconds."""

    strengths = (1e-3, 1e3)
    unit = "times"
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        return signals.stamped(strength * signals.time)


class Holes(Nuisance):
    """Transmission breaks off for some samples; stamps are right."""

    strengths = (10.0, 30.0)
    unit = "holes"

    def in_file(self, signals, strength, axis, rng):
        starts = rng.choice(signals.time.size - 10, int(strength), replace=False)
        gone = (starts[:, None] + np.arange(6)).ravel()
        return signals.rows(np.delete(np.arange(signals.time.size), gone))


class ManyHoles(Nuisance):
    """The same until hardly two samples in a row are left."""

    strengths = (270.0, 1000.0)
    unit = "holes"
    refusal_is_right = True

    def in_file(self, signals, strength, axis, rng):
        starts = rng.choice(signals.time.size - 10, int(strength), replace=False)
        gone = (starts[:, None] + np.arange(3)).ravel()
        return signals.rows(np.delete(np.arange(signals.time.size), gone))


class Frozen(Nuisance):
    """The channel of current or speed hangs for a third of a second."""

    strengths = ("current", "velocity")
    refusal_is_right = True
    remainder_is_right = True

    def in_file(self, signals, strength, axis, rng):
        values = signals[strength].copy()
        start = int(np.argmax(np.abs(signals["velocity"])))
        values[start : start + 330] = values[start]
        return signals.but(**{strength: values})
