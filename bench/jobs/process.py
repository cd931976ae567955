"""A worker process that does one piece of work after another, and can be stopped during one.

A thread cannot be stopped, and a signal does not interrupt compiled code that hangs: only a process can be ended, with
its memory. It is kept from one piece to the next, for loading numerics costs it a second. Dask has no deadline for a
task (a future that is cancelled runs on), and its workers may have no child of `multiprocessing`, hence `subprocess`.
"""

from __future__ import annotations

import faulthandler
import os
import pickle
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing import Pipe
from pathlib import Path
from typing import Generic, Literal, TypeVar

from bench.allocation import KEPT
from bench.bounds import shown

if sys.platform == "win32":
    from multiprocessing.connection import PipeConnection as Connection
else:
    from multiprocessing.connection import Connection

Item = TypeVar("Item")
Result = TypeVar("Result")

#: Interval at which the memory of the process is checked - s -, as in Dask's nanny.
LOOK = 0.2
#: Time after the deadline at which the process ends itself, if its parent is gone - s.
GRACE = 10.0
#: One numeric thread a process, since several compete for the cores (BLAS; Arrow reads the first too).
_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
#: Set in what a worker process sees.
_WATCHED = "SERVOBENCH_WATCHED"
_SERVE = "import sys; from bench.jobs.process import serve; serve(int(sys.argv[1]))"


@dataclass(frozen=True)
class Limits:
    """Limits of one piece of work, at which it is stopped: a deadline - s - and the memory of its process - bytes."""

    deadline: float = 120.0
    memory: float = 4.0 * 1024**3


@dataclass(frozen=True)
class Failure:
    """Why a piece of work gave no result: it was stopped at its deadline, or it raised, or its process died.

    The reason is for a person, and the same whenever the same happens.
    """

    status: Literal["failed", "timed_out"]
    reason: str


class WorkerProcess(Generic[Item, Result]):
    """The process, started with the first piece of work and again after it had to be stopped.

    The work is a picklable function of one item, and neither prints nor writes. `took` is the time of the last piece
    without that of a start - s.
    """

    def __init__(self, work: Callable[[Item], Result], limits: Limits) -> None:
        self._work, self._limits = work, limits
        self._running: tuple[subprocess.Popen[bytes], Connection] | None = None
        self.took = 0.0

    def __enter__(self) -> WorkerProcess[Item, Result]:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def do(self, item: Item) -> Result | Failure:
        """The work's result, or why there is none."""
        fresh = self._running is None
        process, calls = self._running = self._running or _process()
        try:
            if fresh:
                calls.send((self._work, self._limits.deadline))
            failure = calls.recv() if fresh else None  # once it has loaded what the work needs, the deadline counts
            if failure is None:
                calls.send(item)
                failure = self._waited(process, calls)
            if failure is None:
                return pickle.loads(calls.recv_bytes())
        except (EOFError, ConnectionError):
            status = process.wait()
            how = signal.Signals(-status).name if status < 0 else f"exit status {status}"
            failure = Failure("failed", f"its worker was killed ({how})")
        self.close()
        return failure

    def stop(self) -> None:
        """End the process from another thread: what it does is a failure."""
        if self._running is not None:
            self._running[0].kill()

    def close(self) -> None:
        """End the process; the next piece of work starts another."""
        if self._running is not None:
            process, calls = self._running
            self._running = None
            calls.close()
            process.kill()
            process.wait()

    def _waited(self, process: subprocess.Popen[bytes], calls: Connection) -> Failure | None:
        """The limit that it exceeded; None once there is an answer, or the process has died."""
        began, self.took = time.monotonic(), 0.0
        while not calls.poll(min(LOOK, max(0.0, self._limits.deadline - self.took))):
            self.took = time.monotonic() - began
            if self.took >= self._limits.deadline:
                return Failure("timed_out", f"no result within {self._limits.deadline:g} s")
            if _memory(process.pid) > self._limits.memory:
                return Failure("failed", f"its worker was killed (it took more than {shown(self._limits.memory)})")
        self.took = time.monotonic() - began
        return None


def _process() -> tuple[subprocess.Popen[bytes], Connection]:
    """A process that serves, and the pipe to it."""
    calls, other = Pipe()
    with other:
        handle, passed = other.fileno(), (other.fileno(),)
        if sys.platform == "win32":
            os.set_handle_inheritable(handle, True)
            passed = ()
        command = [sys.executable, "-c", _SERVE, str(handle)]
        own = {**_ONE_THREAD, **KEPT, **os.environ, _WATCHED: "1"}
        own["PYTHONPATH"] = os.pathsep.join(filter(None, sys.path))
        none = subprocess.DEVNULL
        return subprocess.Popen(
            command, pass_fds=passed, close_fds=bool(passed), env=own, stdin=none, stdout=none
        ), calls


def watched() -> bool:
    """Whether this is a worker process: its end is another's `Failure`, so nothing in it needs one of its own."""
    return _WATCHED in os.environ


def _memory(number: int) -> int:
    """Resident memory of a process - bytes; 0 if it has died."""
    import psutil  # 0.03 s, which reading a file need not pay

    try:
        return psutil.Process(number).memory_info().rss
    except psutil.NoSuchProcess:
        return 0


def serve(handle: int) -> None:
    """Do the work that comes through a pipe of this handle, in the worker process, until the other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # of the terminal: the waiting process decides
    sys.unraisablehook = lambda _: None  # of a library's half-made objects, which would be printed with the one line
    with Connection(handle) as calls, Path(os.devnull).open("w") as nowhere:
        try:
            work, deadline = calls.recv()
        except Exception as error:  # its parts cannot be imported here
            calls.send(raised(error))
            return
        calls.send(None)
        with suppress(EOFError, ConnectionError):  # the parent is gone
            while True:
                item = calls.recv()
                faulthandler.dump_traceback_later(deadline + GRACE, exit=True, file=nowhere)
                try:
                    answer = pickle.dumps(work(item))
                except Exception as error:  # of a result that cannot be pickled, too
                    answer = pickle.dumps(raised(error))
                faulthandler.cancel_dump_traceback_later()
                calls.send_bytes(answer)


def raised(error: Exception) -> Failure:
    """The failure of an unexpected exception."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    reason = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return Failure("failed", f"{reason} (at {Path(last.filename).name}:{last.lineno})")
