"""What a result rests on, so that anybody can tell whether two came from the same: version, files, options."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench import __version__
from bench.errors import InputError


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
        "traces": [{"file": str(trace), "sha256": sha256(trace)} for trace in traces],
        "options": dict(options),
    }
    beside = {"holdout": holdout, "mjcf": mjcf}
    given = {key: path for key, path in beside.items() if path is not None}
    return found | {key: {"file": str(path), "sha256": sha256(path)} for key, path in given.items()}


def sha256(path: Path) -> str:
    """Of a file as it lies there, in hexadecimal digits.

    Raises:
        InputError: it cannot be read.
    """
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "give the path of a file") from error
