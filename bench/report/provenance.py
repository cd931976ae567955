"""What a result rests on, so that anybody can tell whether two came from the same: version, files, options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench import __version__
from bench.files import sha256


def provenance(
    rig: Path, traces: Sequence[Path], options: Mapping[str, Any], holdout: Path | None = None
) -> dict[str, Any]:
    """The contract's `provenance`.

    Args:
        rig: file of the axis.
        traces: files of the recordings, in the order given.
        options: of the command that change its result.
        holdout: file of the recording that was not fitted.

    Raises:
        InputError: a file cannot be read.
    """
    found = {
        "version": __version__,
        "rig_sha256": sha256(rig),
        "traces": [{"file": str(trace), "sha256": sha256(trace)} for trace in traces],
        "options": dict(options),
    }
    return found if holdout is None else found | {"holdout": {"file": str(holdout), "sha256": sha256(holdout)}}
