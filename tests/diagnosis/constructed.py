"""Recordings whose torque balance is exact by construction: an analytic motion, its torque, white noise on both."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import Probabilities, probabilities, weighed
from bench.diagnosis.recordings import fit_bare
from bench.diagnosis.search import Search, search
from bench.effects.catalogue import catalogue
from bench.fit.fit import Fit
from bench.fit.rows import Rows
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from tests.sines import sines as sum_of

RIG = Rig.of(
    {
        "name": "constructed",
        "kind": "rotary",
        "motor": {"torque_constant": "0.7 N*m/A", "rotor_inertia": "4 kg*cm**2", "peak_current": "6 A"},
    }
)
UNITS = {"position": "rad", "velocity": "rad/s", "current": "A"}
INERTIA, VISCOUS, COULOMB, CONSTANT = 1.5e-3, 8e-4, 0.08, 0.7
#: White noise of speed - rad/s -, torque - N*m - and angle - rad -, the last so coarse that none takes speed from it.
SPEED_NOISE, TORQUE_NOISE, ANGLE_NOISE = 0.03, 6e-3, 1e-4
#: Amplitude of the position - rad -, frequency - Hz - and phase of the sines that the motion is made of.
SINES = ((6.0, 0.43, 0.3), (1.6, 1.31, 1.1), (0.5, 2.9, 2.0), (0.12, 6.1, 0.0))


@dataclass(frozen=True)
class Motion:
    """Samples of a motion: s, rad, rad/s, rad/s**2, and the sign of the speed - (n,) each."""

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    sign: np.ndarray


#: A resisting torque along a motion - N*m - (n,).
Torque = Callable[[Motion], np.ndarray]


def moved(duration: float = 4.0, sines=SINES, drift: float = 0.0, period: float = 1e-3) -> Motion:
    """A sum of sines and a constant speed `drift` - rad/s."""
    time = np.arange(round(duration / period)) * period
    position, velocity, acceleration = sum_of(time, sines)
    velocity = velocity + drift
    return Motion(time, position + drift * time, velocity, acceleration, np.sign(velocity))


def base(motion: Motion) -> np.ndarray:
    """J*alpha + K_w*omega + K_0*sgn(omega)."""
    return INERTIA * motion.acceleration + VISCOUS * motion.velocity + COULOMB * motion.sign


def recorded(motion: Motion, *more: Torque, seed: int = 0, noise: float = 1.0, pick_up: Torque | None = None) -> Trace:
    """The motion with the torque that it takes, and `more`; `pick_up` is reported and does not act."""
    rng = np.random.default_rng(seed)
    torque = base(motion) + sum(each(motion) for each in more)
    torque = torque + (0.0 if pick_up is None else pick_up(motion))
    torque = torque + noise * TORQUE_NOISE * rng.normal(size=motion.time.size)
    signals = {
        "position": motion.position + noise * ANGLE_NOISE * rng.normal(size=motion.time.size),
        "velocity": motion.velocity + noise * SPEED_NOISE * rng.normal(size=motion.time.size),
        "current": torque / CONSTANT,
    }
    return Trace(motion.time, signals, UNITS, "constructed")


def bare(trace: Trace, rig: Rig = RIG) -> Fit:
    """What inertia and friction leave."""
    return fit_bare(Rows.of(trace, rig))


def wave(amplitude: float, number: float, phase: float = 0.0) -> Torque:
    """A wave of position."""
    return lambda motion: amplitude * np.sin(number * motion.position + phase)


def vibration(amplitude: float, frequency: float, phase: float = 0.4) -> Torque:
    """A wave of time, which no effect of the catalogue is."""
    return lambda motion: amplitude * np.sin(2.0 * np.pi * frequency * motion.time + phase)


def only_during(torque: float, start: float, stop: float) -> Torque:
    """A torque for a stretch of time - N*m, s."""
    return lambda motion: torque * ((motion.time >= start) & (motion.time < stop))


def offset(torque: float) -> Torque:
    """A constant torque."""
    return lambda motion: np.full_like(motion.time, torque)


def searched(policy: Policy, trace: Trace, effects: Sequence[str]) -> Search:
    """A search for effects that a policy may try."""
    return search(bare(trace), [catalogue()[name] for name in effects], policy)


def judged(found: Search, policy: Policy, holdout: Trace | None = None) -> Probabilities:
    """How likely the sets of names are that a search visited."""
    width = found.visited[0].rows.conditioning.filter.width
    other = None if holdout is None else Rows.of(replace(holdout, origin="holdout"), RIG, width=width)
    return probabilities(weighed(found.visited, other, policy), frozenset(), policy)


def likely(policy: Policy, trace: Trace, effects: Sequence[str], holdout: Trace | None = None) -> Probabilities:
    """How likely names are, of effects that a policy may try."""
    return judged(searched(policy, trace, effects), policy, holdout)


def named(found: Probabilities) -> tuple[str, ...]:
    """The likeliest names."""
    return found.fits[found.chosen].hypothesis.names


def names(policy: Policy, trace: Trace, effects: Sequence[str], holdout: Trace | None = None) -> tuple[str, ...]:
    """The likeliest names of effects that a policy may try."""
    return named(likely(policy, trace, effects, holdout))


def sought(policy: Policy, trace: Trace, effects: Sequence[str]) -> tuple[str, ...]:
    """Names that a search ends with, however likely an unknown effect is."""
    return searched(policy, trace, effects).last.hypothesis.names
