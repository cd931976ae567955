"""What a rig suffices for, and all that a command misses in it, told at once."""

from __future__ import annotations

from bench.errors import InputError
from bench.rig.rig import Rig


def lacking(rig: Rig) -> dict[str, tuple[str, ...]]:
    """Command -> keys that it needs and the rig does not give; none where the rig suffices."""
    motor, kind = rig.motor, rig.axis_kind
    constant, limit = motor.torque_per_ampere is not None, motor.peak_torque is not None
    inertia = rig.simulation is not None and getattr(rig.simulation, kind.inertia) is not None
    inertia = inertia or bool(motor.inertia) or (rig.load is not None and rig.load.disk(kind) > 0.0)
    simulate = {
        "drive (position_gain, velocity_gain)": rig.drive is not None,
        "simulation (a table; friction, noise and sensors of the simulated axis)": rig.simulation is not None,
        f"motor.{'torque' if kind.turns else 'force'}_constant (or the four datasheet values)": constant,
        "motor.peak_current (or peak_torque)": limit or (constant and motor.peak_current is not None),
        f"simulation.{kind.inertia} (or motor and load that give it)": inertia,
    }
    limits = {
        "motor.peak_torque": limit,
        "motor.continuous_stall_torque": motor.continuous_stall_torque is not None,
        "motor.peak_curves": bool(motor.peak_curves),
    }
    simulated = dict.fromkeys(("simulate", "validate", "plan"), simulate)
    needs: dict[str, dict[str, bool]] = {"identify": {}, "diagnose": {}, **simulated, "limits": limits}
    return {command: tuple(key for key, given in keys.items() if not given) for command, keys in needs.items()}


def without_constant(rig: Rig) -> str | None:
    """What a rig without a torque constant means for results; None where it has one."""
    if rig.motor.torque_per_ampere is not None:
        return None
    return f"of recorded currents, results stand in A instead of {rig.effort_unit}: the motor has no constant"


def require(rig: Rig, command: str) -> None:
    """InputError naming all keys that a command misses in a rig."""
    keys = lacking(rig)[command]
    if keys:
        needs = "this key" if len(keys) == 1 else "all of these keys"
        raise InputError(f"{rig.source}: {', '.join(keys)}", "missing", f"bench {command} needs {needs}")
