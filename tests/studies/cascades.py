"""Drives with a cascade of known gains, integrated without MuJoCo and without the code under test; what `bench.servo`
finds of them where the torque is recorded.

Each drive is a motor with viscous and dry friction that stops and sticks. The controller runs at 1 or 4 kHz on the
counts of its encoder, takes its speed from their differences, holds its torque over a tick and its integral while the
torque is at its limit. The log holds reference, counts, that speed and the torque, with noise, at 1 kHz.

    python -m tests.studies.cascades --count 20 --seed 1

prints a line for each drive and, at the end, how often intervals cover the truth, and median errors.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import dataclass

import numpy as np

import bench
from bench.trace.trace import Trace

#: Integration steps of a tick.
STEPS = 4
#: Rate of the logs - Hz.
RATE = 1000.0
UNITS = {"position": "rad", "velocity": "rad/s", "torque": "N*m"}
UNITS |= {"position_reference": "rad", "velocity_reference": "rad/s"}


@dataclass(frozen=True)
class Cascade:
    """A drive: SI units of a rotary axis; `velocity_feedforward`: share of the reference's speed in the demand."""

    position_gain: float = 40.0
    velocity_gain: float = 0.5
    reset_time: float = 0.01
    velocity_feedforward: float = 1.0
    inertia_feedforward: float = 0.0
    limit: float = math.inf
    inertia: float = 2e-3
    viscous: float = 1e-3
    coulomb: float = 0.05
    tick: float = 250e-6
    bits: int = 17
    noise: float = 0.005

    @property
    def integral_gain(self) -> float:
        """Torque per integrated speed error - N*m/rad."""
        return self.velocity_gain / self.reset_time

    @property
    def truth(self) -> dict[str, float]:
        """By the names of `bench.servo`."""
        stiffness = self.velocity_gain * self.position_gain + self.integral_gain
        names = "position_gain", "velocity_gain", "integral_gain", "velocity_feedforward", "inertia_feedforward"
        found = {name: float(getattr(self, name)) for name in names}
        return {**found, "kp": stiffness, "kv": self.velocity_gain, "ki": self.integral_gain * self.position_gain}


def reference(rng: np.random.Generator, tick: float, seconds: float, speed: float) -> np.ndarray:
    """Position, speed and acceleration (3, ticks): waves, and moves from point to point with rests between them."""
    t = np.arange(0.0, seconds, tick)
    found, half = np.zeros(t.size), 0.5 * seconds
    for f in rng.uniform(0.3, 4.0, 4):
        found += 0.4 * speed * rng.uniform(0.3, 1.0) * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 2.0 * np.pi))
    found *= np.sin(np.pi * np.clip(t / half, 0.0, 1.0)) ** 0.5 * np.clip(t / 0.2, 0.0, 1.0) ** 2
    at = half + 0.1
    while at < seconds - 0.6:
        length = rng.uniform(0.15, 0.5)
        found += (
            0.5 * speed * rng.uniform(-1.0, 1.0) * (1.0 - np.cos(2.0 * np.pi * np.clip((t - at) / length, 0.0, 1.0)))
        )
        at += length + rng.uniform(0.02, 0.2)
    position = np.concatenate([[0.0], np.cumsum(0.5 * tick * (found[1:] + found[:-1]))])
    return np.stack([position, found, np.gradient(found, tick)])


def motion(drive: Cascade, along: np.ndarray) -> np.ndarray:
    """Counts, the drive's speed, torque (3, ticks) along a reference (3, ticks)."""
    step, h = 2.0 * math.pi / 2**drive.bits, drive.tick / STEPS
    q, w, integral = along[0, 0], along[1, 0], 0.0
    last = round(q / step) * step - w * drive.tick
    found = np.empty((3, along.shape[1]))
    gain, each = drive.velocity_gain, drive.integral_gain * drive.tick
    for k, (to, speed, acceleration) in enumerate(along.T.tolist()):
        counts = round(q / step) * step
        rate, last = (counts - last) / drive.tick, counts
        error = drive.velocity_feedforward * speed + drive.position_gain * (to - counts) - rate
        wanted = (gain + 0.5 * each) * error + integral + drive.inertia_feedforward * acceleration
        torque = min(max(wanted, -drive.limit), drive.limit)
        if torque == wanted:
            integral += each * error
        found[:, k] = counts, rate, torque
        for _ in range(STEPS):
            q, w = moved(q, w, torque, drive, h)
    return found


def moved(q: float, w: float, torque: float, drive: Cascade, h: float) -> tuple[float, float]:
    """Position and speed a step later; friction opposes, stops or keeps."""
    if w == 0.0 and abs(torque) <= drive.coulomb:
        return q, 0.0
    side = math.copysign(drive.coulomb, torque if w == 0.0 else w)
    half = 0.5 * h * drive.viscous / drive.inertia
    speed = (w * (1.0 - half) + h * (torque - side) / drive.inertia) / (1.0 + half)
    if speed * w < 0.0:
        return q + 0.5 * h * w * w / (w - speed), 0.0
    return q + 0.5 * h * (w + speed), speed


def log(
    drive: Cascade, rng: np.random.Generator, seconds: float = 12.0, speed: float = 30.0, without: tuple[str, ...] = ()
) -> Trace:
    """A recording of a drive at 1 kHz, without some of its signals."""
    along = reference(rng, drive.tick, seconds, speed)
    every = max(1, round(1.0 / (RATE * drive.tick)))
    counts, rate, torque = motion(drive, along)[:, ::every]
    signals = {
        "time": np.arange(counts.size) * every * drive.tick,
        "position": counts,
        "velocity": rate,
        "torque": torque + drive.noise * rng.standard_normal(counts.size),
        "position_reference": along[0, ::every],
        "velocity_reference": along[1, ::every],
    }
    kept = {name: values for name, values in signals.items() if name not in without}
    return Trace.from_arrays(kept, {"time": "s", **{name: UNITS[name] for name in kept if name != "time"}})


def cascade_of(rng: np.random.Generator) -> Cascade:
    """A drive drawn at random."""
    inertia, tick = float(np.exp(rng.uniform(np.log(1e-4), np.log(1e-2)))), float(rng.choice([250e-6, 1e-3]))
    bandwidth = float(rng.uniform(150.0, 500.0)) * (1.0 if tick < 1e-3 else 0.6)
    peak = inertia * 30.0 * 2.0 * np.pi * 4.0
    return Cascade(
        position_gain=bandwidth * float(rng.uniform(0.08, 0.25)),
        velocity_gain=inertia * bandwidth,
        reset_time=float(rng.uniform(3.0, 12.0)) / bandwidth,
        velocity_feedforward=float(rng.choice([0.0, 0.5, 0.8, 1.0, 1.0])),
        inertia_feedforward=inertia * float(rng.choice([0.0, 0.9])),
        limit=peak * float(rng.uniform(0.4, 0.7)) if rng.random() < 0.4 else math.inf,
        inertia=inertia,
        viscous=inertia * float(rng.uniform(0.2, 2.0)),
        coulomb=peak * float(rng.uniform(0.02, 0.08)),
        tick=tick,
        bits=int(rng.integers(16, 22)),
        noise=peak * float(rng.uniform(0.001, 0.01)),
    )


def judged(drive: Cascade, recording: Trace) -> dict[str, tuple[float, float, bool]]:
    """By quantity the relative error, the half width as a share of the truth, and whether the interval covers it."""
    found, result = bench.servo(recording).parameters, {}
    for name, truth in drive.truth.items():
        if name in found and truth:
            low, high = found[name].ci95
            half = found[name].half_width / truth
            result[name] = (found[name].value / truth - 1.0, half, low <= truth <= high)
    return result


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--without", nargs="*", default=[], help="signals that the logs lack, such as velocity")
    options = parser.parse_args()
    every: dict[str, list[tuple[float, float, bool]]] = {}
    for k in range(options.count):
        rng = np.random.default_rng([options.seed, k])
        drive = cascade_of(rng)
        recording, begun = log(drive, rng, without=tuple(options.without)), time.process_time()
        result = judged(drive, recording)
        text = ", ".join(
            f"{name} {error:+.2%} ± {half:.2%}{'' if kept else ' *'}" for name, (error, half, kept) in result.items()
        )
        print(f"{k}: {time.process_time() - begun:.2f} s, {text}", flush=True)
        for name, one in result.items():
            every.setdefault(name, []).append(one)
    for name, found in every.items():
        error = np.median([abs(one[0]) for one in found])
        print(f"{name}: covered {sum(one[2] for one in found)} of {len(found)}, median error {error:.2%}")
    kept = [one[2] for found in every.values() for one in found]
    print(f"all: covered {sum(kept)} of {len(kept)}, {np.mean(kept):.1%}")


if __name__ == "__main__":
    main()
