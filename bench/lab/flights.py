"""Read a catapult's experiments: a folder or a zip of tables of points (y, z), or one such table."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from bench.arrays import Array
from bench.errors import InputError
from bench.units import convert, dimensionality

ENDINGS = (".csv", ".txt", ".dat", ".tsv")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_UNIT = re.compile(r"\b([yz])\s*(?:[\[(/]\s*)([A-Za-zµ]+)", re.IGNORECASE)
_LABEL = re.compile(r"\b([yz])\b", re.IGNORECASE)


def find_flights(folder: Path) -> Path:
    """The zip, folder or table of a catapult in a folder: the one whose name begins with catapult or Katapult.

    Raises:
        InputError: none.
    """
    for path in sorted(folder.iterdir()):
        named = path.name.lower().startswith(("catapult", "katapult"))
        if named and (path.is_dir() or path.suffix.lower() in (".zip", *ENDINGS)):
            return path
    names = ", ".join(sorted(path.name for path in folder.iterdir())) or "nothing"
    raise InputError(folder / "catapult", "no such folder, zip or table", f"found: {names}")


def read_flights(path: Path) -> list[Array]:
    """Points of each experiment: (n, 2), y and z - m; a table without units is taken as metres.

    Raises:
        InputError: no table in it, or one that is none.
    """
    flights = [_points(name, text) for name, text in _tables(path)]
    if not flights:
        raise InputError(path, "found no table of points", f"allowed: files ending in {', '.join(ENDINGS)}")
    return flights


def _tables(path: Path) -> Iterator[tuple[str, str]]:
    """Name and text of each table, in the order of their names."""
    if path.is_dir():
        for file in sorted(path.rglob("*")):
            if file.suffix.lower() in ENDINGS:
                yield str(file), _text(file.read_bytes(), str(file))
    elif path.suffix.lower() == ".zip":
        try:
            with zipfile.ZipFile(path) as archive:
                for name in sorted(archive.namelist()):
                    hidden = name.startswith("__MACOSX")
                    if Path(name).suffix.lower() in ENDINGS and not hidden:
                        yield f"{path}: {name}", _text(archive.read(name), f"{path}: {name}")
        except (zipfile.BadZipFile, RuntimeError) as error:
            raise InputError(path, f"is no zip that can be read ({error})", "allowed: a complete zip") from error
    else:
        yield str(path), _text(path.read_bytes(), str(path))


def _text(content: bytes, where: str) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(where, "is no UTF-8 text", "allowed: a table of points y, z as text") from error


def _points(where: str, text: str) -> Array:
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    head = lines[0] if lines and re.search(r"[A-DF-Za-df-z]", lines[0]) else ""
    rows = [_numbers(line) for line in lines[1 if head else 0 :]]
    columns = [label.lower() for label in _LABEL.findall(re.sub(r"[\[(][^\])]*[\])]", "", head))] if head else []
    for number, row in enumerate(rows, start=2 if head else 1):
        if row is None or len(row) < 2:
            raise InputError(f"{where}: line {number}", "found no two numbers", "allowed: y and z on each line")
    if len(rows) < 3:
        raise InputError(where, f"found {len(rows)} points", "allowed: at least three, y and z on each line")
    table = np.array([row[-2:] for row in rows if row is not None])
    if columns[-2:] == ["z", "y"]:
        table = table[:, ::-1]
    units = {name.lower(): unit for name, unit in _UNIT.findall(head)}
    return np.stack([_metres(table[:, k], units.get(name), where, name) for k, name in enumerate("yz")], axis=1)


def _numbers(line: str) -> list[float] | None:
    """Numbers of a line; a comma is the decimal sign where something else separates."""
    separated = re.split(r"[;\t]", line) if re.search(r"[;\t]", line) else None
    if separated is not None:
        cells = [cell.strip().replace(",", ".") for cell in separated if cell.strip()]
    else:
        cells = [cell for cell in re.split(r"[,\s]+", line) if cell]
    return [float(cell) for cell in cells] if all(_NUMBER.fullmatch(cell) for cell in cells) else None


def _metres(values: Array, unit: str | None, where: str, name: str) -> Array:
    if unit is None:
        return values
    try:
        known = dimensionality(unit) == "[length]"
    except ValueError:
        known = False
    if not known:
        raise InputError(f"{where}: {name}", f"found the unit '{unit}'", "allowed: a unit of length")
    return convert(values, unit, "m")
