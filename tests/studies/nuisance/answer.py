"""What the bench answers to files, asked as a user asks: by its command line, read from its JSON and exit status."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.command import bench

#: Keys of J in the JSON.
INERTIA = ("moment_of_inertia", "moving_mass")
#: Exit status of a fault of the bench itself.
FAULT = 70


@dataclass(frozen=True)
class Answer:
    """What a command said.

    Attributes:
        status: exit status; 70 also for what ends in a traceback.
        said: its line on standard error, or what it raised.
        verdict, named: of `diagnose`, empty for `identify` - named by kind.
        inertia: value and 95 % interval, None where there is none - kg*m**2 (kg).
        checks: status by name.
        complaints: what checks that do not pass and warnings say.
        seconds: it took.
    """

    status: int
    said: str = ""
    verdict: str = ""
    named: tuple[str, ...] = ()
    inertia: tuple[float, float, float] | None = None
    checks: tuple[tuple[str, str], ...] = ()
    complaints: tuple[str, ...] = ()
    seconds: float = 0.0

    @property
    def refused(self) -> bool:
        """Whether the data, or a check of them, ended it."""
        return self.status in (1, 2) or any(status == "fail" for _, status in self.checks)

    @property
    def fault(self) -> bool:
        """Whether it ended in a fault of the bench."""
        return self.status not in (0, 1, 2)


def ask(command: str, traces: Sequence[Path], rig: Path, *options: str) -> Answer:
    """The answer of `bench identify` or `bench diagnose`.

    Its JSON goes beside the first recording, so that one may look into it.
    """
    path = traces[0].with_name(f"{command}.json")
    path.unlink(missing_ok=True)
    arguments = [command, *map(str, traces), "--rig", str(rig), "--json", str(path), *options]
    start = time.perf_counter()
    status, said = _run(arguments)
    seconds = time.perf_counter() - start
    content = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    parameters = content.get("parameters") or {}
    j = next((parameters[key] for key in INERTIA if parameters.get(key)), None)
    checks = content.get("checks", [])
    complaints = [*content.get("warnings", []), said]
    complaints += [
        f"{check['name']}: {check['found']}" for check in checks if check["status"] not in ("pass", "not_applicable")
    ]
    return Answer(
        status,
        said,
        content.get("verdict", ""),
        tuple(effect["name"] for effect in content.get("effects", [])),
        None if j is None else (j["value"], *j["ci95"]),
        tuple((check["name"], check["status"]) for check in checks),
        tuple(complaints),
        seconds,
    )


def _run(arguments: Sequence[str]) -> tuple[int, str]:
    """Exit status, and what was said on standard error, of the command line run in this process."""
    try:
        ended = bench(*arguments)
    except Exception as fault:  # a traceback is an answer too, and a bad one
        return FAULT, f"{type(fault).__name__}: {fault}"
    return ended.status, " ".join(ended.err.split())
