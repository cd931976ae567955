"""The recordings of the course in a folder: a student's, or the synthetic ones that travel with the bench."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bench.assets import asset
from bench.course.rig import lab_rig
from bench.course.run import Run, run_of
from bench.course.sources import Sources, embedded
from bench.errors import InputError
from bench.files import read_text
from bench.names import nearest
from bench.plant.simulate import truth_path
from bench.rig.rig import Rig, load_rig
from bench.structured import parse_json
from bench.trace.channel import Recording
from bench.trace.choose import choose
from bench.trace.read import read_recording
from bench.trace.readers.catalogue import readers
from bench.trace.reading_options import reading_options
from bench.trace.trace import assemble

WITHOUT_FRICTION, WITH_FRICTION, FASTEST = "JLoadWithoutFriction", "JLoadAndFriction", "MaxAcc"
#: Signals that the tasks need.
NEEDED = ("velocity", "current")
#: Endings of recordings; a truth is JSON too, and none of the course's.
ENDINGS = {ending for reader in readers() for ending in reader.endings} - {".json"}


@dataclass(frozen=True)
class Recordings:
    """A folder of recordings.

    Attributes:
        folder: where they lie.
        rig: of the axis: `rig.toml` in the folder; what that leaves out, motor, disk or all, is the lab's.
        sources: where its values come from.
        synthetic: whether they are the ones that travel with the bench.
    """

    folder: Path
    rig: Rig
    sources: Sources
    synthetic: bool = False

    @classmethod
    def in_folder(cls, folder: Path | None) -> Recordings:
        """Recordings of a folder, or the synthetic ones.

        Raises:
            InputError: no such folder, or a bad rig file in it.
        """
        if folder is None:
            return cls(asset("data", "traces"), lab_rig(), Sources.of(None), synthetic=True)
        if not folder.is_dir():
            raise InputError(folder, "no such folder", "give the folder that holds the course's recordings")
        own = folder / "rig.toml"
        if not own.exists():
            return cls(folder, lab_rig(), Sources.of(None))
        kept = {key: value for key, value in embedded().items() if key != "simulation"}
        return cls(folder, load_rig(own, kept), Sources.of(own))

    @property
    def example(self) -> Rig:
        """A rig that can be simulated: the recorded axis where its rig file says how, else the lab's."""
        given = self.sources.given
        return self.rig if "simulation" in given and "drive" in given else lab_rig()

    def path(self, name: str) -> Path:
        """File of a recording, whatever its ending, the case of its letters, and what else its name says.

        `MaxAcc_Gruppe7.trace` and `MaxAcc (1).trace` serve where there is no plain `MaxAcc.trace`.

        Raises:
            InputError: none, or several.
        """
        files = sorted(path for path in self.folder.iterdir() if path.is_file() and _ending(path) in ENDINGS)
        found = [path for path in files if path.name.split(".")[0].lower() == name.lower()]
        found = found or [path for path in files if name.lower() in _letters(path)]
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
        recording = read_recording(path)
        _require_signals(recording, path, self.rig.trace.columns)
        return run_of(assemble(recording, self.rig.trace), self.rig, read_truth(truth_path(path)))


def read_truth(path: Path) -> Mapping[str, float]:
    """True values by their names - SI; empty where there is no such file.

    Raises:
        InputError: a truth file that is none.
    """
    if not path.exists():
        return {}
    content = parse_json(read_text(path, "a truth"), path)
    try:
        return {name: float(item["value"]) for name, item in content["parameters"].items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(path, f"is no truth of a simulated trace ({error})", "remove it, or record again") from error


def _ending(path: Path) -> str:
    """Of the file inside, where it is compressed."""
    return Path(path.name.lower().removesuffix(".gz")).suffix


def _letters(path: Path) -> str:
    return re.sub("[^a-z]", "", path.name.split(".")[0].lower())


def _require_signals(recording: Recording, path: Path, columns: Mapping[str, str]) -> None:
    chosen, _ = choose(recording, reading_options(columns))
    missing = [name for name in NEEDED if name not in chosen]
    if not missing:
        return
    labels = ", ".join(f"'{channel.label}'" for channel in recording.channels)
    raise InputError(
        path,
        f"holds no {' and no '.join(missing)} by a name the bench knows; its columns are {labels}",
        "write a file rig.toml beside it with the line [trace.columns] and under it a line for each, "
        f'e.g. {missing[0]} = "column [unit]"; what else a rig file has may be left out',
    )
