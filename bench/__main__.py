"""Command line, and `python -m bench`."""

import atexit
import os
import signal
import sys
from contextlib import suppress
from threading import Event, Thread
from types import FrameType

# Many small least-squares problems: BLAS threads only wait for one another (a diagnosis took 9.7 s with one thread, 14
# to 26 s with two on two cores). Read when numpy is first imported, so it is set before everything else.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# MuJoCo loads a window library at import, 0.1 s; `bench.view.video.prepare` selects one to render with.
os.environ.setdefault("MUJOCO_GL", "off")

from bench import __version__
from bench.errors import Stopped

#: Bytes of addresses that NumPy, Arrow and MuJoCo load in; less by any `ulimit -v` may never end.
LEAST_MEMORY = 1000 * 1000 * 1024
#: Threads that Arrow, MuJoCo and numerics start on a machine of two cores, rounded up; where one is refused they abort.
LEAST_THREADS = 24


#: Statuses that a shell gives the signals that came.
_STOPPED: list[int] = []


def _stop(number: int, _frame: FrameType | None) -> None:
    os.write(2, b"bench: interrupted\n")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # a library that is being loaded makes a fault of its own of it
    _STOPPED.append(128 + number)
    raise Stopped


def _threads() -> bool:
    """Whether as many threads as libraries need may run at the same time (1 ms)."""
    ended = Event()
    try:
        for _ in range(LEAST_THREADS):
            Thread(target=ended.wait).start()
        return True
    except RuntimeError:  # of `ulimit -u`, or of the container
        return False
    finally:
        ended.set()


def _lacking() -> str | None:
    """What libraries wait for without end, or abort the process for; None where there is enough of it."""
    with suppress(ModuleNotFoundError):  # Windows has no such limits
        import resource

        most = resource.getrlimit(resource.RLIMIT_AS)[0]
        if most != resource.RLIM_INFINITY and most < LEAST_MEMORY:
            return "ulimit -v: found less than 1 GB, for which NumPy's OpenBLAS waits for ever; allow 1 GB"
    return None if _threads() else f"ulimit -u: found room for fewer than {LEAST_THREADS} threads; allow more"


def main() -> None:
    """Entry point of `bench`."""
    with suppress(OSError):  # which the command line reports
        if sys.argv[1:] == ["--version"] and sys.stdout is not None:
            print(__version__, flush=True)  # 0.03 s of CPU; 0.2 s with the command line's library
            return
    if lacking := _lacking():
        os.write(2, f"bench: {lacking}\n".encode())
        os._exit(2)
    status = 70

    def leave() -> None:
        """End before Python is taken down: a thread of Arrow that lets go of an object by then aborts the process."""
        with suppress(OSError, ValueError):  # what came before an error that is printed already
            if sys.stdout is not None:
                sys.stdout.flush()
        os._exit(_STOPPED[0] if _STOPPED else status)

    atexit.register(leave)  # the first that is registered is the last that is called
    try:
        for name in ("SIGINT", "SIGTERM", "SIGHUP"):
            number = getattr(signal, name, None)  # Windows has no SIGHUP
            if number is not None and signal.getsignal(number) is not signal.SIG_IGN:  # as with nohup
                signal.signal(number, _stop)
        from bench.allocation import keep_freed_memory
        from bench.cli import main as run

        keep_freed_memory()
        try:
            run()
        except SystemExit as end:  # as the command line always ends; any other end is a fault
            status = end.code if isinstance(end.code, int) else status
            raise
    except Stopped:
        os._exit(_STOPPED[0])  # what is half imported cannot be taken down in order


if __name__ == "__main__":
    main()
