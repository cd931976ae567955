"""Truth of a simulated axis and of its sensors. Only `bench simulate` reads it; identification never does."""

from __future__ import annotations

from typing import Literal

from bench.rig.values import (
    Coulomb,
    CurrentNoise,
    Effort,
    Inertia,
    Mass,
    Period,
    Resolution,
    RigTable,
    VelocityNoise,
    Viscous,
)


class Simulation(RigTable):
    """`[simulation]` of a rig file.

    Attributes:
        moment_of_inertia: of everything that moves, on the motor's side - kg*m**2; on a linear axis `moving_mass` - kg.
            Without it, rotor plus disk from its geometry, reflected through the gear.
        viscous_friction_coefficient: K_w - N*m*s/rad (N*s/m).
        coulomb_friction: K_0 - N*m (N).
        friction: `mechanics` puts it into the joint, `drive` lets the drive's software apply it as the lab does.
        load_torque: constant torque on the load (behind any gear) that resists positive motion - N*m (N).
        encoder_resolution: angle (length) of one count - rad (m); 0 is ideal.
        velocity_noise: standard deviation of the reported speed - rad/s (m/s).
        current_noise: standard deviation of the reported current - A.
        sample_period: of the recording - s.
        timestep: of the integration - s; the drive's control period if not given.
    """

    moment_of_inertia: Inertia | None = None
    moving_mass: Mass | None = None
    viscous_friction_coefficient: Viscous = 0.0
    coulomb_friction: Coulomb = 0.0
    friction: Literal["mechanics", "drive"] = "mechanics"
    load_torque: Effort = 0.0
    encoder_resolution: Resolution = 0.0
    velocity_noise: VelocityNoise = 0.0
    current_noise: CurrentNoise = 0.0
    sample_period: Period = 1e-3
    timestep: Period | None = None
