"""The recordings of the course in a folder: a student's, or the synthetic ones that travel with the bench."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bench.assets import asset
from bench.errors import InputError
from bench.lab.rig import lab_rig
from bench.lab.run import Run, run_of
from bench.plant.truth import truth_path
from bench.rig.rig import Rig, load_rig
from bench.trace.read import read, read_recording
from bench.trace.readers import READERS
from bench.trace.trace import Trace
from bench.units import nearest

WITHOUT_FRICTION, WITH_FRICTION, FASTEST = "JLoadWithoutFriction", "JLoadAndFriction", "MaxAcc"
#: Signals that the tasks need.
NEEDED = ("velocity", "current")
#: Endings of recordings; a truth is JSON too, and none of the course's.
ENDINGS = {ending for reader in READERS for ending in reader.ENDINGS} - {".json"}


@dataclass(frozen=True)
class Recordings:
    """A folder of recordings.

    Attributes:
        folder: where they lie.
        rig: of the axis: `rig.toml` in the folder, else the lab's.
    """

    folder: Path
    rig: Rig

    @classmethod
    def in_folder(cls, folder: Path | None) -> Recordings:
        """Recordings of a folder, or the synthetic ones.

        Raises:
            InputError: no such folder, or a bad rig file in it.
        """
        if folder is None:
            return cls(asset("data", "traces"), lab_rig())
        if not folder.is_dir():
            raise InputError(folder, "no such folder", "give the folder that holds the course's recordings")
        own = folder / "rig.toml"
        return cls(folder, load_rig(own) if own.exists() else lab_rig())

    def path(self, name: str) -> Path:
        """File of a recording, whatever its ending and the case of its letters.

        Raises:
            InputError: none, or several.
        """
        files = sorted(path for path in self.folder.iterdir() if path.is_file() and _ending(path) in ENDINGS)
        found = [path for path in files if _stem(path) == name.lower()]
        if len(found) == 1:
            return found[0]
        if found:
            names = ", ".join(path.name for path in found)
            raise InputError(self.folder / f"{name}.trace", f"found several ({names})", "allowed: one of them")
        others = [path.name for path in files]
        hint = nearest(f"{name}.trace", others)
        raise InputError(
            self.folder / f"{name}.trace", f"no such file{hint}", f"found: {', '.join(others) or 'no recording'}"
        )

    def run(self, name: str) -> Run:
        """A recording in SI units, with its truth where that lies beside it.

        Raises:
            InputError: no such file, not a recording, or a signal missing in it.
        """
        path = self.path(name)
        trace = read(path, self.rig.trace.columns)
        _require_signals(trace, path)
        return run_of(trace, self.rig, read_truth(truth_path(path)))


def read_truth(path: Path) -> Mapping[str, float]:
    """True values by their names - SI; empty where there is no such file.

    Raises:
        InputError: a truth file that is none.
    """
    if not path.exists():
        return {}
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        return {name: float(item["value"]) for name, item in content["parameters"].items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(path, f"is no truth of a simulated trace ({error})", "remove it, or record again") from error


def _ending(path: Path) -> str:
    """Of the file inside, where it is compressed."""
    return Path(path.name.lower().removesuffix(".gz")).suffix


def _stem(path: Path) -> str:
    return path.name.split(".")[0].lower()


def _require_signals(trace: Trace, path: Path) -> None:
    missing = [name for name in NEEDED if name not in trace]
    if not missing:
        return
    labels = ", ".join(f"'{channel.label}'" for channel in read_recording(path).channels)
    raise InputError(
        path,
        f"holds no {' and no '.join(missing)} by a name the bench knows; its columns are {labels}",
        f'name them in a rig.toml beside it, e.g. [trace.columns] {missing[0]} = "column [unit]"',
    )
