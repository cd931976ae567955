"""Load of the axis: theoretical moment of inertia of the disk from its geometry, and what a gear reflects."""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from bench.arrays import Array
from bench.axis_kind import AxisKind
from bench.rig import values
from bench.rig.values import RigTable

#: Standard acceleration of free fall - m/s**2. ISO 80000-3: g_n.
STANDARD_GRAVITY = 9.80665


class Load(RigTable):
    """A flat disk or ring on the shaft, and the gear between it and the motor.

    Attributes:
        outer_diameter, inner_diameter, thickness: geometry of the disk - m.
        density: of its material - kg/m**3; or `mass`: of the whole disk - kg. One of the two.
        gear_ratio: motor turns per turn of the load; 1 without a gear.
        gear_inertia: moment of inertia of the gear, on the motor's side - kg*m**2.
        stroke: of a linear axis, from one end to the other; planned motions stay within it - m.
        eccentric_mass: of a pendulum on the load's shaft, known to pull by gravity - kg; with it `eccentric_radius`,
            of its centre from the shaft - m, and `hanging_position`, the load's angle at which it hangs - rad.
        link_inertia: part of the inertia that a robot's own model has, on the load's side - kg*m**2.
        behind_rotor: whether the torque is measured on the load's side, so that the motor's inertia is not in it.
    """

    outer_diameter: values.Length | None = None
    inner_diameter: values.Length | None = None
    thickness: values.Length | None = None
    density: values.Density | None = None
    mass: values.Mass | None = None
    gear_ratio: Annotated[float, Field(gt=0.0)] = 1.0
    gear_inertia: values.Inertia | None = None
    stroke: values.Length | None = None
    eccentric_mass: values.Mass | None = None
    eccentric_radius: values.Length | None = None
    hanging_position: values.Angle = 0.0
    link_inertia: values.Inertia | None = None
    behind_rotor: Annotated[bool, Field(exclude=True)] = False

    @model_validator(mode="after")
    def _one_disk(self) -> Load:
        if self.outer_diameter is not None:
            if (self.mass is None) == (self.density is None):
                raise ValueError("a disk takes either mass or density, and density takes thickness")
            if self.mass is None and self.thickness is None:
                raise ValueError("a disk given by its density needs its thickness")
            if self.inner_diameter is not None and self.inner_diameter >= self.outer_diameter:
                raise ValueError("inner_diameter must be smaller than outer_diameter")
        if (self.eccentric_mass is None) != (self.eccentric_radius is None):
            raise ValueError("eccentric_mass and eccentric_radius go together")
        return self

    @property
    def disk_mass(self) -> float | None:
        """m = rho*pi/4*(D**2 - d**2)*h - kg; None without geometry."""
        if self.mass is not None or self.outer_diameter is None:
            return self.mass
        assert self.density is not None and self.thickness is not None
        area = math.pi / 4.0 * (self.outer_diameter**2 - (self.inner_diameter or 0.0) ** 2)
        return self.density * area * self.thickness

    @property
    def disk_inertia(self) -> float | None:
        """J = m/8*(D**2 + d**2) about the shaft - kg*m**2; None without geometry."""
        mass = self.disk_mass
        if mass is None or self.outer_diameter is None:
            return None
        return mass / 8.0 * (self.outer_diameter**2 + (self.inner_diameter or 0.0) ** 2)

    def disk(self, kind: AxisKind) -> float:
        """What the disk adds to the inertia of an axis of a kind, on the load's side - kg*m**2 (kg); 0 without one."""
        return (self.disk_inertia if kind.turns else self.disk_mass) or 0.0

    def gravity_torque(self, position: Array) -> Array:
        """M_load = m*g*r*sin(q/i - q_0)/i - N*m - of an eccentric mass at the motor, at its angles q - rad - (n,)."""
        assert self.eccentric_mass is not None and self.eccentric_radius is not None
        moment = self.eccentric_mass * STANDARD_GRAVITY * self.eccentric_radius
        return moment * np.sin(position / self.gear_ratio - self.hanging_position) / self.gear_ratio

    def reflected(self, inertia: float) -> float:
        """Inertia on the load's side as the motor feels it, J/i**2 - kg*m**2."""
        return inertia / self.gear_ratio**2
