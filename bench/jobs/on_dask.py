"""Pieces of work on a Dask cluster.

Dask has the queue, the balance between workers, and the retries where a worker or its machine is lost; each thread of a
worker has one process with it (`process.py`), so that no piece of work can hold up or end the worker itself.
"""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from functools import partial
from typing import Any, cast
from uuid import uuid4

from distributed import Client, Future, KilledWorker, Security, Worker, WorkerPlugin, as_completed, get_worker
from distributed.comm.core import connect

from bench import __version__
from bench.errors import InputError
from bench.jobs.process import Failure, Item, Limits, Result, WorkerProcess, raised

#: Seconds within which a scheduler has to answer.
ANSWERS = 15
#: Items sent to the scheduler at a time.
BATCH = 1000


def on_dask(
    work: Callable[[Item], Result],
    numbered: Sequence[tuple[int, Item]],
    limits: Limits,
    scheduler: str,
    answers: float = ANSWERS,
) -> Iterator[tuple[int, Result | Failure]]:
    """Results by the items' numbers, in the order in which they come; other arguments as of `bench.jobs.each.each`.

    InputError where there is no such cluster, or its workers have no servobench of this version.
    """
    with _client(scheduler, answers) as client, ExitStack() as stack:
        name = f"bench-{uuid4().hex}"
        try:
            client.register_plugin(WorkerProcesses(name, work, limits))  # also for a worker that comes later
        except ImportError as error:
            found = f"its workers cannot load the bench ({error})"
            allowed = f"install servobench {__version__} where they run"
            raise InputError(f"--scheduler {scheduler}", found, allowed) from error
        stack.callback(client.unregister_worker_plugin, name)
        keys = [(name, number) for number, _ in numbered]  # one group, which the scheduler hands out as workers ask
        items = [item for _, item in numbered]
        for future in as_completed(client.map(partial(_done, name), items, key=keys, batch_size=BATCH)):
            yield future.key[1], _outcome(future)


def _client(scheduler: str, answers: float) -> Client:
    try:
        with ThreadPoolExecutor(1) as thread:  # a notebook's own runs a loop already
            thread.submit(asyncio.run, asyncio.wait_for(_answered(scheduler), answers)).result()
        return Client(scheduler, timeout=answers)
    except (OSError, ValueError, TypeError) as error:
        found = f"no Dask scheduler answers ({' '.join(str(error).split()) or f'nothing within {answers:g} s'})"
        allowed = "allowed: the address of one, e.g. tcp://host:8786"
        raise InputError(f"--scheduler {scheduler}", found, allowed) from error


async def _answered(scheduler: str) -> None:
    """Return once a scheduler has identified itself, for which a client would wait without end."""
    comm = await connect(scheduler, **Security().get_connection_args("client"))
    await comm.close()


class WorkerProcesses(WorkerPlugin):
    """The processes of a worker, one for each of its threads that works; tasks find it by its name."""

    def __init__(self, name: str, work: Callable[..., object], limits: Limits) -> None:
        self.name, self._work, self._limits = name, work, limits
        self._processes: dict[int, WorkerProcess] = {}

    def teardown(self, worker: Worker) -> None:
        """End the processes."""
        for process in list(self._processes.values()):
            process.close()

    def do(self, item: object) -> object:
        """The work's result or failure, by the process of the calling thread."""
        process = self._processes.setdefault(threading.get_ident(), WorkerProcess(self._work, self._limits))
        return process.do(item)


def _done(name: str, item: object) -> object:
    """One task."""
    return cast("WorkerProcesses", get_worker().plugins[name]).do(item)


def _outcome(future: Future) -> Any:  # noqa: ANN401
    """What a task returned, or that its worker was lost as often as Dask allows.

    A result that was lost with its worker is computed again while it is asked for, which may fail as the first time.
    """
    try:
        return future.result()
    except KilledWorker:
        return Failure("failed", "its worker was killed (Dask tried it as often as it is allowed to)")
    except asyncio.CancelledError:
        return Failure("failed", "the cluster gave it up")
    except Exception as error:
        return raised(error)
