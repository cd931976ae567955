"""Record, damage, ask and judge many cases side by side."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from tests.studies.frame import running
from tests.studies.nuisance.draw import Case
from tests.studies.nuisance.record import recorded, write_case
from tests.studies.nuisance.score import Score, judge


def scored(folder: Path, cases: Sequence[Case], jobs: int, show: bool = True) -> list[Score]:
    """Record what is missing, damage and ask about all, judge them; in the order drawn."""
    with running(jobs, show) as run:
        run.counted("recording", len(cases), recorded(folder, cases, run.pool))
        return run.each("asking", asked, [(folder, case) for case in cases])


def asked(folder: Path, case: Case) -> Score:
    """Write a case's files, ask about them, judge."""
    return judge(case, write_case(folder, case))
