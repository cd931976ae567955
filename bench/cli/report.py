"""`bench report`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import list_files


def report(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR...", help="Folders that --out of a command wrote.")],
    script: Annotated[
        Path | None, typer.Option("--script", help="Script file to write that the pages share, for many of them.")
    ] = None,
) -> None:
    """Make report.html of folders anew, from the report.json that lies in each."""
    from bench.report.publish import rebuild

    list_files(rebuild(folders, script))
