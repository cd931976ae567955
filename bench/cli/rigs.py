"""`bench rigs`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import list_files
from bench.errors import InputError


def rigs(
    name: Annotated[str | None, typer.Argument(help="A shipped rig, or a rig file of your own; all without.")] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Copy of the rig file to write.")] = None,
) -> None:
    """List the rigs that are shipped, copy one, or say which commands a rig suffices for and all that is missing."""
    from bench.assets import asset
    from bench.files import write_text
    from bench.names import nearest
    from bench.rig.rig import lacking, load_rig, without_constant

    shipped = {path.stem: path for path in sorted(asset("data", "rigs").glob("*.toml"))}
    if name is None:
        if out is not None:
            raise InputError("--out", "found without a rig", f"allowed: with one of {', '.join(shipped)}")
        for stem, path in shipped.items():
            typer.echo(f"{stem:12} {load_rig(path).name}")
        return
    path = shipped.get(name) or Path(name)
    if name not in shipped and not path.exists():
        raise InputError(
            name, f"no shipped rig and no file{nearest(name, list(shipped))}", f"allowed: {', '.join(shipped)}"
        )
    if out is not None:
        if out.exists() and out.resolve() == path.resolve():
            raise InputError(out, "found the rig itself", "allowed: another file")
        write_text(out, path.read_text(encoding="utf-8"))
        list_files([out])
    rig = load_rig(path)
    typer.echo(f"{rig.name}, {rig.kind}")
    for command, keys in lacking(rig).items():
        typer.echo(f"bench {command}: {'missing ' + ', '.join(keys) if keys else 'suffices'}")
    remark = without_constant(rig)
    if remark is not None:
        typer.echo(f"note: {remark}")
