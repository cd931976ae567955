"""Command line of the nuisance set."""

from __future__ import annotations

from fnmatch import fnmatch
from pathlib import Path
from typing import Annotated

import typer

from tests.studies.frame import publish
from tests.studies.nuisance import realistic as many
from tests.studies.nuisance.draw import draw
from tests.studies.nuisance.kinds import NUISANCES
from tests.studies.nuisance.record import home
from tests.studies.nuisance.run import scored
from tests.studies.nuisance.table import cases_csv, headline, markdown, not_right


def main(
    each: Annotated[int, typer.Option(min=1, help="Cases of each strength: the first with nothing hidden.")] = 3,
    seed: int = 1,
    jobs: Annotated[int, typer.Option(min=1)] = 2,
    only: Annotated[str, typer.Option(help="Cases, nuisances or hidden effects that match, as jitter*.")] = "*",
    one_in: Annotated[int, typer.Option(min=1, help="Take one case in so many.")] = 1,
    out: Annotated[Path | None, typer.Option(help="Folder for table.md and cases.csv.")] = None,
    realistic: Annotated[int, typer.Option(min=0, help="Instead: so many axes of four to six small effects.")] = 0,
    kinds: Annotated[bool, typer.Option("--list", help="List the nuisances and stop.")] = False,
) -> None:
    """Damage recordings of an independent integrator and see whether the bench is right, or refuses."""
    if kinds:
        for name, nuisance in NUISANCES.items():
            typer.echo(f"{name}: {(type(nuisance).__doc__ or '').splitlines()[0]}")
    elif realistic:
        of_realistic(seed, realistic, jobs, only, one_in, out)
    else:
        of_nuisances(seed, each, jobs, only, one_in, out)


def of_nuisances(seed: int, each: int, jobs: int, only: str, one_in: int, out: Path | None) -> None:
    """Run the nuisance set and tell it."""
    drawn = [
        case for case in draw(seed, each) if any(fnmatch(n, only) for n in (case.name, case.nuisance, case.hidden))
    ]
    scores = scored(home(), _some(drawn, only, one_in), jobs)
    typer.echo(headline(scores) + "\n\n" + not_right(scores))
    typer.echo(f"files: {home() / 'cases'}", err=True)
    command = _command(f"--each {each} --seed {seed}", only, one_in)
    publish(out, {"table.md": markdown(scores, "Nuisance set", command), "cases.csv": cases_csv(scores)})


def of_realistic(seed: int, count: int, jobs: int, only: str, one_in: int, out: Path | None) -> None:
    """Run the realistic axes and tell them."""
    drawn = [case for case in many.draw(seed, count) if fnmatch(case.name, only)]
    folder = home() / f"realistic-{seed}"
    scores = many.scored(folder, _some(drawn, only, one_in), seed, jobs)
    typer.echo(many.headline(scores) + "\n\n" + many.not_right(scores))
    typer.echo(f"files: {folder}", err=True)
    command = _command(f"--realistic {count} --seed {seed}", only, one_in)
    publish(out, {"table.md": many.markdown(scores, command), "cases.csv": many.cases_csv(scores)})


def _some(cases: list, only: str, one_in: int) -> list:
    if not cases:
        raise typer.BadParameter(f"no case matches {only}")
    return cases[::one_in]


def _command(options: str, only: str, one_in: int) -> str:
    more = f" --only '{only}'" * (only != "*") + f" --one-in {one_in}" * (one_in > 1)
    return f"python -m tests.studies.nuisance {options}{more}"


if __name__ == "__main__":
    typer.run(main)
