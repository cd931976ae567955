"""A progress bar on standard error for long work, if that is a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from bench.names import plain


@contextmanager
def progress(what: str) -> Iterator[Callable[[float], None]]:
    """Bar for one piece of work, gone when it is done.

    Args:
        what: is being done.

    Returns:
        Function to be called with the share done, 0 to 1.
    """
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}", markup=False), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(plain(what), total=1.0)
        yield lambda share: bar.update(task, completed=share)
