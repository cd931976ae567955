"""What studies have in common: cases are drawn, recorded and scored side by side, and come to tables in a folder."""

from __future__ import annotations

import csv
import io
import os
import resource
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import Progress

from bench.files import write_text


@contextmanager
def workers(jobs: int) -> Iterator[Executor]:
    """Processes with one numeric thread each; several would fight over the cores."""
    os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"
    with ProcessPoolExecutor(jobs, get_context("spawn")) as pool:
        yield pool


@dataclass(frozen=True)
class Run:
    """Work side by side, with a bar for each part of it."""

    pool: Executor
    progress: Progress

    def counted(self, what: str, total: int, parts: Iterable[int]) -> None:
        """Take parts of the work as they are done, each the number of cases in it."""
        bar = self.progress.add_task(what, total=total)
        for done in parts:
            self.progress.advance(bar, done)

    def each(self, what: str, work: Callable[..., Any], arguments: Sequence[Sequence[Any]]) -> list[Any]:
        """The result of work for each of the arguments, in their order."""
        bar = self.progress.add_task(what, total=len(arguments))
        tasks = [self.pool.submit(work, *each) for each in arguments]
        for task in as_completed(tasks):
            task.result()  # the first that fails ends the study
            self.progress.advance(bar)
        return [task.result() for task in tasks]


@contextmanager
def running(jobs: int, show: bool = True) -> Iterator[Run]:
    """Processes, and their progress on standard error."""
    with workers(jobs) as pool, Progress(console=Console(stderr=True), disable=not show) as progress:
        yield Run(pool, progress)


def cpu() -> float:
    """Time that this process, and those of its that have ended, took of processors - s."""
    return sum(sum(resource.getrusage(whose)[:2]) for whose in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))


def table(heads: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """A table as Markdown."""
    lines = [heads, *rows]
    text = [f"| {' | '.join(map(str, line))} |" for line in lines]
    return "\n".join([text[0], "|---" * len(heads) + "|", *text[1:]])


def csv_of(heads: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """A table as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([heads, *rows])
    return text.getvalue()


def publish(out: Path | None, texts: Mapping[str, str]) -> None:
    """Write texts by the names of their files into a folder, made if it is not there, where one is asked for."""
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        for name, text in texts.items():
            write_text(out / name, text)
