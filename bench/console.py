"""What commands share: common options, and the output of results to a terminal or a file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from bench.files import write_text
from bench.names import plain

if TYPE_CHECKING:
    from rich.console import Console

TracesArgument = Annotated[
    list[Path], typer.Argument(metavar="TRACE...", help="Recordings of one axis, of any known format.")
]
RigOption = Annotated[Path, typer.Option("--rig", help="Rig file (TOML): what is known about the axis.")]
AxisOption = Annotated[str | None, typer.Option("--axis", help="Axis to read where a recording holds several.")]


class Figures(StrEnum):
    """Formats of figures."""

    PNG = "png"
    PDF = "pdf"
    SVG = "svg"

    @property
    def ending(self) -> str:
        """Of a file."""
        return f".{self.value}"


FiguresOption = Annotated[Figures, typer.Option("--figures", help="Format of the figures that --out writes.")]
ReportOption = Annotated[Path | None, typer.Option("--report", help="Page to write: .html, all in one file.")]
JsonOption = Annotated[Path | None, typer.Option("--json", help="Write the result as JSON to this file; - is stdout.")]


def write_json(path: Path, text: str) -> None:
    """Write JSON to a file in an existing folder, or to standard output if `path` is -.

    Raises:
        InputError: a place that cannot be written to.
    """
    if path == Path("-"):
        typer.echo(text)
    else:
        write_text(path, text + "\n", make_folder=False)


@contextmanager
def refusal_as_json(path: Path | None, schema: str) -> Iterator[None]:
    """Write the checks of a recording that the gate refuses as JSON; the error is passed on."""
    from bench.gate.gate import UnanswerableError

    try:
        yield
    except UnanswerableError as error:
        if path is not None:
            from bench.report.gate import refusal_json

            write_json(path, refusal_json(schema, error.checks, str(error)))
        raise


def console() -> Console:
    """Console at least as wide as the bench's tables, also in a log; texts in them are no markup."""
    from rich.console import Console  # 0.04 s, which --version and --help need not pay
    from rich.text import Text

    class PlainConsole(Console):
        """Shows strings as they are, in titles and cells alike."""

        def render_str(self, text: str, *args: Any, **named: Any) -> Text:  # noqa: ANN401
            return super().render_str(plain(text), *args, **named)

    found = PlainConsole(highlight=False, markup=False, emoji=False)
    return found if found.is_terminal else PlainConsole(highlight=False, markup=False, emoji=False, width=110)


def print_warnings(warnings: Iterable[str]) -> None:
    """A line on standard error for each warning."""
    for warning in warnings:
        typer.echo(plain(f"warning: {warning}"), err=True)


def print_files(files: Iterable[Path]) -> None:
    """A line for each file written."""
    for path in files:
        typer.echo(plain(f"wrote {path}"))
