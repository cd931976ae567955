"""Read a catapult's experiments: a folder or a zip of tables of points (y, z), or one such table or MAT file.

Of each file it is found which columns are y and z, of one flight or of several side by side, and in which unit. Then
whether they are flights of one throw: each falls, its points lie on a path, the paths are alike. What does not is named
with the mistake without which it would: axes exchanged, another unit, mirrored, one point off.
"""

from __future__ import annotations

import re
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path

import numpy as np

from bench.arrays import Array, rms
from bench.bounds import read_bounded
from bench.course.mistakes import MISTAKES
from bench.errors import InputError
from bench.files import opened, read_bytes
from bench.trace.channel import Channel
from bench.trace.readers.named_arrays import load_mat
from bench.trace.readers.table import TABLE
from bench.trace.source import source_of
from bench.units import convert

TEXTS = (".csv", ".txt", ".dat", ".tsv")
ENDINGS = (*TEXTS, ".mat")
NAMES = ("catapult", "katapult", "flights", "fluege", "flüge")
#: Files that describe the tables next to them.
_ABOUT = re.compile(r"(read[ _-]?me|lies[ _-]?mich|license|notes?|notiz(en)?|info|hinweise?)\b.*", re.IGNORECASE)
#: Lengths without a unit are metres; no ball of the lab flies further than this - m.
FARTHEST = 20.0
#: Name of a column, with the flight's number where several stand side by side, and its unit.
_LABEL = re.compile(r"\W*([^\W\d_]+)[ _]*(\d*)\s*(?:(?:[\[(/]|\bin\b)\s*([^\])]*?)[\])]?)?\W*")
#: How a line of numbers begins.
_NUMBER_FIRST = re.compile(r"\s*[+-]?[.,]?\d")
#: Names of a column that numbers the flights.
_FLIGHT_NUMBERS = ("flight", "experiment", "versuch", "flug", "nr", "no", "wurf")
#: A path has at least so many points: a parabola through fewer is no fit.
LEAST = 3
_ADVICE = "y and z on each line, named in the first one: y [m],z [m]"

#: A point is off by so many times the usual distance from its path, a flight's path by so many from the others'. Of
#: 200,000 tens of simulated flights, each with its scatter of the launch, the furthest were 6.9 and 15.3 times.
POINT, PATH = 7.0, 16.0
#: However much paths scatter, those of one throw are not further from their middle than this share of their height.
APART = 0.5
#: A flight has at least so many points more than its parabola has coefficients.
SPARE = 3
#: Points of each flight, (n, 2) y and z - m, and whether the file states their unit.
FoundFlights = tuple[list[Array], bool]


@dataclass(frozen=True)
class Flights:
    """What a catapult's files hold.

    Attributes:
        points: of each experiment, (n, 2) y and z - m.
        notes: what was passed over to get them.
        truth: a - 1/m, b, c - m of the throw without scatter; empty for real ones.
    """

    points: list[Array]
    notes: tuple[str, ...] = ()
    truth: Mapping[str, float] = field(default_factory=dict)


def find_flights(folder: Path) -> Path:
    """The folder, zip or table of a catapult in a folder: the one whose name begins with catapult or Katapult.

    A folder serves before a zip, which it may have come from, and a zip before a table. Raises InputError where none is
    there, or several of a kind.
    """
    named = [path for path in sorted(folder.iterdir()) if path.name.lower().startswith(NAMES)]
    kinds = (
        [path for path in named if path.is_dir()],
        [path for path in named if path.suffix.lower() == ".zip"],
        [path for path in named if path.is_file() and path.suffix.lower() in ENDINGS],
    )
    for found in kinds:
        if len(found) == 1:
            return found[0]
        if found:
            names = ", ".join(path.name for path in found)
            raise InputError(folder / "catapult", f"found several ({names})", "put all flights into one folder")
    if named:
        found = f"is no table that can be read, as files ending in {named[0].suffix} are not"
        raise InputError(named[0], found, f"save it as CSV: {_ADVICE}")
    names = ", ".join(sorted(path.name for path in folder.iterdir())) or "nothing"
    raise InputError(folder / "catapult", "no such folder, zip or table", f"found: {names}")


def read_flights(path: Path) -> Flights:
    """Flights of a folder, zip or table; lengths without a unit are taken as metres.

    Raises:
        InputError: no table in it, one that is none, or lengths without a unit that cannot be metres.
    """
    points: list[Array] = []
    notes: list[str] = []
    for name, content in _files(path):
        if _ABOUT.fullmatch(Path(name).stem):
            notes.append(f"{Path(name).name} passed over, as its name is that of a note.")
            continue
        found, has_units = (_of_mat if name.lower().endswith(".mat") else _of_text)(content, name)
        farthest = max(float(np.ptp(flight, axis=0).max()) for flight in found)
        if not has_units and farthest > FARTHEST:
            spans = f"found lengths that span {farthest:.4g} without a unit"
            raise InputError(name, spans, "name it in the first line: y [mm],z [mm]")
        points += found
    if not points:
        raise InputError(path, "found no table of points", f"allowed: files ending in {', '.join(ENDINGS)}")
    return Flights(points, tuple(notes))


def _files(path: Path) -> Iterator[tuple[str, bytes]]:
    """Name and content of each file that may be a table, in the order of their names."""
    if path.is_dir():
        for file in sorted(path.rglob("*")):
            if file.suffix.lower() in ENDINGS and not file.name.startswith("."):
                yield str(file), read_bytes(file, "a table of points")
    elif path.suffix.lower() == ".zip":
        try:
            with opened(path, "a zip of tables") as file, zipfile.ZipFile(file) as archive:
                for name in sorted(archive.namelist()):
                    hidden = name.startswith("__MACOSX") or Path(name).name.startswith(".")
                    if Path(name).suffix.lower() in ENDINGS and not hidden:
                        where = f"{path}: {name}"
                        with archive.open(name) as packed:
                            yield where, read_bounded(packed, where, archive.getinfo(name).compress_size)
        except (zipfile.BadZipFile, zlib.error, RuntimeError, EOFError, OSError, NotImplementedError) as error:
            raise InputError(path, f"is no zip that can be read ({error})", "allowed: a complete zip") from error
    else:
        yield str(path), read_bytes(path, "a table of points")


def _of_text(content: bytes, where: str) -> FoundFlights:
    """Flights of a table: columns y and z, of one flight or numbered; or below each other, numbered by a column."""
    channels = _channels(content, where)
    matches = (_LABEL.fullmatch(channel.name) for channel in channels)
    labels = [(match[1].lower(), match[2]) if match else ("", "") for match in matches]
    if not {"y", "z"} <= {name for name, _ in labels}:
        labels = [(name, "") for name in _unnamed(channels, where)]
    sides = [(place, label) for place, label in enumerate(labels) if label[0] in ("y", "z")]
    values, stated = {}, True
    for place, label in sides:
        values[label], has_unit = _metres(channels[place])
        stated &= has_unit
    numbers = list(dict.fromkeys(number for _, number in values))
    if len(values) < len(sides) or {(side, number) for number in numbers for side in "yz"} != set(values):
        allowed = "allowed: y1,z1,y2,z2, ... or one y and one z"
        raise InputError(where, "found columns y and z that do not pair", allowed)
    points = [np.stack([values["y", number], values["z", number]], axis=1) for number in numbers]
    numbering = [channels[place].values for place, (name, _) in enumerate(labels) if name in _FLIGHT_NUMBERS]
    if numbering and len(points) == 1:
        flight = numbering[0]
        points = [points[0][flight == one] for one in dict.fromkeys(flight[np.isfinite(flight)].tolist())]
    return _checked(points, where), stated


def _channels(content: bytes, where: str) -> Sequence[Channel]:
    """Columns of a table; InputError where a line of numbers is not like the others."""
    try:
        source = source_of(where, content)
        channels = TABLE.read(source).channels
    except InputError as error:
        raise InputError(error.where, error.found, f"allowed: at least three points, {_ADVICE}") from error
    if defect := next((channel.defect for channel in channels if channel.defect), None):
        raise defect
    above = list(enumerate(source.text().splitlines(), 1))[: (channels[0].line or 1) - 1]
    number, last = next((one for one in reversed(above) if one[1].strip()), (0, ""))
    if _NUMBER_FIRST.match(last):
        found = f"found other cells than below ({last[:40]!r})"
        raise InputError(f"{where}: line {number}", found, f"allowed: {_ADVICE}")
    return channels


def _unnamed(channels: Sequence[Channel], where: str) -> str:
    """Names of columns without: two are y and z, of three the first is a time that runs evenly."""
    width, steps = len(channels), np.diff(channels[0].values)
    even = steps.size > 0 and steps.min() > 0.0 and np.ptp(steps) <= 0.02 * steps.max()
    unnamed = all(channel.name.startswith("column ") for channel in channels)
    if width == 2 or (width == 3 and even and unnamed):
        return "tyz"[-width:]
    names = ", ".join(channel.label for channel in channels)
    raise InputError(where, f"found no columns y and z ({names[:60]})", f"allowed: {_ADVICE}")


def _metres(channel: Channel) -> tuple[Array, bool]:
    """Values of a column, and whether its unit is stated, as `y [mm]`, `y / mm` or `y in mm`."""
    match = _LABEL.fullmatch(channel.name)
    unit = channel.unit or (match[3] if match else None)
    try:
        return convert(channel.values, unit or "m", "m"), bool(unit)
    except ValueError as error:
        raise InputError(channel.place(), f"found the unit '{unit}'", "allowed: a unit of length") from error


def _of_mat(content: bytes, where: str) -> FoundFlights:
    arrays = {name: value for name, value in load_mat(content, where).items() if not name.startswith("__")}
    return _checked(_matrices(arrays), where), False


def _pairs(arrays: Mapping[str, np.ndarray]) -> list[Array]:
    """y and z (n, 2) of each flight from variables of these names, numbered or not, one flight a column."""
    pairs: list[Array] = []
    for name, y in arrays.items():
        match = re.fullmatch(r"y_?(\d*)", name)
        z = arrays.get("z" + name[1:]) if match else None
        if z is None or z.shape != y.shape or y.dtype.kind not in "fiu" or not 1 <= y.ndim <= 2:
            continue
        columns = (y, z) if y.ndim == 2 else (y[:, None], z[:, None])
        pairs += [*np.stack(columns, axis=-1).astype(np.float64).swapaxes(0, 1)]
    return pairs


def _matrices(value: object) -> list[Array]:
    """Matrices of two columns y, z, or three with a time first; in cells, structs or (flights, n, 2) arrays too."""
    if isinstance(value, dict):
        pairs = _pairs({name.lower(): np.asarray(side) for name, side in value.items()})
        return pairs or [matrix for side in value.values() for matrix in _matrices(side)]
    if isinstance(value, list) or (isinstance(value, np.ndarray) and (value.dtype == object or value.ndim == 3)):
        return [matrix for part in value for matrix in _matrices(part)]
    if not isinstance(value, np.ndarray) or value.dtype.kind not in "fiu" or value.ndim != 2:
        return []
    matrix = value if value.shape[1] in (2, 3) else value.T
    if matrix.shape[1] == 2:
        return [matrix.astype(np.float64)]
    return [matrix[:, 1:].astype(np.float64)] if matrix.shape[1] == 3 and np.all(np.diff(matrix[:, 0]) > 0) else []


def _checked(points: Sequence[Array], where: str) -> list[Array]:
    """Points of each flight that have both y and z."""
    flights = [flight[np.isfinite(flight).all(axis=1)] for flight in points]
    for number, flight in enumerate(flights, 1):
        if len(flight) < LEAST:
            name = f"{where}: flight {number}" if len(flights) > 1 else where
            raise InputError(name, f"found {len(flight)} points", f"allowed: at least three, {_ADVICE}")
    if not flights:
        raise InputError(where, "found no points", f"allowed: at least three, {_ADVICE}")
    return flights


def contradiction(flights: Sequence[Array]) -> str:
    """What no flights of one throw - (n, 2) y, z in m - can show, and why; empty where all can be."""
    if any(len(flight) < LEAST + SPARE for flight in flights):
        return ""
    for (j, one), (k, other) in combinations(enumerate(flights, 1), 2):
        if np.array_equal(one, other):
            return f"flights {j} and {k} are one and the same"
    wrong = list(_wrong(flights))
    if not wrong:
        return ""
    faults = [f"flight {k + 1} {found}: {_why(flights, k)}" for k, found in wrong]
    turned = [flight[:, ::-1] for flight in flights]
    if len(wrong) > len(flights) // 2:
        return "y and z of all flights look exchanged" if not [*_wrong(turned)] else f"most flights: {faults[0]}"
    return "; ".join(faults)


def _wrong(flights: Sequence[Array]) -> Iterator[tuple[int, str]]:
    """Flights that are no such, and what is wrong with them."""
    paths = [np.polyfit(flight[:, 0], flight[:, 1], 2) for flight in flights]
    off = [flight[:, 1] - np.polyval(path, flight[:, 0]) for flight, path in zip(flights, paths, strict=True)]
    usual = float(np.median([rms(one) for one in off]))
    middle = np.median(paths, axis=0)
    beside = [np.polyval(path - middle, flight[:, 0]) for flight, path in zip(flights, paths, strict=True)]
    apart = [float(np.sqrt(np.mean(one**2))) for one in beside]
    alike = max(float(np.median(apart)), usual)
    for k, path in enumerate(paths):
        if path[0] >= 0.0:
            yield k, f"does not fall, its a is {path[0]:+.3g} 1/m"
        elif np.abs(off[k]).max() > POINT * usual:
            yield k, f"has a point {np.abs(off[k]).max():.2g} m off its path, {usual:.2g} m are usual"
        elif apart[k] > min(PATH * alike, APART * np.ptp(flights[k][:, 1])):
            yield k, f"is {apart[k]:.2g} m off the path of the others, {alike:.2g} m are usual"
        elif usual > 0.1 * np.ptp(flights[k][:, 1]):
            yield k, f"has points {usual:.2g} m off its path, which itself spans {np.ptp(flights[k][:, 1]):.2g} m"


def _why(flights: Sequence[Array], k: int) -> str:
    """The mistake without which flight k is like the others."""
    flight, others = flights[k], [one for j, one in enumerate(flights) if j != k]

    def fits(one: Array) -> bool:
        return all(place < len(others) for place, _ in _wrong([*others, one]))

    for mistake in MISTAKES:
        if mistake.undo_of_flight and fits(mistake.undo_of_flight(flight)):
            return mistake.words
    for j, (y, z) in enumerate(flight.tolist()):
        if fits(np.delete(flight, j, axis=0)):
            return f"its point {j + 1}, ({y:.4g}, {z:.4g}) m, is an outlier"
    return "no known mistake explains it"
