"""`bench plan`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bench.cli.common import RigOption, list_files, printed, say
from bench.files import write_text
from bench.names import words

if TYPE_CHECKING:
    from rich.table import Table

    from bench.export.plan import PlannedMotion


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
    from bench.export.drive_units import DriveUnits
    from bench.export.plan import motions
    from bench.report.terminal import progress
    from bench.rig.rig import load_rig
    from bench.rig.suffices import require

    axis = load_rig(rig)
    require(axis, "plan")
    units = DriveUnits.of(axis)
    effect = None if wanted is None else parse_effect(wanted, axis.axis_kind)
    with progress(f"planning for {axis.name}"):
        found = motions(axis, effect)
    best = found[0]
    counted = ((unit.text, unit.factor) for unit in (units.position, units.velocity))
    write_text(out, best.motion.csv(period * 1e-3, *counted))
    printed(_table(best))
    say(_others(found))
    list_files([out])


def _table(best: PlannedMotion) -> Table:
    from rich import box
    from rich.table import Table

    title = f"{best.profile}, {best.motion.time[-1]:.3g} s: what it will tell, and how well"
    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for name in ("quantity", "expected", "standard error", "unit"):
        table.add_column(name, justify="left" if name in ("quantity", "unit") else "right")
    for name, found in best.expected.items():
        table.add_row(words(name), f"{found.value:.4g}", f"{found.std_error:.2g}", found.unit)
    return table


def _others(found: list[PlannedMotion]) -> str:
    """How well the other profiles tell the same, in a line."""
    others = [f"{each.profile} {each.worst:.2%}" if not each.reason else f"{each.profile} nothing" for each in found]
    return f"largest standard error over its value: {', '.join(others)}"
