"""What a rig suffices for, and all that a command misses in it, told at once."""

from __future__ import annotations

from bench.errors import InputError
from bench.rig.rig import Rig


def lacking(rig: Rig) -> dict[str, tuple[str, ...]]:
    """Command -> keys that it needs and the rig does not give; none where the rig suffices."""
    motor, kind = rig.motor, rig.axis_kind
    constant = ("torque_constant", "force_constant")[not kind.turns]
    no_constant = () if motor.torque_per_ampere is not None else (f"motor.{constant} (or the four datasheet values)",)
    no_limit = () if motor.peak_torque is not None else ("motor.peak_current (or peak_torque)",)
    if motor.peak_current is not None and not no_constant:
        no_limit = ()
    disk = rig.load is not None and rig.load.disk(kind) > 0.0
    own = rig.simulation is not None and getattr(rig.simulation, kind.inertia) is not None
    simulate = [
        *(("drive (position_gain, velocity_gain)",) if rig.drive is None else ()),
        *(
            ("simulation (a table; friction, noise and sensors of the simulated axis)",)
            if rig.simulation is None
            else ()
        ),
        *no_constant,
        *no_limit,
        *(() if own or disk or motor.inertia else (f"simulation.{kind.inertia} (or motor and load that give it)",)),
    ]
    limits = [
        f"motor.{name}" for name in ("peak_torque", "continuous_stall_torque") if getattr(motor, name) is None
    ] + ([] if motor.peak_curves else ["motor.peak_curves"])
    simulated = dict.fromkeys(("simulate", "validate", "plan"), tuple(simulate))
    return {"identify": (), "diagnose": (), **simulated, "limits": tuple(limits)}


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
