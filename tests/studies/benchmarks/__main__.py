"""Command line of the benchmarks: `python -m tests.studies.benchmarks [NAME...] [--out docs]`."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable, Iterable, Mapping, Sequence
from datetime import date
from functools import partial
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track

from tests.studies.benchmarks.table import Table

PAGE = "benchmarks.md"
INTRODUCTION = """# Benchmarks

    python -m tests.studies.benchmarks --out docs

measures what follows (`pip install -e '.[dev,benchmarks]'`). With names, as in
`python -m tests.studies.benchmarks sysid --out docs`, it measures some of it again and does not change the rest. What
is compared is measured within one run, in turn, so that both share what else the machine does; times are medians, and
a ratio is the median of the ratios within each round. Ratios are valid for other machines more than times are.
"""


def measured_by(module: str) -> list[Table]:
    """Tables of a module of this package, which is loaded when it measures: `mujoco.sysid` is an extra."""
    try:
        return import_module(f"tests.studies.benchmarks.{module}").measured()
    except ImportError as error:
        raise typer.BadParameter(f"{error}; pip install -e '.[benchmarks]'") from error


Benchmarks = Mapping[str, tuple[str, Callable[[], list[Table]]]]
#: Headings of the page's sections in their order, and what measures them, by the names of the command line.
BENCHMARKS: Benchmarks = {
    "sysid": ("Identification compared with mujoco.sysid", partial(measured_by, "beside_sysid")),
    "before": ("CPU time of an identification against an earlier version", partial(measured_by, "beside_before")),
    "starting": ("CPU time of whole commands against an earlier version", partial(measured_by, "starting")),
    "stepping": ("Simulation compared with bare stepping", partial(measured_by, "beside_stepping")),
    "reading": ("Reading compared with pyarrow", partial(measured_by, "beside_pyarrow")),
    "diagnosing": ("CPU time of a diagnosis", partial(measured_by, "diagnosing")),
}


def section(tables: Iterable[Table]) -> str:
    """What stands under a heading: when and with what, and the tables."""
    packages = ", ".join(f"{name} {version(name)}" for name in ("mujoco-core", "numpy", "scipy", "pyarrow"))
    origin = f"{date.today()}, Python {platform.python_version()}, {packages}, {os.cpu_count()} cores."
    return "\n\n".join([origin, *(table.markdown for table in tables)])


def sections(page: str) -> dict[str, str]:
    """Text under each heading of a page."""
    parts = (part.split("\n", 1) for part in page.split("\n## ")[1:])
    return {heading: text.strip() for heading, text in parts}


def page(known: Mapping[str, str], benchmarks: Benchmarks = BENCHMARKS) -> str:
    """The page of all sections that are known."""
    headings = [heading for heading, _ in benchmarks.values() if heading in known]
    return INTRODUCTION + "".join(f"\n## {heading}\n\n{known[heading]}\n" for heading in headings)


def measure(names: Sequence[str], out: Path | None, benchmarks: Benchmarks = BENCHMARKS) -> None:
    """Measure some benchmarks, all where none is named; print them, and write their sections of the page."""
    unknown = sorted(set(names) - set(benchmarks))
    if unknown:
        raise typer.BadParameter(f"found {', '.join(unknown)}; allowed: {', '.join(benchmarks)}")
    wanted = [name for name in benchmarks if name in (names or benchmarks)]
    for name in track(wanted, console=Console(stderr=True)):
        heading, measured = benchmarks[name]
        text = section(measured())
        typer.echo(f"## {heading}\n\n{text}\n")
        if out is not None:  # what is measured is kept, whatever comes next
            path = out / PAGE
            known = sections(path.read_text(encoding="utf-8")) if path.exists() else {}
            path.write_text(page({**known, heading: text}, benchmarks), encoding="utf-8")


def main(
    names: Annotated[list[str] | None, typer.Argument(help=f"Of {', '.join(BENCHMARKS)}; all if none.")] = None,
    out: Annotated[Path | None, typer.Option(help=f"Folder of {PAGE}; sections not measured stay.")] = None,
) -> None:
    """Measure the bench beside what it is made of and what does the same."""
    measure(names or [], out)


if __name__ == "__main__":
    typer.run(main)
