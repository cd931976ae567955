"""`bench plan`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import RigOption, list_files, printed, say
from bench.files import write_text


def plan(
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="CSV of the motion, for a controller.")],
    wanted: Annotated[
        str | None, typer.Option("--for", help="NAME:key=value,... of an effect that is to be told; see bench effects.")
    ] = None,
    period: Annotated[float, typer.Option("--period", help="Between rows of the CSV in ms.", min=1e-3)] = 1.0,
) -> None:
    """Plan the motion to record inside the rig's limits: the one that tells best, and how well it will."""
    from bench.effects.present import parse_effect
    from bench.export.feedforward import DriveUnits
    from bench.export.plan import motions
    from bench.report.drive import others_line, plan_table
    from bench.report.terminal import progress
    from bench.rig.rig import load_rig, require

    axis = load_rig(rig)
    require(axis, "plan")
    units = DriveUnits.of(axis)
    effect = None if wanted is None else parse_effect(wanted, axis.axis_kind)
    with progress(f"planning for {axis.name}"):
        found = motions(axis, effect)
    best = found[0]
    counted = ((unit.text, unit.factor) for unit in (units.position, units.velocity))
    write_text(out, best.motion.csv(period * 1e-3, *counted))
    printed(plan_table(best))
    say(others_line(found))
    list_files([out])
