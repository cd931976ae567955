"""Run the tests of a mutant until one fails."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import dataclass

from tests.studies.mutation.mutants import MUTANT, TESTS, Mutant

#: Exit codes of pytest: all passed, nothing to run.
PASSED, EMPTY = 0, 5
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Result:
    """What became of a mutant.

    Attributes:
        name: of it.
        killed_by: the test that noticed, or what else did; empty if it survived.
        seconds: that took.
        unfinished: whether its time ran out before a test failed, or all had passed.
    """

    name: str
    killed_by: str
    seconds: float
    unfinished: bool = False


def tried(mutant: Mutant | None, stages: tuple[tuple[str, ...], ...], deadline: float) -> Result:
    """The first test of the stages that fails; of the bench as it is where there is no mutant.

    Args:
        mutant: to be made.
        stages: arguments of pytest, run one after the other.
        deadline: for all of them - s.
    """
    start, name = time.monotonic(), mutant.name if mutant else "none"
    environment = {**os.environ, **ONE_THREAD, **({MUTANT: name} if mutant else {})}
    for stage in stages:
        command = [sys.executable, "-m", "pytest", "-p", "tests.studies.mutation.plugin", "-p", "no:cacheprovider"]
        command += ["-q", "-n", "0", "-x", "--tb=no", "--no-header", *stage]
        left = deadline - (time.monotonic() - start)
        try:
            done = subprocess.run(
                command,
                check=False,
                cwd=TESTS.parent,
                env=environment,
                capture_output=True,
                text=True,
                timeout=max(left, 1.0),
            )
        except subprocess.TimeoutExpired:
            return Result(name, "", time.monotonic() - start, unfinished=True)
        if done.returncode not in (PASSED, EMPTY):
            return Result(name, _killer(done.stdout + done.stderr), time.monotonic() - start)
    return Result(name, "", time.monotonic() - start)


def _killer(said: str) -> str:
    """The test named in pytest's summary; its last line where it did not come that far."""
    for line in said.splitlines():
        if line.startswith(("FAILED ", "ERROR ")):
            return line.split(" ", 1)[1].split(" - ")[0].removeprefix("tests/")
    return (said.strip().splitlines() or ["nothing said"])[-1]
