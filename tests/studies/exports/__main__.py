"""Score every exported recording: `python -m tests.studies.exports [FOLDER]`; the last line counts."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

import typer

from tests.studies.exports.score import EXPORTS, score, truths


def main(folder: Annotated[Path, typer.Argument(help="Folder with truth.json.")] = EXPORTS) -> None:
    """Run inspect and identify over every recording and hold them to the truth beside it."""
    count: Counter[str] = Counter()
    for name, truth in truths(folder).items():
        outcome = score(folder / name, truth)
        count[outcome.verdict] += 1
        typer.echo(f"{outcome.verdict:8} {name:24} {outcome.detail}")
    typer.echo(f"{sum(count.values())} recordings: " + ", ".join(f"{n} {verdict}" for verdict, n in count.items()))


if __name__ == "__main__":
    typer.run(main)
