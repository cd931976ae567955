"""The recordings of the course in a folder, a student's or the synthetic ones, and each in SI as the tasks take it."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from bench.assets import asset
from bench.course.axis import Sources, embedded, lab_rig
from bench.course.causes import refusals
from bench.course.flights import Flights, contradiction, find_flights, read_flights
from bench.course.plausible import FASTEST, WITH_FRICTION, WITHOUT_FRICTION
from bench.course.run import LabRun, run_of
from bench.errors import BenchError, InputError
from bench.files import read_text
from bench.names import nearest
from bench.plant.simulate import truth_path
from bench.rig.rig import Rig, load_rig
from bench.structured import parse_json
from bench.trace.channel import Recording
from bench.trace.choose import choose, reading_options
from bench.trace.read import read_recording, readers
from bench.trace.trace import assemble

#: Signals that the tasks need.
NEEDED = ("velocity", "current")
#: Endings of recordings; a truth is JSON too, and none of the course's.
ENDINGS = {ending for reader in readers() for ending in reader.endings} - {".json"}


@dataclass(frozen=True)
class LabRecordings:
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
    def in_folder(cls, folder: Path | None) -> LabRecordings:
        """Recordings of a folder, or the synthetic ones; raises InputError without it, or with a bad rig file in it."""
        if folder is None:
            return cls(asset("data", "traces"), lab_rig(), Sources.of(None), synthetic=True)
        if not folder.is_dir():
            raise InputError(folder, "no such folder", "give the folder with the course's recordings")
        own = folder / "rig.toml"
        if not own.exists():
            return cls(folder, lab_rig(), Sources.of(None))
        kept = {key: value for key, value in embedded().items() if key != "simulation"}
        return cls(folder, load_rig(own, kept), Sources.of(own))

    @cached_property
    def without_friction(self) -> LabRun:
        """The fast run, friction switched off; raises as `sound`."""
        return self.sound(WITHOUT_FRICTION)

    @cached_property
    def with_friction(self) -> LabRun:
        """The same, friction switched on; raises as `sound`."""
        return self.sound(WITH_FRICTION)

    @cached_property
    def fastest(self) -> LabRun:
        """The run-up with full torque; raises as `sound`."""
        return self.sound(FASTEST)

    @cached_property
    def flights(self) -> Flights:
        """The catapult's experiments, with the throw's truth where that is next to them.

        Raises InputError as `read_flights`, and where they are no flights of one throw.
        """
        path = find_flights(self.folder)
        found = read_flights(path)
        if wrong := contradiction(found.points):
            raise InputError(path, wrong, "correct or omit what is wrong: all points go into one path")
        return replace(found, truth=read_truth(path / "truth.json"))

    @property
    def example(self) -> Rig:
        """A rig that can be simulated: the recorded axis where its rig file states how, else the lab's."""
        given = self.sources.given
        return self.rig if "simulation" in given and "drive" in given else lab_rig()

    @cached_property
    def readable(self) -> Mapping[str, LabRun]:
        """Recordings that can be read, whether or not they can be of the axis."""
        runs = {}
        for name in (WITHOUT_FRICTION, WITH_FRICTION, FASTEST):
            with suppress(BenchError):  # raised where a task needs it
                runs[name] = self._read(name)
        return runs

    @cached_property
    def refused(self) -> Mapping[str, str]:
        """Recordings that cannot be of the rig's axis, each with the reason."""
        return refusals(self.readable, self.rig)

    def sound(self, name: str) -> LabRun:
        """A recording that nothing contradicts; InputError with what does and why, and raises as `run`."""
        run = self.run(name)
        if name in self.refused:
            raise InputError(self.files(name)[0], *self.refused[name].split("; ", 1))
        return run

    def files(self, name: str) -> tuple[Path, list[Path]]:
        """File of a recording, whatever its ending, the case of its letters, and the rest of its name; and others.

        `MaxAcc_Gruppe7.trace` and `MaxAcc (1).trace` serve where there is no plain `MaxAcc.trace`. Raises InputError
        where there is none, or several.
        """
        files = sorted(path for path in self.folder.iterdir() if path.is_file())
        files = [path for path in files if Path(path.name.lower().removesuffix(".gz")).suffix in ENDINGS]
        stems = {path: path.name.split(".")[0].lower() for path in files}
        alike = [path for path, stem in stems.items() if name.lower() in re.sub("[^a-z]", "", stem)]
        found = [path for path, stem in stems.items() if stem == name.lower()] or alike
        if len(found) == 1:
            return found[0], [path for path in alike if path != found[0]]
        if found:
            names = ", ".join(path.name for path in found)
            raise InputError(self.folder / f"{name}.trace", f"found several ({names})", "allowed: one of them")
        others = [path.name for path in files]
        missing = f"no such file{nearest(f'{name}.trace', others)}"
        if unread := _of_another_format(self.folder, name.lower()):
            raise InputError(self.folder / unread, NO_RECORDING.format(Path(unread).suffix), SAVE)
        raise InputError(self.folder / f"{name}.trace", missing, f"found: {', '.join(others) or 'no recording'}")

    def run(self, name: str) -> LabRun:
        """A recording in SI units as it is, with its truth where that is next to it.

        Raises InputError where there is no such file, it is no recording, or a signal is missing in it.
        """
        return self.readable[name] if name in self.readable else self._read(name)

    def _read(self, name: str) -> LabRun:
        path, others = self.files(name)
        columns = self.rig.trace.columns
        recording = read_recording(path)
        chosen, _ = choose(recording, reading_options(columns))
        if missing := [name for name in NEEDED if name not in chosen]:
            labels = ", ".join(f"'{channel.label}'" for channel in recording.channels)
            raise InputError(
                path,
                f"found no column for {' and '.join(missing)}; its columns are {labels}",
                f"write {_lines(chosen, recording)} into a rig.toml next to it, each with its own column and unit; "
                "the rest of a rig file is optional",
            )
        notes = tuple(f"{other.name} passed over, as {path.name} has the name of the course." for other in others)
        return run_of(assemble(recording, self.rig.trace), self.rig, read_truth(truth_path(path)), notes)


#: What a file is that has a recording's name and an ending that no reader has, and what to do.
NO_RECORDING, SAVE = "is no recording, as files ending in {} are not read", "save it as CSV, or hand in the .trace"


def _of_another_format(folder: Path, name: str) -> str:
    """A file of a recording's name whose ending no reader has; empty without one."""
    files = (path for path in sorted(folder.iterdir()) if path.is_file() and path.suffix.lower() not in ENDINGS)
    stems = ((path.name, re.sub("[^a-z]", "", path.stem.lower())) for path in files if not path.name.endswith(".json"))
    return next((file for file, stem in stems if stem.startswith(name)), "")


def _lines(chosen: Collection[str], recording: Recording) -> str:
    """Lines of a rig file for the signals that a recording lacks, with its own columns in their order."""
    free = [channel.name for channel in recording.channels if "time" not in channel.name.lower()]
    units = {"velocity": "rad/s", "current": "A"}
    missing = [name for name in NEEDED if name not in chosen]
    named = zip(missing, [*free, *["column"] * len(missing)], strict=False)
    return " and ".join(["[trace.columns]", *(f'{name} = "{column} [{units[name]}]"' for name, column in named)])


def read_truth(path: Path) -> Mapping[str, float]:
    """True values by their names - SI; empty where there is no such file. Raises InputError where it is no truth."""
    if not path.exists():
        return {}
    content = parse_json(read_text(path, "a truth"), path)
    try:
        return {name: float(item["value"]) for name, item in content["parameters"].items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(path, f"is no truth of a simulated trace ({error})", "remove it, or record again") from error
