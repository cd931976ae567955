"""`bench demo`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import tell


def demo(
    out: Annotated[Path, typer.Option("--out", help="Folder for trace, truth and figures.")] = Path("bench_demo"),
) -> None:
    """Simulate the embedded rig, identify it, and set truth beside estimate."""
    from bench.demo import demo as run_demo
    from bench.report.terminal import progress

    with progress("demo") as done:
        found, files = run_demo(out, done)
    tell(found, files)
