"""`bench export`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bench.cli.common import list_files, say
from bench.errors import InputError
from bench.files import write_text

if TYPE_CHECKING:
    from bench.export.mjcf import Carried
    from bench.plant.model_file import StoredModel

#: Name of the joint of a file that holds the joint alone, unless another is given.
ALONE = "axis"


def export(
    model: Annotated[Path, typer.Argument(help="model.toml that diagnose wrote.")],
    out: Annotated[Path, typer.Option("--out", help="File to write.")],
    mjcf: Annotated[Path | None, typer.Option("--mjcf", help="MJCF of the robot that has the joint.")] = None,
    joint: Annotated[str | None, typer.Option("--joint", help="Joint that the model goes onto.")] = None,
    snippet: Annotated[bool, typer.Option("--snippet", help="A default class and a body on this joint alone.")] = False,
    ranges: Annotated[
        Path | None, typer.Option("--ranges", help="JSON of identify or diagnose: ranges for domain randomisation.")
    ] = None,
    armature: Annotated[
        str | None, typer.Option("--armature", help="Inertia that becomes the joint's armature: motor, or all.")
    ] = None,
) -> None:
    """Put a diagnosed model into a robot's MJCF; or write its joint as an MJCF of its own, or ranges of its values."""
    from bench.plant.model_file import load_model

    if [snippet, mjcf is not None, ranges is not None].count(True) != 1:
        raise InputError("bench export", "found none or several of --mjcf, --snippet, --ranges", "allowed: one of them")
    stored = load_model(model)
    if ranges is not None:
        from bench.export.ranges import ranges_json

        write_text(out, ranges_json(stored, ranges))
    else:
        text, carried = _text(stored, out, mjcf, joint, armature)
        write_text(out, text)
        for line in carried.lines:
            say(line)
    list_files([out])


def _text(
    stored: StoredModel, out: Path, mjcf: Path | None, joint: str | None, armature: str | None
) -> tuple[str, Carried]:
    from bench.export.mjcf import ArmatureShare, joint_alone, robot_with

    if mjcf is None:
        return joint_alone(stored, joint or ALONE)
    if joint is None:
        raise InputError("--joint", "missing", "allowed: a joint of the MJCF")
    shares = {share.value: share for share in ArmatureShare}
    if armature is not None and armature not in shares:
        raise InputError("--armature", f"found '{armature}'", f"allowed: {', '.join(shares)}")
    return robot_with(mjcf, joint, stored, out, shares.get(armature or ""))
