"""What a result rests on, so that anybody can tell whether two came from the same: version, files, options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench import __version__
from bench.files import sha256
from bench.names import readable


def provenance(
    rig: Path | None,
    traces: Sequence[Path],
    options: Mapping[str, Any],
    holdout: Path | None = None,
    mjcf: Path | None = None,
) -> dict[str, Any]:
    """The contract's `provenance`.

    Args:
        rig: file of the axis; None of a joint that only an MJCF knows.
        traces: files of the recordings, in the order given.
        options: of the command that change its result.
        holdout: file of the recording that was not fitted.
        mjcf: file of the robot around the axis.

    Raises:
        InputError: a file cannot be read.
    """
    found = {
        "version": __version__,
        "rig_sha256": None if rig is None else sha256(rig),
        "traces": [{"file": readable(trace), "sha256": sha256(trace)} for trace in traces],
        "options": dict(options),
    }
    beside = {"holdout": holdout, "mjcf": mjcf}
    given = {key: path for key, path in beside.items() if path is not None}
    return found | {key: {"file": readable(path), "sha256": sha256(path)} for key, path in given.items()}


def without_files(options: Mapping[str, Any]) -> dict[str, Any]:
    """The same of what rests on no file.

    Args:
        options: of the command that change its result.
    """
    return {"version": __version__, "rig_sha256": None, "traces": [], "options": dict(options)}
