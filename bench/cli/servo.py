"""`bench servo`: gains, dead time and limits of a position-controlled servo."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from typer import Argument, Option

import bench
from bench.cli import common
from bench.errors import InputError
from bench.names import in_a_row, readable


def servo(
    logs: Annotated[list[Path], Argument(metavar="LOG", help="Logs with goal and measured position.")],
    rig: common.OptionalRigOption = None,
    mjcf: common.MjcfOption = None,
    joint: common.JointOption = None,
    at: common.AtOption = None,
    stand: common.StandOption = False,
    holdout: Annotated[Path | None, Option(help="Another log of the servo, not fitted.")] = None,
    out: Annotated[Path | None, Option(help="Folder for actuator, page and JSON.")] = None,
    json: common.JsonOption = None,
    axis_name: common.AxisOption = None,
) -> None:
    """Identify gains, dead time, limit and friction of a position servo from goal and position; torque is optional."""
    from bench.report.parts import provenance
    from bench.report.servo import SCHEMA, servo_json
    from bench.report.servo import servo as document_of
    from bench.report.terminal import progress

    if len(joint or []) > 1:
        raise InputError("--joint", f"found {', '.join(joint or [])}", "allowed: one; run the command for each")
    alone = next((name for name, one in (("--joint", joint), ("--at", at), ("--stand", stand)) if one), None)
    if mjcf is None and alone is not None:
        raise InputError(alone, "found without --mjcf", "allowed: with --mjcf")
    known = None if rig is None else bench.load_rig(rig).on_axis(axis_name)
    stated: dict[str, float] = {}
    if mjcf is not None and at:
        from bench.plant.robot import joint_units

        stated = common.positions(at, joint_units(mjcf))
    names, named = in_a_row(logs), next(iter(joint or []), None)
    with common.refusal_as_json(json, SCHEMA, ("kp", "kv")), progress(f"fitting the servo of {names}") as done:
        found = bench.servo(logs, known, mjcf, named, holdout, stated, done, stand)
    options = {"joint": named, "at": at or [], "axis": axis_name, "stand": stand}
    basis = provenance(rig, logs, options, holdout, mjcf)
    title = f"{readable(known.name) if known is not None else found.joint}: {names}"
    common.deliver(document_of(found, title, basis), lambda: servo_json(found, basis), json, out)
