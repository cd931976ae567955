"""What the commands make of an exported recording: the right answer, a refusal that asks, or something else."""

from __future__ import annotations

import json
import tempfile
import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.command import bench
from tests.shared import SHARED

EXPORTS = SHARED / "data" / "exports"
TRACEBACK = -1
#: Each parameter under its letter in the truth, and the relative error that an answer may have.
LIMITS = {
    "J": ("moment_of_inertia", "kg*m**2", 0.005),
    "b": ("viscous_friction_coefficient", "N*m*s/rad", 0.03),
    "c": ("coulomb_friction_torque", "N*m", 0.03),
}


@dataclass(frozen=True)
class Outcome:
    """What became of a recording.

    Attributes:
        verdict: `right` as its truth expects; `refused` where an answer is expected; `wrong` otherwise: a number beyond
            its limits, a number where a refusal is expected, or a refusal that does not say what it asks.
        detail: the numbers or the message.
    """

    verdict: str
    detail: str


def truths(folder: Path = EXPORTS) -> dict[str, dict[str, Any]]:
    """What is expected of each recording; empty where the recordings are absent."""
    path = folder / "truth.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def score(folder: Path, truth: dict[str, Any]) -> Outcome:
    """Run the commands over a recording as the recordings' README says."""
    file, rig = folder / truth["file"], folder / "rig.toml"
    with tempfile.TemporaryDirectory() as place:
        result = Path(place) / "result.json"
        status, message = _run("identify", str(file), "--rig", str(rig), "--json", str(result))
        found = json.loads(result.read_text(encoding="utf-8")) if status == 0 else {}
    if truth["expect"] == "refuse":
        return _refusal(status, message, truth["words"])
    seen, complaint = _run("inspect", str(file))
    if status == 0:
        errors = {letter: _error(found["parameters"], letter, truth[letter]) for letter in LIMITS}
        detail = ", ".join(f"{letter} {error:+.2%}" for letter, error in errors.items())
        if any(not abs(error) <= LIMITS[letter][2] for letter, error in errors.items()):
            return Outcome("wrong", detail)
        return Outcome("right", detail) if seen == 0 else Outcome("refused", f"inspect: {complaint}")
    return Outcome("refused" if status in (1, 2) else "wrong", f"{status}: {message}")


def _refusal(status: int, message: str, words: list[list[str]]) -> Outcome:
    asks = all(any(word in message for word in choice) for choice in words)
    return Outcome("right" if status in (1, 2) and asks else "wrong", f"{status}: {message}")


def _error(parameters: dict[str, Any], letter: str, truth: float) -> float:
    """Relative error; nan where the parameter is missing or stands in another unit."""
    name, unit, _ = LIMITS[letter]
    found = parameters.get(name)
    return found["value"] / truth - 1.0 if found and found["unit"] == unit else float("nan")


def _run(*arguments: str) -> tuple[int, str]:
    """Exit status of a command and what it says on standard error; a traceback is no status of the bench's."""
    try:
        ended = bench(*arguments)
    except Exception:
        return TRACEBACK, traceback.format_exc()
    return ended.status, " ".join(ended.err.split())
