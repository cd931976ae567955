"""The axis of the lab: what its rig file says, and the values the simulated one is given."""

from __future__ import annotations

from bench.assets import asset
from bench.errors import InputError
from bench.rig.motor import TorqueConstant
from bench.rig.rig import Rig, load_rig


def lab_rig() -> Rig:
    """Rig of the simulated lab axis, `data/rigs/lab.toml`."""
    return load_rig(asset("data", "rigs", "lab.toml"))


def without_friction(rig: Rig) -> Rig:
    """The same simulated axis with neither viscous nor Coulomb friction."""
    return simulated_with(rig, viscous_friction_coefficient=0.0, coulomb_friction=0.0)


def simulated_with(rig: Rig, **truth: float | str) -> Rig:
    """The same axis with other true values, names as in `[simulation]`, SI."""
    if rig.simulation is None:
        raise InputError(f"{rig.source}: simulation", "missing", "a simulated axis needs a table [simulation]")
    return rig.model_copy(update={"simulation": rig.simulation.model_copy(update=truth)})


def torque_constant(rig: Rig) -> TorqueConstant:
    """kT(Iq) of a rig.

    Raises:
        InputError: the rig gives none.
    """
    constant = rig.motor.torque_per_ampere
    if constant is None:
        raise InputError(f"{rig.source}: motor", "found no torque constant", "give the four datasheet values")
    return constant


def rotor_inertia(rig: Rig) -> float:
    """J_motor - kg*m**2.

    Raises:
        InputError: the rig does not give it.
    """
    if rig.motor.rotor_inertia is None:
        raise InputError(f"{rig.source}: motor.rotor_inertia", "missing", "J_load = J - J_motor needs it")
    return rig.motor.rotor_inertia
