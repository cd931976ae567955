"""The command line against hostile input: a run with its limits, and what every run owes."""

import os
import resource
import shutil
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from tests.command import Done

ROOT = Path(__file__).resolve().parents[1]
RIG = 'name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\nrotor_inertia = "2 kg*cm**2"\n'
#: A run ends within this, on a machine that does much else - s; what hangs does not end at all.
DEADLINE = 120.0

#: Rights of root that permissions do not bind.
_OVERRIDES = "-dac_override,-dac_read_search"


def bound_by_permissions() -> list[str] | None:
    """What a command line begins with so that permissions bind it, whoever runs the tests; None where nothing does."""
    if os.geteuid():
        return []
    return ["setpriv", "--bounding-set", _OVERRIDES, "--inh-caps", _OVERRIDES] if shutil.which("setpriv") else None


def columns(samples=3000):
    """Time - s, velocity - rad/s, current - A of a plain axis in a motion in closed form."""
    rng = np.random.default_rng(0)
    time = 1e-3 * np.arange(samples)
    velocity = 50.0 * np.sin(8.0 * time) + 20.0 * np.sin(31.0 * time)
    acceleration = 400.0 * np.cos(8.0 * time) + 620.0 * np.cos(31.0 * time)
    torque = 1.5e-3 * acceleration + 8e-4 * velocity + 0.06 * np.sign(velocity) + 5e-3 * rng.normal(size=samples)
    return time, velocity + 0.03 * rng.normal(size=samples), torque / 0.8


def csv_of(time, velocity, current, head="time [s],velocity [rad/s],current [A]"):
    rows = zip(time.tolist(), velocity.tolist(), current.tolist(), strict=True)
    return "\n".join([head, *(f"{t!r},{w!r},{i!r}" for t, w, i in rows)]) + "\n"


#: The plain axis as a file.
TABLE = csv_of(*columns())


def run(*arguments, cwd, deadline=DEADLINE, under=(), **environment):
    """`bench` as a process of its own, in the care of the command `under`; its standard error is text in any case."""
    env = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    return subprocess.run(
        [*under, sys.executable, "-m", "bench", *map(str, arguments)],
        cwd=cwd, env=env, capture_output=True, text=True, errors="replace", timeout=deadline, check=False,
    )  # fmt: skip


def assert_one_line(done, *words, status=2):
    """It refused, in one line that has these words; run in this process, or in one of its own."""
    ended, err = (done.status, done.err) if isinstance(done, Done) else (done.returncode, done.stderr)
    assert (ended, err.count("\n")) == (status, 1), err
    assert err.startswith("bench: ")
    for word in words:
        assert word in err


@contextmanager
def cpu_seconds(most):
    """At most so much of this process' time; what would hang is stopped."""

    def stop(*_):
        raise TimeoutError(f"more than {most} s of CPU")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, most)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


@contextmanager
def room_for(size):
    """No file that this process writes may have more bytes, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
