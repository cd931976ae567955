"""One recording of a fleet, evaluated where the work is done: what is known of it becomes plain data.

A recording may lie in a storage that fsspec knows (s3://, gs://, https://, sftp://): it is copied to be read.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any

from fsspec.core import url_to_fs

from bench.bounds import Bounds, require_size, within
from bench.errors import BenchError, InputError, UndeterminedError
from bench.files import sha256
from bench.fit.estimate import Estimate, RefusedEstimateError
from bench.fit.identify import identify
from bench.fit.parameter import Parameter
from bench.gate.check import Check
from bench.gate.gate import UnanswerableError
from bench.rig.rig import Rig
from bench.trace.choose import axes_of
from bench.trace.read import read_recording
from bench.trace.stream import cut
from bench.trace.trace import Trace, assemble

#: What a recording is called in what is said of it: the same whatever its path is, and wherever it was copied to.
CALLED = "recording"
#: Bytes copied from a storage at a time.
_PIECE = 1 << 22
#: One number with its unit, or what was found: as JSON has it.
Plain = dict[str, Any]


@dataclass(frozen=True)
class Job:
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


def evaluate(job: Job) -> Plain:
    """Row of one recording: `done`, or `refused` with the reason, and all that was found."""
    with ExitStack() as stack:
        stack.enter_context(within(job.bounds))
        path, digest = Path(job.place), None
        try:
            if "://" in job.place:
                path = fetched(job.place, Path(stack.enter_context(tempfile.TemporaryDirectory())))
            digest = sha256(path)
            found = _found(_read(path, job), job)
        except RefusedEstimateError as refusal:
            found = {**_estimated(refusal.estimate), **refused(str(refusal))}
        except BenchError as error:
            checks = error.checks if isinstance(error, UnanswerableError) else ()
            found = {"checks": _checks(checks), **refused(str(error).replace(str(path), CALLED))}
        return {**_known(found), "trace_sha256": digest}


def refused(reason: str) -> Plain:
    """Of a recording that cannot answer, or cannot be read."""
    return {"status": "refused", "reason": reason}


def _read(path: Path, job: Job) -> Trace:
    recording = replace(read_recording(path), origin=CALLED)
    axis = job.axis if job.axis in axes_of(recording.channels) else None
    return assemble(recording, job.rig.on_axis(axis).trace)


def _found(trace: Trace, job: Job) -> Plain:
    if not job.diagnose:
        return _estimated(identify(cut(trace), job.rig))
    from bench.diagnosis.diagnosis import diagnose  # MuJoCo: 0.7 s

    found = diagnose(trace, job.rig)
    try:
        explained = identify(cut(trace), job.rig).explained
    except UndeterminedError:  # effects tell apart what J and friction alone leave open
        explained = None
    gaps = {"torque": found.torque, "velocity": found.velocity}
    return {
        **_done(found.parameters, found.checks, found.warnings),
        "explained": explained,
        "verdict": found.verdict,
        "effects": [{"name": effect.name, "parameters": _parameters(effect.parameters)} for effect in found.effects],
        "gap": {name: _gap(gap.unit, gap.noise_floor, *(gap.identify or (None, None))) for name, gap in gaps.items()},
    }


def _estimated(found: Estimate) -> Plain:
    left = found.residual
    return {
        **_done(found.parameters, found.checks, found.warnings),
        "explained": found.explained,
        "gap": {"torque": _gap(left.unit, left.noise_floor, None, left.rms)},
    }


def _done(parameters: Mapping[str, Parameter], checks: Sequence[Check], warnings: Sequence[str]) -> Plain:
    found = {"parameters": _parameters(parameters), "checks": _checks(checks), "warnings": warnings}
    return {"status": "done", "reason": None, **found}


def _gap(unit: str, noise_floor: float, before: float | None, after: float | None) -> Plain:
    """Of torque (force) or velocity, before and after effects were added."""
    return {"unit": unit, "noise_floor": noise_floor, "before": before, "after": after}


def _parameters(found: Mapping[str, Parameter]) -> Plain:
    return {name: asdict(one) for name, one in found.items()}


def _checks(checks: Sequence[Check]) -> list[Plain]:
    """Those that did not pass."""
    notable = [check for check in checks if check.status in ("warn", "fail")]
    return [{"name": c.name, "status": c.status, "found": c.found, "advice": c.advice} for c in notable]


def _known(value: Any) -> Any:  # noqa: ANN401 - whatever JSON has
    """The same as JSON has it: it has no nan, so what is not known is null."""
    if isinstance(value, Mapping):
        return {key: _known(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_known(part) for part in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def marked(url: str) -> str:
    """What the storage calls this version of a file, without reading it: changes whenever the file does.

    Raises:
        InputError: no such file, or a storage that cannot be reached or is not known.
    """
    with _errors_as_input(url):
        storage, path = url_to_fs(url)
        return str(storage.ukey(path))


def fetched(url: str, folder: Path) -> Path:
    """A copy of a file in a folder, under its own name, which may tell its format.

    Raises:
        InputError: as `marked`, or it is too large.
    """
    copy, size = folder / (PurePosixPath(url).name or "trace"), 0
    with _errors_as_input(url):
        storage, path = url_to_fs(url)
        with storage.open(path, "rb") as remote, copy.open("wb") as local:
            while piece := remote.read(_PIECE):
                size += len(piece)
                require_size(url, size)
                local.write(piece)
    return copy


@contextmanager
def _errors_as_input(url: str) -> Iterator[None]:
    try:
        yield
    except (OSError, ValueError, ImportError) as error:  # no file or way to it; no such storage; no package for it
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(url, f"cannot be read ({reason})", "give the URL of a trace that fsspec can open") from error
