"""Recordings in closed form: sums of sines through M = J*alpha + K_w*omega + K_0*sgn(omega), sensors' noise added."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from bench.rig.rig import Rig
from bench.trace.trace import Trace

UNITS = {"velocity": "rad/s", "current": "A", "position": "rad"}
RIG = Rig.of(
    {"name": "closed form", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A", "rotor_inertia": "2 kg*cm**2"}}
)
NAMES = ("moment_of_inertia", "viscous_friction_coefficient", "coulomb_friction_torque")


@dataclass(frozen=True)
class Truth:
    inertia: float = 1.5e-3
    viscous: float = 8e-4
    coulomb: float = 0.06
    offset: float = 0.0

    @property
    def values(self):
        return self.inertia, self.viscous, self.coulomb


def recording(
    rng,
    truth=Truth(),
    duration=6.0,
    period=1e-3,
    torque_noise=0.01,
    velocity_noise=0.03,
    correlation=0.0,
    shift=0.0,
    speed=1.0,
    bias=0.0,
    position=False,
):
    """One recording; `correlation` of the torque noise from sample to sample, current reported `shift` s late."""
    time = np.arange(round(duration / period)) * period
    amplitude = speed * rng.uniform(20.0, 80.0, 4)[:, None]
    omega = 2.0 * np.pi * rng.uniform(0.3, 4.0, 4)[:, None]
    phase = rng.uniform(0.0, 2.0 * np.pi, 4)[:, None]

    def velocity(t):
        return bias + np.sum(amplitude * np.sin(omega * t + phase), axis=0)

    late = time - shift
    torque = truth.inertia * np.sum(amplitude * omega * np.cos(omega * late + phase), axis=0)
    torque += truth.viscous * velocity(late) + truth.coulomb * np.sign(velocity(late)) + truth.offset
    white = rng.normal(scale=torque_noise, size=time.size + 500)
    noise = lfilter([np.sqrt(1.0 - correlation**2)], [1.0, -correlation], white)[500:]
    signals = {
        "velocity": velocity(time) + rng.normal(scale=velocity_noise, size=time.size),
        "current": (torque + noise) / 0.8,
    }
    if position:
        signals["position"] = bias * time - np.sum(amplitude / omega * np.cos(omega * time + phase), axis=0)
    return Trace(time, signals, UNITS, "closed form")
