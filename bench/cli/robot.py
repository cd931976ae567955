"""What commands share that identify a joint inside the user's own MJCF."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bench.errors import InputError

if TYPE_CHECKING:
    from bench.rig.rig import Rig
    from bench.trace.trace import Trace

BesideRigOption = Annotated[
    Path | None, typer.Option("--rig", help="Rig file (TOML): what is known about the axis; not needed with --mjcf.")
]
MjcfOption = Annotated[
    Path | None, typer.Option("--mjcf", help="MJCF of the robot whose other dynamics are known, gravity among them.")
]
JointOption = Annotated[str | None, typer.Option("--joint", help="Joint of the MJCF that the log is of.")]
AtOption = Annotated[
    list[str] | None,
    typer.Option("--at", help="NAME=ANGLE of a joint that stands and that the log does not hold. Repeatable."),
]


@dataclass(frozen=True)
class Subject:
    """What a recording is of.

    Attributes:
        rig: of the axis.
        read: how its recordings are read whole.
        robot: whether it is a joint of one.
    """

    rig: Rig
    read: Callable[[Path], Trace]
    robot: bool

    @property
    def whole(self) -> Callable[[Path], Trace] | None:
        """How a recording has to be read at once, beside its robot; None where parts do."""
        return self.read if self.robot else None


def subject(
    rig: Path | None, axis: str | None, mjcf: Path | None, joint: str | None, at: Sequence[str] | None
) -> Subject:
    """The axis of a rig file, or the joint of an MJCF with or without one.

    Raises:
        InputError: neither is given, options that do not go together, or a file that cannot be read.
    """
    from bench.rig.rig import Rig, load_rig
    from bench.trace.read import read

    if mjcf is None:
        if joint is not None or at:
            raise InputError("--joint" if joint is not None else "--at", "found without --mjcf", "allowed: with --mjcf")
        if rig is None:
            raise InputError("--rig", "missing", "allowed: a rig file, or --mjcf and --joint")
        known = load_rig(rig).on_axis(axis)
        return Subject(known, lambda path: read(path, known.trace), robot=False)
    if joint is None:
        raise InputError("--joint", "missing", "allowed: the joint of the MJCF that the log is of")
    from bench.plant.robot import Robot, read_log, rig_within

    robot = Robot.of(mjcf, joint)
    alone = {"name": joint, "kind": "rotary" if robot.turns else "linear"}
    own = (Rig.of(alone, str(mjcf)) if rig is None else load_rig(rig)).on_axis(axis)
    if own.axis_kind.turns is not robot.turns:
        found = f"found a joint that {'turns' if robot.turns else 'slides'}"
        raise InputError(f"--joint {joint}", found, f"allowed: a {own.kind} one, as {own.source} says")
    within = rig_within(own, robot)
    stands = _positions(at or (), robot.units)
    return Subject(within, lambda path: read_log(path, within, robot, stands), robot=True)


def _positions(texts: Sequence[str], units: dict[str, str]) -> dict[str, float]:
    """Positions - rad (m) - of joints from `NAME=0.3 rad`; a number without unit is SI."""
    from bench.effects.present import parse_value

    found = {}
    for text in texts:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not sign or name not in units:
            allowed = f"allowed: NAME=ANGLE, NAME one of {', '.join(units) or 'none, as the robot has one joint'}"
            raise InputError(f"--at {text}", "names no other joint" if sign else "has no =", allowed)
        found[name] = parse_value(value, units[name], f"--at {text}")
    return found
