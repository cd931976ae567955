"""Rigs of other people's axes, and the error measures of the publications they come from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.signal

from bench.assets import asset
from bench.rig.rig import load_rig
from bench.trace.read import read
from tests.shared import SHARED

DATA = SHARED / "data"

EMPS, LAAS, XL330 = (load_rig(asset("data", "rigs", f"{name}.toml")) for name in ("emps", "laas", "bam_xl330"))


def emps(name):
    """A recording of the EMPS benchmark."""
    return read(DATA / "emps" / name, EMPS.trace.columns)


@dataclass(frozen=True)
class Published:
    """A recording as the authors of EMPS condition it (IDIM-LS of their benchmark files).

    Position through a Butterworth filter of order 4 at 100 Hz, forwards and backwards; derivatives by central
    differences; the first 49 samples left out; every column and the force decimated by 10 through a Chebyshev filter
    of order 8 and 0.05 dB, forwards and backwards, as the decimation of their numerical tool has it.
    """

    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    force: np.ndarray

    @classmethod
    def of(cls, trace):
        """The raw columns at 1 kHz."""
        filtered = _both_ways(scipy.signal.butter(4, 0.2), trace["position"])
        velocity = _central(filtered)
        columns = (filtered, velocity, _central(velocity), EMPS.effort(trace)[0])
        return cls(*(column[49:] for column in columns))

    def relative_error(self, model):
        """norm(measured - modelled)/norm(measured) of the decimated force; `model` takes position, velocity, ..."""
        modelled = decimated(model(self.position, self.velocity, self.acceleration))
        measured = decimated(self.force)
        return np.linalg.norm(measured - modelled) / np.linalg.norm(measured)


def _both_ways(coefficients, values):
    b, a = coefficients
    return scipy.signal.filtfilt(b, a, values, padlen=3 * (max(len(a), len(b)) - 1))


def _central(values):
    slope = np.gradient(values, 1e-3)
    slope[0], slope[-1] = slope[1], slope[-2]
    return slope


def decimated(values, factor=10):
    """Every tenth value of the filtered ones, the last one among them."""
    smooth = _both_ways(scipy.signal.cheby1(8, 0.05, 0.8 / factor), values)
    return smooth[(values.size - 1) % factor :: factor]


def rigid(mass, viscous, coulomb, offset):
    """Force of the plain model."""
    return lambda q, v, a: mass * a + viscous * v + coulomb * np.sign(v) + offset


def rigid_by_direction(mass, forward, backward):
    """Force of a model with viscous and Coulomb friction for each direction."""
    return lambda q, v, a: mass * a + np.where(v > 0.0, forward[0] * v + forward[1], backward[0] * v - backward[1])


def diagnosed_force(found):
    """Force of what a diagnosis of EMPS found, by the equations of its effects."""
    values = {effect.name: {key: p.value for key, p in effect.parameters.items()} for effect in found.effects}
    base = [parameter.value for parameter in list(found.parameters.values())[:3]]
    direction = values["direction_dependent_friction"]
    cogging = values.get("cogging_torque", {"amplitude": 0.0, "harmonic": 0.0, "phase": 0.0})

    def force(q, v, a):
        asymmetric = 0.5 * direction["coulomb_difference"] + 0.5 * direction["viscous_difference"] * np.abs(v)
        periodic = cogging["amplitude"] * np.sin(cogging["harmonic"] * q + cogging["phase"])
        mass, viscous, coulomb = base
        return rigid(mass, viscous, coulomb, 0.0)(q, v, a) + asymmetric + periodic

    return force


def holding_currents(harmonics):
    """Amplitudes of the cogging of the LAAS motor from the currents that held it at rest over a revolution - A.

    Friction holds too: forward and backward approach differ by a constant each.
    """
    table = np.loadtxt(DATA / "laas_anticogging/stopped_data.txt", delimiter=",", skiprows=2)
    position, current = table[:, 1], table[:, 3]
    forward = np.arange(position.size) < int(np.argmax(position))
    waves = [wave(n * position) for n in harmonics for wave in (np.sin, np.cos)]
    theta = np.linalg.lstsq(np.column_stack([forward, ~forward, *waves]).astype(float), current, rcond=None)[0]
    return {n: float(np.hypot(*theta[2 + 2 * k : 4 + 2 * k])) for k, n in enumerate(harmonics)}
