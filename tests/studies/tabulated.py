"""What tables of an unknown effect gain on real axes, and how often a recording without one gets a table.

`python -m tests.studies.tabulated --nulls 100 --out docs` writes `docs/tabulated.md`. Nulls are simulated by the
independent integrator.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console
from rich.progress import track

from bench.diagnosis.diagnosis import Diagnosis, diagnose
from bench.diagnosis.tabulated import UnknownEffect
from bench.errors import BenchError
from bench.files import write_text
from bench.rig.rig import load_rig
from tests.public import LINES, Line
from tests.studies.false_alarms.draw import as_it_was, drawn, recorded, rigs

#: Whose recordings are diagnosed: with a holdout where there is another recording of the axis.
AXES = (
    *(line for line in LINES if line.command == "diagnose"),
    Line("LAAS", "diagnose", ("laas_anticogging/acc_current.txt",), "laas.toml", ""),
    *(
        Line("Damiao 1", "diagnose", (f"real/damiao_m1/{one}.csv.gz",), "real/damiao_m1/rig.toml", "", holdout)
        for one, holdout in (("r1", "real/damiao_m1/r2.csv.gz"), ("r2", "real/damiao_m1/r3.csv.gz"), ("r3", ""))
    ),
)
HEADINGS = ("axis", "recording", "held-out motion", "residual / noise", "tabulated over", "torque gap", "speed gap")


@dataclass(frozen=True)
class Outcome:
    """What a diagnosis leaves, over its noise, and the effect that it tabulates."""

    remains: bool
    over_noise: float
    unknown: UnknownEffect | None


def outcome(found: Diagnosis) -> Outcome:
    """Of a diagnosis."""
    gap = found.torque
    left = 0.0 if gap.identify is None else gap.identify[1]
    return Outcome(found.verdict == "unexplained_remainder", left / gap.noise_floor, found.unknown_effect)


def of_line(line: Line) -> Outcome | str:
    """Of a real recording, or why it is refused."""
    _, *files = line.arguments()
    recordings, rig, holdout = files[: files.index("--rig")], files[files.index("--rig") + 1], None
    if line.holdout:
        holdout = files[-1]
    try:
        return outcome(diagnose([*recordings], load_rig(rig), holdout))
    except BenchError as error:
        return str(error)


def row(line: Line, found: Outcome) -> str:
    """Of the table."""
    name, unknown = Path(line.arguments()[1]).name, found.unknown
    cells = [line.axis, name, "", f"{found.over_noise:.1f}", "none", "1.00", "1.00"]
    if unknown is not None:
        cells[2], cells[4] = unknown.motion, ", ".join(one.name for one in unknown.tables)
        cells[5:] = (f"{after / before:.2f}" for before, after in (unknown.torque, unknown.velocity))
    return f"| {' | '.join(cells)} |"


def page(axes: Sequence[tuple[Line, Outcome]], nulls: Sequence[Outcome]) -> str:
    """The table of those axes with an unknown effect, and how many nulls get tables."""
    remaining = [(line, found) for line, found in axes if found.remains]
    unknown = [found.unknown for _, found in remaining if found.unknown is not None]
    torque = [one.torque[1] / one.torque[0] for one in unknown]
    speed = [one.velocity[1] / one.velocity[0] for one in unknown]
    every = [*torque, *[1.0] * (len(remaining) - len(torque))]
    return "\n".join(
        [
            "# An unknown effect, tabulated",
            "",
            "`python -m tests.studies.tabulated --out docs` made this page. A gap is the one with the tables over the",
            "one without, on motion that no fit used: a holdout, or a third of the recording. The speed gap is that",
            "of free-running simulations of 0.5 s.",
            "",
            f"| {' | '.join(HEADINGS)} |",
            f"|{'---|' * len(HEADINGS)}",
            *(row(*one) for one in remaining),
            "",
            f"Of {len(remaining)} recordings with an unknown effect {len(torque)} get tables. The median torque gap is",
            f"{np.median(every or [1.0]):.2f}, and {np.median(torque or [1.0]):.2f} where there are tables. The",
            f"largest speed gap is {max([1.0, *speed]):.2f}.",
            "",
            f"Of {len(nulls)} recordings that lack nothing {sum(one.unknown is not None for one in nulls)} get tables.",
            "",
        ]
    )


def of_axes() -> Iterator[tuple[Line, Outcome]]:
    """Of every real recording that is not refused."""
    for line in AXES:
        found = of_line(line)
        if isinstance(found, Outcome):
            yield line, found
        else:
            typer.echo(f"{line.axis}: {found}", err=True)


def of_nulls(count: int, seed: int) -> Iterator[Outcome]:
    """Of simulated recordings that lack nothing."""
    axes = drawn(count, seed)
    for one, rig in zip(recorded([as_it_was(axis) for axis in axes], seed, 0), rigs(axes), strict=True):
        try:
            yield outcome(diagnose(one.trace, rig))
        except BenchError as error:
            typer.echo(f"a null is refused: {error}", err=True)


def main(
    nulls: Annotated[int, typer.Option(help="Recordings that lack nothing.")] = 100,
    seed: Annotated[int, typer.Option(help="Of the nulls.")] = 53,
    out: Annotated[Path | None, typer.Option(help="Folder for tabulated.md.")] = None,
) -> None:
    """Diagnose all of them and print the table."""
    console = Console(stderr=True)
    axes = list(track(of_axes(), "axes", len(AXES), console=console))
    text = page(axes, list(track(of_nulls(nulls, seed), "nulls", nulls, console=console)))
    typer.echo(text)
    if out is not None:
        write_text(out / "tabulated.md", text)


if __name__ == "__main__":
    typer.run(main)
