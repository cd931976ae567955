"""A servo axis as nature made it: its true mechanics and motor, and the drive that moves it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T", bound=Any)


@dataclass(frozen=True)
class Axis:
    """True values of one axis, SI (a linear axis: kg for kg*m**2, N for N*m, m for rad).

    M = J*alpha + K_w*w + K_0*sgn(w) + M_load.

    Attributes:
        inertia, viscous, coulomb: J - kg*m**2, K_w - N*m*s/rad, K_0 - N*m.
        rotor_inertia: the motor's share of J - kg*m**2; a coupling separates it from the rest.
        torque_constant, peak_current: of the motor - N*m/A, A.
        resistance, inductance, back_emf_constant: of the winding - ohm, H, V*s/rad; the last 0 where it is not known.
        position_gain, velocity_gain, integral_gain, inertia_feedforward, control_period: of the drive, as the rig file
            names them - 1/s, N*m*s/rad, N*m/rad, kg*m**2, s.
        top_speed: the axis is meant for - rad/s.
    """

    name: str
    inertia: float
    viscous: float
    coulomb: float
    rotor_inertia: float
    torque_constant: float
    peak_current: float
    resistance: float = 4.0
    inductance: float = 8e-3
    back_emf_constant: float = 0.5
    position_gain: float = 30.0
    velocity_gain: float = 0.2
    integral_gain: float = 4.0
    inertia_feedforward: float = 1e-3
    control_period: float = 250e-6
    top_speed: float = 150.0
    linear: bool = False

    @property
    def peak_torque(self) -> float:
        """Of the motor - N*m."""
        return self.torque_constant * self.peak_current

    @property
    def torque_scale(self) -> float:
        """What counts as a considerable disturbance on this axis: 4 % of peak torque - N*m."""
        return 0.04 * self.peak_torque


def stack(ones: Sequence[T]) -> T:
    """One object for many side by side: same dataclass, its numbers as arrays - (n,)."""
    names = [each.name for each in fields(ones[0]) if not isinstance(getattr(ones[0], each.name), str)]
    return replace(ones[0], **{name: np.array([getattr(one, name) for one in ones], dtype=float) for name in names})


def random_rig(rng: np.random.Generator, name: str = "axis", *, linear: bool = False) -> Axis:
    """An axis drawn at random: J over two decades, any kT, friction 0.8 to 3 % of peak torque, drive of 10 to 50 Hz."""

    def spread(low: float, high: float) -> float:
        return float(np.exp(rng.uniform(np.log(low), np.log(high))))

    inertia = spread(5.0, 150.0) if linear else spread(1e-4, 1e-2)
    peak_acceleration = spread(8.0, 30.0) if linear else spread(900.0, 3500.0)
    top_speed = spread(0.4, 1.5) if linear else spread(60.0, 260.0)
    torque_constant = spread(20.0, 120.0) if linear else spread(0.2, 2.0)
    peak_current = inertia * peak_acceleration / torque_constant
    coulomb = spread(0.008, 0.03) * inertia * peak_acceleration
    back_emf = torque_constant
    top_voltage = back_emf * top_speed
    resistance = spread(0.1, 0.3) * top_voltage / peak_current
    bandwidth = 2.0 * np.pi * spread(10.0, 50.0)
    velocity_gain = inertia * bandwidth
    return Axis(
        name=name,
        inertia=inertia,
        viscous=spread(0.3, 2.0) * coulomb / top_speed,
        coulomb=coulomb,
        rotor_inertia=rng.uniform(0.2, 0.6) * inertia,
        torque_constant=torque_constant,
        peak_current=peak_current,
        resistance=resistance,
        inductance=resistance * spread(1e-3, 4e-3),
        back_emf_constant=back_emf,
        position_gain=bandwidth * rng.uniform(0.12, 0.25),
        velocity_gain=velocity_gain,
        integral_gain=velocity_gain * bandwidth * rng.uniform(0.08, 0.22),
        inertia_feedforward=inertia * rng.uniform(0.85, 1.0),
        control_period=float(rng.choice([62.5e-6, 125e-6, 250e-6])),
        top_speed=top_speed,
        linear=linear,
    )


def write_rig(axis: Axis, path: str | Path) -> None:
    """Rig file of what a user would know about the axis; its friction and total inertia are not in it."""
    Path(path).write_text(rig_text(axis), encoding="utf-8")


def rig_text(axis: Axis) -> str:
    """The same as text."""
    kind, length, mass, effort = ("linear", "m", "kg", "N") if axis.linear else ("rotary", "rad", "kg*m**2", "N*m")
    inertia, constant = ("moving_mass", "force_constant") if axis.linear else ("rotor_inertia", "torque_constant")
    return f'''name = "{axis.name}"
kind = "{kind}"

[motor]
{inertia} = "{axis.rotor_inertia:.8g} {mass}"
{constant} = "{axis.torque_constant:.8g} {effort}/A"
peak_current = "{axis.peak_current:.8g} A"
resistance = "{axis.resistance:.8g} ohm"
inductance = "{axis.inductance:.8g} H"
back_emf_constant = "{axis.back_emf_constant:.8g} V*s/{length}"

[drive]
position_gain = "{axis.position_gain:.8g} 1/s"
velocity_gain = "{axis.velocity_gain:.8g} {effort}*s/{length}"
integral_gain = "{axis.integral_gain:.8g} {effort}/{length}"
inertia_feedforward = "{axis.inertia_feedforward:.8g} {mass}"
control_period = "{axis.control_period * 1e6:.8g} us"
'''
