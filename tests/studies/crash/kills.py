"""Kill a command (SIGKILL: no cleaning up) again and again, and look at what it leaves."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from tests.studies.crash.commands import Command, arguments, finished, make_inputs
from tests.studies.crash.look import files, hashes, left, lingering, state, whole

#: Kills between two runs to the end.
EACH = 3
#: Fractional part of its multiples: values in (0, 1) that are spread evenly however many are taken.
GOLDEN = 0.6180339887
#: Of four kills two fall anywhere into the run, one into its writing, one exactly before a step of it.
MOMENTS = ("run", "writing", "run", "step")


@dataclass
class Tally:
    """What was done to a command, and what was found: kills by moment, runs to the end, files looked at, faults."""

    kills: Counter[str] = field(default_factory=Counter)
    missed: int = 0
    ended: int = 0
    looked: int = 0
    left: int = 0
    faults: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Pace:
    """Of a run to the end - s: all of it, and until it first wrote; how many steps its writing has."""

    lasted: float
    first: float
    steps: int


class Trial:
    """One command in a folder of its own."""

    def __init__(self, command: Command, folder: Path, number: signal.Signals = signal.SIGKILL) -> None:
        self.number = number
        self.command, self.folder, self.out, self.tally = command, folder, folder / "out", Tally()
        self.temporary = folder.with_name(f"{folder.name}-temporary")
        self.temporary.mkdir()
        self.environment = {**os.environ, "TMPDIR": str(self.temporary)}
        make_inputs(folder)
        self.inputs = self._inputs()
        steps = self._steps()
        self._clear()
        self.pace = self._timed(steps)
        self.names = files(self.out)

    def killed(self, asked: int, until: float) -> Tally:
        """Kill it so often, or until a time is reached; every few kills it runs to its end."""
        number = 0
        while self.tally.kills.total() < asked and number < 2 * asked and time.monotonic() < until:
            moment, share = self._moment(number), (number + 1) * GOLDEN % 1.0
            if self.kill(moment, share):
                self.tally.kills[moment] += 1
            else:
                self.tally.missed += 1
            self._look(f"{moment} {share:.3f}")
            number += 1
            if number % EACH == 0:
                self.end(clear=self.command.resumes or number % (2 * EACH) == 0)
        self.end(clear=False)
        return self.tally

    def _moment(self, number: int) -> str:
        """Only SIGKILL comes before a step: another is seen once Python goes on."""
        moment = MOMENTS[number % len(MOMENTS)]
        return "writing" if moment == "step" and self.number != signal.SIGKILL else moment

    def kill(self, moment: str, share: float) -> bool:
        """Kill it at a share of its run, of its writing or of the steps of it; whether it was still running."""
        step = 1 + int(share * self.pace.steps)
        line = self._stepping(step) if moment == "step" else arguments(self.command.line)
        before, process = state(self.out), self._start(line)
        if moment == "run":
            _wait(process, share * self.pace.lasted)
        elif moment == "writing":
            while process.poll() is None and state(self.out) == before:
                time.sleep(0.002)
            _wait(process, share * (self.pace.lasted - self.pace.first))
        else:
            process.wait()
        process.send_signal(self.number)
        status = process.wait()
        reported = self.number != signal.SIGKILL and status == 128 + self.number
        hit = reported or (status < 0 and moment == "step") or status == -self.number
        if status and not hit:
            self.tally.faults.append(f"{moment} {share:.3f}: ended with {status}")
        if reported and (strays := left(self.out)):
            self.tally.faults.append(f"{moment} {share:.3f}: left {sorted(strays)}")
        for one in lingering(process.pid):
            self.tally.faults.append(f"{moment} {share:.3f}: process {one.name()} lives on")
            one.kill()
        return hit

    def _look(self, after: str) -> None:
        found = files(self.out)
        self.tally.looked += len(found)
        self.tally.left += len(left(self.out))
        for name in sorted(found):
            if not whole(self.out / name):
                self.tally.faults.append(f"killed at {after}: {name} is not whole")
        for name in sorted(found - self.names):
            self.tally.faults.append(f"killed at {after}: {name} is no output")
        if self._inputs() != self.inputs:
            self.tally.faults.append(f"killed at {after}: an input has changed")

    def end(self, clear: bool) -> None:
        """Run it to its end, which has to put everything right."""
        begun = time.monotonic()
        done = finished(self.command.line, self.folder, self.environment)
        self.pace = Pace(max(time.monotonic() - begun, self.pace.first), self.pace.first, self.pace.steps)
        self.tally.ended += 1
        if done.returncode:
            self.tally.faults.append(f"run again: status {done.returncode}, {done.stderr.strip()[-300:]}")
        if files(self.out) != self.names:
            self.tally.faults.append(f"run again: found {sorted(files(self.out) ^ self.names)} more or less")
        if strays := left(self.out):
            self.tally.faults.append(f"run again: left {sorted(strays)}")
        if clear:
            self._clear()

    def _timed(self, steps: int) -> Pace:
        """Of a run into an empty folder."""
        begun, first, process = time.monotonic(), None, self._start(arguments(self.command.line))
        while process.poll() is None:
            if first is None and state(self.out):
                first = time.monotonic() - begun
            time.sleep(0.002)
        if process.returncode or first is None:
            raise SystemExit(f"bench {self.command.line} failed with {process.returncode}")
        return Pace(time.monotonic() - begun, first, steps)

    def _steps(self) -> int:
        """How many steps its writing has."""
        process = self._start(self._stepping(0))
        if process.wait():
            raise SystemExit(f"bench {self.command.line} failed with {process.returncode}")
        return int((self.temporary / "steps").read_text())

    def _stepping(self, step: int) -> list[str]:
        module = [
            sys.executable,
            "-m",
            "tests.studies.crash.steps",
            str(self.out),
            str(step),
            str(self.temporary / "steps"),
        ]
        return [*module, *self.command.line.split()]

    def _start(self, line: list[str]) -> subprocess.Popen[bytes]:
        silent = subprocess.DEVNULL
        return subprocess.Popen(
            line, cwd=self.folder, env=self.environment, stdout=silent, stderr=silent, start_new_session=True
        )

    def _clear(self) -> None:
        shutil.rmtree(self.out)
        self.out.mkdir()

    def _inputs(self) -> dict[str, str]:
        return {name: value for name, value in hashes(self.folder).items() if not name.startswith("out/")}


def _wait(process: subprocess.Popen[bytes], seconds: float) -> None:
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        return
