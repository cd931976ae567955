"""Servos of known gains, integrated without MuJoCo and without the code under test; what `bench.servo` finds of them.

Each servo is a motor with friction that stops and sticks, and in a quarter of them a load behind a play with the
encoder on the load. Its controller runs at 5 to 20 kHz on the encoder's counts and receives the goal late; the log
holds goal and counts at 50 to 500 Hz. A controller that holds its torque over a period T acts T/2 late: it loses kp*T/2
of its kv and kv*T/2 of the inertia, and its dead time is T/2 longer. `Truth.effective` is the controller without a
period that moves alike, to first order.

    python -m tests.studies.servos --count 40 --seed 1

prints a line for each servo and, at the end, how often intervals cover the truth, median errors, and the free-running
error on motion that was not fitted over that of the true servo. Servos whose residual is reported as unexplained are
counted apart: their intervals are not claimed.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import bench
from bench.errors import UndeterminedError
from bench.servos.model import NULL
from bench.servos.servo import free_run
from bench.trace.trace import Trace

#: Integration step - s.
STEP = 50e-6


@dataclass(frozen=True)
class Truth:
    """A servo: SI units of a rotary axis."""

    inertia: float = 2e-3
    kp: float = 3.0
    kv: float = 0.06
    viscous: float = 0.02
    coulomb: float = 0.01
    dead_time: float = 0.01
    limit: float = math.inf
    offset: float = 0.0
    gap: float = 0.0
    load_share: float = 0.1
    rate: float = 200.0
    bits: int = 12
    control_period: float = 100e-6

    @property
    def effective(self) -> dict[str, float]:
        """Per moment of inertia, of the controller without a period that moves as this one does."""
        late = 0.5 * self.control_period
        inertia = self.inertia - self.kv * late
        return {
            "kp": self.kp / inertia,
            "damping": (self.kv - self.kp * late + self.viscous) / inertia,
            "friction": self.coulomb / inertia,
            "dead_time": self.dead_time + late,
            "limit": self.limit / self.inertia,
        }


def motion(servo: Truth, goal: np.ndarray) -> np.ndarray:
    """Position in the log (n,) of a servo whose goal (n,) is held from sample to sample of the log."""
    period, h = 1.0 / servo.rate, STEP
    resolution = 2.0 * math.pi / 2**servo.bits
    tick = max(1, round(servo.control_period / h))
    share = servo.load_share if servo.gap > 0.0 else 0.0
    motor, load = (1.0 - share) * servo.inertia, share * servo.inertia
    slip = 0.15 * servo.coulomb if load else 0.0
    contact = motor * (2.0 * math.pi * 60.0) ** 2 * share
    damper = 0.6 * math.sqrt(contact * load) if load else 0.0
    q = y = float(goal[0])
    w = z = torque = 0.0
    out = np.empty(goal.size)
    logged, values, last = 0, goal.tolist(), q
    for step in range(round(goal.size * period / h) + 2):
        at = step * h
        while logged < goal.size and logged * period <= at + 1e-12:
            encoder = y if load else q
            sampled = encoder + (logged * period - at) / h * (encoder - last)
            out[logged] = round(sampled / resolution) * resolution
            logged += 1
        last = y if load else q
        if step % tick == 0:
            known = math.floor((at - servo.dead_time) / period + 1e-9)
            u = values[min(max(known, 0), goal.size - 1)]
            seen = round((y if load else q) / resolution) * resolution
            torque = min(max(servo.kp * (u - seen) - servo.kv * w, -servo.limit), servo.limit)
        push = 0.0
        if load:
            bend = q - y
            over = bend - min(max(bend, -0.5 * servo.gap), 0.5 * servo.gap)
            push = contact * over + (damper * (w - z) if over else 0.0)
            y, z = slid(y, z, push, 0.0, slip, load, h)
        q, w = slid(q, w, torque + servo.offset - push, servo.viscous, servo.coulomb - slip, motor, h)
    return out


def slid(
    q: float, w: float, torque: float, viscous: float, friction: float, inertia: float, h: float
) -> tuple[float, float]:
    """Position and speed after a step under a torque, with viscous friction and friction that stops, holds or opposes.

    By the trapezoidal rule in the viscous friction, which is exact in the constant torque.
    """
    if w == 0.0 and abs(torque) <= friction:
        return q, 0.0
    net, half = torque - math.copysign(friction, torque if w == 0.0 else w), 0.5 * h / inertia
    speed = (w * (1.0 - half * viscous) + 2.0 * half * net) / (1.0 + half * viscous)
    if speed * w < 0.0:
        return q + 0.5 * w * h * w / (w - speed), 0.0
    return q + 0.5 * (w + speed) * h, speed


def goals(rng: np.random.Generator, rate: float, seconds: float = 20.0, reach: float = 0.5) -> np.ndarray:
    """A goal (n,): waves of several frequencies, steps and ramps with rests, a chirp."""
    t = np.arange(0.0, seconds, 1.0 / rate)
    kind = np.minimum((4 * t / seconds).astype(int), 3)
    waves = sum(
        rng.uniform(0.3, 1.0) * np.sin(2 * np.pi * f * t + rng.uniform(0, 6.28)) for f in rng.uniform(0.2, 2.5, 4)
    )
    steps = np.interp(t, t[:: max(1, int(0.7 * rate))], rng.uniform(-1, 1, t[:: max(1, int(0.7 * rate))].size))
    held = rng.uniform(-1, 1, int(seconds / 0.8) + 1)[(t / 0.8).astype(int)]
    start = 0.75 * seconds
    chirp = np.sin(2 * np.pi * (0.3 * (t - start) + 0.5 * 3.0 / (0.25 * seconds) * (t - start) ** 2))
    return reach * np.choose(kind, [0.45 * waves, held, steps, 0.8 * chirp])


def servo_of(rng: np.random.Generator) -> Truth:
    """A servo drawn at random."""
    rate = float(np.exp(rng.uniform(np.log(50.0), np.log(500.0))))
    natural, damped = float(np.exp(rng.uniform(np.log(10.0), np.log(60.0)))), rng.uniform(0.35, 1.2)
    inertia = float(np.exp(rng.uniform(np.log(1e-4), np.log(1e-1))))
    kp, damping, share = inertia * natural**2, 2 * damped * natural * inertia, rng.uniform(0.1, 0.6)
    coulomb = kp * float(np.exp(rng.uniform(np.log(1e-3), np.log(1.5e-2))))
    limited, gap = rng.random() < 0.5, rng.random() < 0.25
    return Truth(
        inertia=inertia,
        kp=kp,
        kv=(1 - share) * damping,
        viscous=share * damping,
        coulomb=coulomb,
        dead_time=float(rng.uniform(0.0, 0.04)),
        limit=kp * rng.uniform(0.12, 0.4) if limited else math.inf,
        gap=math.radians(rng.uniform(0.3, 1.5)) if gap else 0.0,
        rate=rate,
        bits=int(rng.integers(10, 15)),
        control_period=float(rng.choice([50e-6, 100e-6, 200e-6])),
    )


def log(servo: Truth, rng: np.random.Generator, seconds: float = 20.0) -> Trace:
    """A recording of a servo."""
    goal = goals(rng, servo.rate, seconds)
    signals = {
        "time": np.arange(goal.size) / servo.rate,
        "position": motion(servo, goal),
        "position_reference": goal,
    }
    return Trace.from_arrays(signals, {"time": "s", "position": "rad", "position_reference": "rad"})


@dataclass(frozen=True)
class Found:
    """What a method finds of a servo.

    Attributes:
        verdict: of the method.
        values: of the servo that it simulates, parameters of `bench.servos.model.NULL`.
        quantities: as in `Truth.effective`: value and interval, which is not a number where the method has none.
    """

    verdict: str
    values: dict[str, float]
    quantities: dict[str, tuple[float, float, float]]


def by_bench(recording: Trace) -> Found:
    """What `bench.servo` finds."""
    found = bench.servo(recording)
    names = {
        "kp": "kp/moment_of_inertia",
        "damping": "(kv + viscous_friction_coefficient)/moment_of_inertia",
        "friction": "coulomb_friction_torque/moment_of_inertia",
        "limit": "force_limit/moment_of_inertia",
        "dead_time": "dead_time",
    }
    every = {**found.parameters, **found.found.inseparable}
    parts = ["kv/moment_of_inertia", "viscous_friction_coefficient/moment_of_inertia"]
    quantities = {key: (every[name].value, *every[name].ci95) for key, name in names.items() if name in every}
    if parts[0] in every:
        quantities["damping"] = (sum(every[one].value for one in parts), math.nan, math.nan)
    return Found(found.verdict, dict(found.values), quantities)


def judged(servo: Truth, rng: np.random.Generator, method: Callable[[Trace], Found] = by_bench) -> dict[str, object]:
    """What a method finds of a servo: verdict, CPU time, by quantity the error, the truth and whether the interval
    contains it, and the free-running error on another motion over that of the true servo."""
    recording, other, begun = log(servo, rng), log(servo, rng, 8.0), time.process_time()
    try:
        found = method(recording)
    except UndeterminedError as error:
        return {"refused": str(error)}
    truth = servo.effective
    result: dict[str, object] = {"verdict": found.verdict, "seconds": time.process_time() - begun}
    for key, (value, low, high) in found.quantities.items():
        result[key] = (value - truth[key], truth[key], None if math.isnan(high) else low <= truth[key] <= high)
    own = {"stiffness": truth["kp"], "damping": servo.viscous / servo.inertia, "friction": truth["friction"]}
    own |= {
        "drive_damping": truth["damping"] - own["damping"],
        "dead_time": truth["dead_time"],
        "limit": truth["limit"],
    }
    nothing = np.zeros(len(other))
    skipped = round(0.5 * servo.rate)
    errors = [
        np.sqrt(np.mean((other["position"] - free_run({**NULL, **one}, other, (nothing, nothing)))[skipped:] ** 2))
        for one in (found.values, own)
    ]
    result["held out"] = float(errors[0] / errors[1])
    return result


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    results = []
    for k in range(options.count):
        rng = np.random.default_rng([options.seed, k])
        servo = servo_of(rng)
        results.append((servo, judged(servo, rng)))
        print(k, "with a gap" if servo.gap else "", results[-1][1], flush=True)
    for title, chosen in (
        ("all", results),
        ("without a gap", [one for one in results if not one[0].gap]),
        ("residual is noise", [one for one in results if one[1].get("verdict") in ("nothing_missing", "explained")]),
    ):
        print(f"{title}: {len(chosen)}")
        for key in ("kp", "damping", "friction", "limit", "dead_time"):
            found = [one[key] for servo, one in chosen if key in one and math.isfinite(servo.effective[key])]
            covered = [one[2] for one in found if one[2] is not None]
            errors = [abs(one[0]) / (1.0 if key == "dead_time" else one[1]) for one in found]
            if found:
                unit = "s" if key == "dead_time" else "relative"
                print(f"  {key}: covered {sum(covered)} of {len(covered)}, median error {np.median(errors):.3g} {unit}")
        ratios = [one["held out"] for _, one in chosen if "held out" in one]
        if ratios:
            print(f"  held-out error over the true servo's: median {np.median(ratios):.3g}, largest {max(ratios):.3g}")


if __name__ == "__main__":
    main()
