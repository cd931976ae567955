"""One recording of a fleet, evaluated where the work is done: what is known of it becomes plain data."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from bench.bounds import Bounds, within
from bench.errors import BenchError, UndeterminedError
from bench.files import sha256
from bench.fit.estimate import Estimate, RefusedEstimateError
from bench.fit.identify import identify
from bench.fit.parameter import Parameter
from bench.fleet.remote import fetched
from bench.gate.check import Check
from bench.gate.gate import UnanswerableError
from bench.rig.rig import Rig
from bench.trace.choose import axes_of
from bench.trace.read import read_recording
from bench.trace.stream import cut
from bench.trace.trace import Trace, assemble

#: What a recording is called in what is said of it: the same whatever its path is, and wherever it was copied to.
CALLED = "recording"
#: One number with its unit, or what was found: as JSON has it.
Plain = dict[str, Any]


@dataclass(frozen=True)
class Task:
    """One recording to be evaluated.

    Attributes:
        place: path, or URL of a storage that fsspec knows.
        axis: to be read, where the file holds several and one has this name.
        rig: of the axis.
        diagnose: whether effects are sought too.
        bounds: on the size of files.
    """

    place: str
    axis: str
    rig: Rig
    diagnose: bool
    bounds: Bounds


def evaluate(task: Task) -> Plain:
    """Row of one recording: `done`, or `refused` with the reason, and all that was found."""
    with ExitStack() as stack:
        stack.enter_context(within(task.bounds))
        path, digest = Path(task.place), None
        try:
            if "://" in task.place:
                path = fetched(task.place, Path(stack.enter_context(tempfile.TemporaryDirectory())))
            digest = sha256(path)
            return {**_found(_read(path, task), task), "trace_sha256": digest}
        except RefusedEstimateError as refusal:
            return {**_estimated(refusal.estimate), **refused(str(refusal)), "trace_sha256": digest}
        except BenchError as error:
            checks = error.checks if isinstance(error, UnanswerableError) else ()
            reason = str(error).replace(str(path), CALLED)
            return {"checks": _checks(checks), **refused(reason), "trace_sha256": digest}


def refused(reason: str) -> Plain:
    """Of a recording that cannot answer, or cannot be read."""
    return {"status": "refused", "reason": reason}


def _read(path: Path, task: Task) -> Trace:
    recording = replace(read_recording(path), origin=CALLED)
    axis = task.axis if task.axis in axes_of(recording.channels) else None
    return assemble(recording, task.rig.on_axis(axis).trace)


def _found(trace: Trace, task: Task) -> Plain:
    if not task.diagnose:
        return _estimated(identify(cut(trace), task.rig))
    from bench.diagnosis.diagnosis import diagnose  # MuJoCo: 0.7 s

    found = diagnose(trace, task.rig)
    try:
        explained = _number(identify(cut(trace), task.rig).explained)
    except UndeterminedError:  # effects tell apart what J and friction alone leave open
        explained = None
    gaps = {"torque": found.torque, "velocity": found.velocity}
    return {
        **_done(found.parameters, found.checks, found.warnings),
        "explained": explained,
        "verdict": found.verdict,
        "effects": [{"name": effect.name, "parameters": _parameters(effect.parameters)} for effect in found.effects],
        "gap": {
            name: {
                "unit": gap.unit,
                "noise_floor": _number(gap.noise_floor),
                "before": None if gap.identify is None else _number(gap.identify[0]),
                "after": None if gap.identify is None else _number(gap.identify[1]),
            }
            for name, gap in gaps.items()
        },
    }


def _estimated(found: Estimate) -> Plain:
    left = found.residual
    gap = {"unit": left.unit, "noise_floor": _number(left.noise_floor), "before": None, "after": _number(left.rms)}
    return {
        **_done(found.parameters, found.checks, found.warnings),
        "explained": _number(found.explained),
        "gap": {"torque": gap},
    }


def _done(parameters: Mapping[str, Parameter], checks: Sequence[Check], warnings: Sequence[str]) -> Plain:
    return {
        "status": "done",
        "reason": None,
        "parameters": _parameters(parameters),
        "checks": _checks(checks),
        "warnings": list(warnings),
    }


def _parameters(found: Mapping[str, Parameter]) -> Plain:
    return {
        name: {
            "value": _number(one.value),
            "unit": one.unit,
            "std_error": _number(one.std_error),
            "ci95": [_number(bound) for bound in one.ci95],
        }
        for name, one in found.items()
    }


def _checks(checks: Sequence[Check]) -> list[Plain]:
    """Those that did not pass."""
    notable = [check for check in checks if check.status in ("warn", "fail")]
    return [{"name": c.name, "status": c.status, "found": c.found, "advice": c.advice} for c in notable]


def _number(value: float) -> float | None:
    """JSON has no nan: what is not known is null."""
    return value if math.isfinite(value) else None
