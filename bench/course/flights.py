"""Read a catapult's experiments: a folder or a zip of tables of points (y, z), or one such table or MAT file."""

from __future__ import annotations

import re
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from bench.arrays import Array
from bench.bounds import read_bounded
from bench.course.flight_table import flights_of_mat, flights_of_text
from bench.errors import InputError
from bench.files import read_bytes

TEXTS = (".csv", ".txt", ".dat", ".tsv")
ENDINGS = (*TEXTS, ".mat")
NAMES = ("catapult", "katapult", "flights", "fluege", "flüge")
#: Files that tell about the tables beside them.
_ABOUT = re.compile(r"(read[ _-]?me|lies[ _-]?mich|license|notes?|notiz(en)?|info|hinweise?)\b.*", re.IGNORECASE)
#: Lengths without a unit are metres; no ball of the lab flies further than this - m.
FARTHEST = 20.0


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

    A folder serves before a zip, which it may have come from, and a zip before a table.

    Raises:
        InputError: none, or several of a kind.
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
        plain = Path(name).name
        if _ABOUT.fullmatch(Path(name).stem):
            notes.append(f"{plain} passed over, as its name says that it holds no flight.")
            continue
        read = flights_of_mat if name.lower().endswith(".mat") else flights_of_text
        found = read(content, name)
        if not found.has_units:
            _require_metres(found.points, name)
        points += found.points
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
            with zipfile.ZipFile(path) as archive:
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


def _require_metres(points: list[Array], where: str) -> None:
    farthest = max(float(np.ptp(flight, axis=0).max()) for flight in points)
    if farthest > FARTHEST:
        raise InputError(
            where, f"found lengths that span {farthest:.4g} without a unit", "name it in the first line: y [mm],z [mm]"
        )
