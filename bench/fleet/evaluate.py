"""One recording of a fleet, evaluated where the work is done: what is known of it becomes plain data.

A recording may lie in a storage of fsspec (s3://, gs://, https://, sftp://): it is copied to be read.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

from fsspec.core import url_to_fs

from bench import __version__
from bench.bounds import Bounds, bounds, require_size, within
from bench.errors import BenchError, InputError, UndeterminedError
from bench.files import sha256
from bench.fit.estimate import Estimate, RefusedEstimateError
from bench.fit.identify import identify
from bench.fleet.manifest import Manifest
from bench.fleet.store import Plain, digest
from bench.gate.check import Check
from bench.gate.gate import UnanswerableError
from bench.jobs.each import each
from bench.jobs.process import Failure, Limits
from bench.names import short
from bench.parameter import Parameter
from bench.rig.rig import Rig, load_rig
from bench.trace.choose import axes_of
from bench.trace.read import read_recording
from bench.trace.stream import cut
from bench.trace.trace import Trace, assemble

if TYPE_CHECKING:
    from bench.diagnosis.diagnosis import Diagnosis

#: Storages that a manifest may name: those that only send files. fsspec has others that start programs or unpack.
STORAGES = ("https", "http", "s3", "gs", "gcs", "az", "abfs", "sftp", "ssh")
#: What a recording is called in messages: the same whatever its path is, and wherever it was copied to.
CALLED = "recording"
#: Bytes copied from a storage at a time.
_PIECE = 1 << 22


@dataclass(frozen=True)
class Job:
    """One recording to be evaluated: its path, or URL of a storage of fsspec; `diagnose`: are effects sought
    too.

    The axis of this name is read where the file has several and one has it.
    """

    place: str
    axis: str
    rig: Rig
    diagnose: bool
    bounds: Bounds


def evaluate(job: Job) -> Plain:
    """Row of one recording: `done`, or `missing` or `refused` with the reason, and all that was found."""
    with within(job.bounds), ExitStack() as stack:
        path, digest = Path(job.place), None
        try:
            if "://" in job.place:
                path = fetched(job.place, Path(stack.enter_context(tempfile.TemporaryDirectory())))
            digest = sha256(path)
            recording = replace(read_recording(path), origin=CALLED)
            axis = job.axis if job.axis in axes_of(recording.channels) else None
            trace = assemble(recording, job.rig.on_axis(axis).trace)
            found = _found(trace, job)
            found["warnings"] = [*dict.fromkeys((*trace.notes, *found["warnings"]))]
        except RefusedEstimateError as refusal:
            found = {**_estimated(refusal.estimate), **refused(refusal, str(refusal))}
        except BenchError as error:
            checks = error.checks if isinstance(error, UnanswerableError) else ()
            found = {"checks": _checks(checks), **refused(error, str(error).replace(str(path), CALLED))}
        return {**_known(found), "trace_sha256": digest}


def refused(error: BenchError, reason: str) -> Plain:
    """Of a recording that is not there, cannot be read, or cannot answer."""
    status = "missing" if isinstance(error.__cause__, FileNotFoundError) else "refused"
    return {"status": status, "reason": reason}


def _found(trace: Trace, job: Job) -> Plain:
    if not job.diagnose:
        return _estimated(identify(cut(trace), job.rig))

    from bench.diagnosis.diagnosis import diagnose  # MuJoCo: 0.7 s

    found = diagnose(trace, job.rig)
    try:
        explained = identify(cut(trace), job.rig).explained
    except UndeterminedError:  # effects distinguish what J and friction alone leave open
        explained = None
    gaps = {"torque": found.torque, "velocity": found.velocity}
    return {
        **_done(found, explained),
        "verdict": found.verdict,
        "effects": [{"name": effect.name, "parameters": _parameters(effect.parameters)} for effect in found.effects],
        "gap": {name: _gap(gap.unit, gap.noise_floor, *(gap.identify or (None, None))) for name, gap in gaps.items()},
    }


def _estimated(found: Estimate) -> Plain:
    left = found.residual
    return {**_done(found, found.explained), "gap": {"torque": _gap(left.unit, left.noise_floor, None, left.rms)}}


def _done(found: Estimate | Diagnosis, explained: float | None) -> Plain:
    return {
        "status": "done",
        "reason": None,
        "parameters": _parameters(found.parameters),
        "checks": _checks(found.checks),
        "warnings": found.warnings,
        "explained": explained,
    }


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


def marked(url: str, storages: Sequence[str] = STORAGES) -> str:
    """What the storage calls this version of a file, without reading it: changes whenever the file does.

    InputError where there is no such file, or a storage that is not one of these, or cannot be reached.
    """
    if other := [name for link in url.split("::") if (name := link.partition("://")[0]) not in storages]:
        allowed = f"allowed: {', '.join(storages)}, or a path; --storage allows another storage of fsspec"
        raise InputError(url, f"found the storage '{short(other[0])}'", allowed)
    with _errors_as_input(url):
        storage, path = url_to_fs(url)
        return str(storage.ukey(path))


def fetched(url: str, folder: Path) -> Path:
    """A copy of a file in a folder, under its own name, which may determine its format.

    InputError as `marked`, or where it is too large.
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


@dataclass(frozen=True)
class PlannedRecording:
    """One recording of the manifest: the key of its result and the job, or why it cannot be begun, as a result.

    `basis` is what its result is based on, for the table.
    """

    key: str
    job: Job | None
    refusal: Plain | None
    basis: Plain


def plan(
    manifest: Manifest,
    diagnose: bool,
    storages: Sequence[str],
    limits: Limits | None,
    workers: int | None,
    progress: Callable[[float], None],
) -> list[PlannedRecording]:
    """Every recording of the manifest, in its order; InputError where an effect of another package is none.

    Rigs are read and recordings distinguished in worker processes, within the limits of one recording.
    """
    options: Plain = {"diagnose": diagnose, "bounds": [str(value) for value in asdict(bounds()).values()]}
    if diagnose:
        from bench.effects.catalogue import catalogue

        options["effects"] = sorted(catalogue())

    places, rigs, axes = manifest.located("file"), manifest.located("rig"), manifest.text("axis")
    asked = [*(("rig", rig) for rig in dict.fromkeys(rigs)), *(("file", place) for place in dict.fromkeys(places))]
    known = dict[tuple[str, str], Any]()
    for number, result in each(partial(_looked_at, (*STORAGES, *storages), bounds()), asked, limits, workers):
        known[asked[number]] = asdict(result) if isinstance(result, Failure) else result
        progress(len(known) / len(asked))
    rows = zip(places, axes, rigs, strict=True)
    return [_planned(place, known["file", place], axis, known["rig", rig], options) for place, axis, rig in rows]


def _looked_at(storages: Sequence[str], limits: Bounds, asked: tuple[str, str]) -> tuple[Rig, str] | str | Plain:
    """A rig with the hash of its file, or what identifies the content of a recording's file; or what is wrong.

    A rig has a name, and a refusal a text, that are the same wherever the file lies.
    """
    column, place = asked
    try:
        with within(limits):
            if column == "rig":
                return load_rig(place).model_copy(update={"source": "rig"}), sha256(Path(place))
            return marked(place, storages) if "://" in place else sha256(Path(place))
    except InputError as error:
        if column == "rig":
            return refused(error, str(InputError(error.where.replace(place, "rig"), error.found, error.allowed)))
        return refused(error, str(error).replace(place, CALLED))


def _planned(
    place: str, mark: str | Plain, axis: str, rig: tuple[Rig, str] | Plain, options: Plain
) -> PlannedRecording:
    """A recording with all that its result depends on: trace, axis, rig, version and the options."""
    basis: Plain = {"version": __version__, "rig_sha256": None, "options": options}
    if isinstance(rig, dict):
        return PlannedRecording("", None, rig, basis)
    basis["rig_sha256"] = rig[1]
    if isinstance(mark, dict):
        return PlannedRecording("", None, mark, basis)
    parts = {"trace": mark, "axis": axis, **basis}
    return PlannedRecording(digest(parts), Job(place, axis, rig[0], options["diagnose"], bounds()), None, basis)
