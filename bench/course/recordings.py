"""The recordings of the course in a folder, a student's or the synthetic ones, and each in SI as the tasks take it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from bench.arrays import Array
from bench.assets import asset
from bench.course.axis import Sources, embedded, lab_rig, torque_constant
from bench.course.flights import Flights, find_flights, read_flights
from bench.errors import InputError, UndeterminedError
from bench.files import read_text
from bench.fit.lab import backward_difference
from bench.names import nearest
from bench.plant.simulate import truth_path
from bench.rig.rig import Rig, load_rig
from bench.structured import parse_json
from bench.trace.channel import Recording
from bench.trace.choose import choose, reading_options
from bench.trace.read import read_recording, readers
from bench.trace.trace import Trace, assemble

WITHOUT_FRICTION, WITH_FRICTION, FASTEST = "JLoadWithoutFriction", "JLoadAndFriction", "MaxAcc"
#: Signals that the tasks need.
NEEDED = ("velocity", "current")
#: Endings of recordings; a truth is JSON too, and none of the course's.
ENDINGS = {ending for reader in readers() for ending in reader.endings} - {".json"}
#: A shorter recording is no run of the course.
LEAST = 100


@dataclass(frozen=True)
class LabRun:
    """One recording, signals (n,).

    Attributes:
        time: s.
        velocity: omega - rad/s.
        current: Iq - A.
        acceleration: alpha, backward difference of the speed - rad/s**2.
        torque: kT(Iq)*Iq - N*m.
        angle: from the start on - rad; as recorded, else the integral of the speed.
        sample_period: s.
        truth: values of the simulated axis by their names - SI; empty for a real one.
    """

    time: Array
    velocity: Array
    current: Array
    acceleration: Array
    torque: Array
    angle: Array
    sample_period: float
    truth: Mapping[str, float] = field(default_factory=dict)

    def true(self, name: str, factor: float = 1.0) -> float | None:
        """True value of a quantity times a factor that changes its unit; None on a real axis."""
        return self.truth[name] * factor if name in self.truth else None

    def at(self, samples: NDArray[np.bool_]) -> LabRun:
        """Some samples of it alone, told by (n,)."""
        signals = ("time", "velocity", "current", "acceleration", "torque", "angle")
        return replace(self, **{name: getattr(self, name)[samples] for name in signals})


def run_of(trace: Trace, rig: Rig, truth: Mapping[str, float] | None = None) -> LabRun:
    """Signals of a recording, its longest stretch without a hole.

    Raises:
        UndeterminedError: fewer than LEAST samples.
        InputError: no velocity or current in it, a linear axis, or no torque constant in the rig.
    """
    if not trace.axis_kind.turns:
        allowed = "allowed: a rotary one, velocity in deg/s, rad/s or rpm"
        raise InputError(trace.origin, f"found a {trace.axis_kind.name} axis", allowed)
    part = max(trace.segments, key=lambda segment: segment.stop - segment.start)
    velocity, current = trace["velocity"][part], trace["current"][part]
    if velocity.size < LEAST:
        reason = f"{trace.origin} has {velocity.size} samples in a row, {LEAST} are the least"
        raise UndeterminedError("motion", reason, "the whole run without holes")
    if "position" in trace:
        angle = trace["position"][part] - trace["position"][part.start]
    else:
        angle = cumulative_trapezoid(velocity, dx=trace.sample_period, initial=0.0)
    return LabRun(
        time=trace.time[part] - trace.time[part.start],
        velocity=velocity,
        current=current,
        acceleration=backward_difference(velocity, trace.sample_period),
        torque=torque_constant(rig).torque(current),
        angle=angle,
        sample_period=trace.sample_period,
        truth=truth or {},
    )


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
            raise InputError(folder, "no such folder", "give the folder that holds the course's recordings")
        own = folder / "rig.toml"
        if not own.exists():
            return cls(folder, lab_rig(), Sources.of(None))
        kept = {key: value for key, value in embedded().items() if key != "simulation"}
        return cls(folder, load_rig(own, kept), Sources.of(own))

    @cached_property
    def without_friction(self) -> LabRun:
        """The fast run, friction switched off; raises as `run`."""
        return self.run(WITHOUT_FRICTION)

    @cached_property
    def with_friction(self) -> LabRun:
        """The same, friction switched on; raises as `run`."""
        return self.run(WITH_FRICTION)

    @cached_property
    def fastest(self) -> LabRun:
        """The run-up with full torque; raises as `run`."""
        return self.run(FASTEST)

    @cached_property
    def flights(self) -> Flights:
        """The catapult's experiments, with the throw's truth where that lies beside them; raises as `read_flights`."""
        path = find_flights(self.folder)
        return replace(read_flights(path), truth=read_truth(path / "truth.json"))

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
        missing = f"no such file{nearest(f'{name}.trace', others)}"
        raise InputError(self.folder / f"{name}.trace", missing, f"found: {', '.join(others) or 'no recording'}")

    def run(self, name: str) -> LabRun:
        """A recording in SI units, with its truth where that lies beside it.

        Raises:
            InputError: no such file, not a recording, or a signal missing in it.
        """
        path = self.path(name)
        recording = read_recording(path)
        _require_signals(recording, path, self.rig.trace.columns)
        return run_of(assemble(recording, self.rig.trace), self.rig, read_truth(truth_path(path)))


def read_truth(path: Path) -> Mapping[str, float]:
    """True values by their names - SI; empty where there is no such file. Raises InputError where it is no truth."""
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
