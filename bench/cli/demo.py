"""`bench demo`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.console import console, print_files, print_warnings


def demo(
    out: Annotated[Path, typer.Option("--out", help="Folder for trace, truth and figures.")] = Path("bench_demo"),
) -> None:
    """Simulate the embedded rig, identify it, and set truth beside estimate."""
    from bench.demo import demo as run_demo
    from bench.report.estimate import estimate_table
    from bench.report.progress import progress

    with progress("demo") as done:
        result = run_demo(out, done)
    console().print(estimate_table(result.estimate, result.title, result.truth))
    print_warnings(result.estimate.warnings)
    print_files(result.files)
