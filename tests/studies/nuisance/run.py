"""Record, damage, ask and judge many cases side by side."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import as_completed
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from tests.studies.blind.__main__ import workers
from tests.studies.nuisance.draw import Case
from tests.studies.nuisance.record import recorded, write_case
from tests.studies.nuisance.score import Score, judge


def scored(folder: Path, cases: Sequence[Case], jobs: int, show: bool = True) -> list[Score]:
    """Record what is missing, damage and ask about all, judge them; in the order drawn."""
    scores: dict[str, Score] = {}
    with workers(jobs) as pool, Progress(console=Console(stderr=True), disable=not show) as progress:
        bar = progress.add_task("recording", total=len(cases))
        for done in recorded(folder, cases, pool):
            progress.advance(bar, done)
        bar = progress.add_task("asking", total=len(cases))
        for task in as_completed([pool.submit(asked, folder, case) for case in cases]):
            score = task.result()
            scores[score.case.name] = score
            progress.advance(bar)
    return [scores[case.name] for case in cases]


def asked(folder: Path, case: Case) -> Score:
    """Write a case's files, ask about them, judge."""
    return judge(case, write_case(folder, case))
