"""What lies in a folder: which files read to their end, which are left over, and whose they are."""

from __future__ import annotations

import ast
import gzip
import hashlib
import json
import os
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import psutil
import pyarrow.parquet as pq

#: How files of other kinds end.
ENDS = {".png": b"IEND\xaeB`\x82", ".pdf": b"%%EOF", ".html": b"</html>", ".csv": b"\n"}
#: Processes of a command that is gone are gone after this - s.
GONE = 10.0


def _ends(path: Path) -> bool:
    content = path.read_bytes()
    return content.endswith((ENDS[path.suffix], ENDS[path.suffix] + b"\n"))


READS: dict[str, Callable[[Path], object]] = {
    ".gz": lambda path: gzip.decompress(path.read_bytes()).endswith(b"\n"),
    ".json": lambda path: json.loads(path.read_bytes()),
    ".toml": lambda path: tomllib.loads(path.read_text()),
    ".xml": lambda path: ElementTree.fromstring(path.read_bytes()) is not None,
    ".parquet": lambda path: pq.read_table(path).num_rows,
    ".py": lambda path: ast.parse(path.read_text()).body,
}


def whole(path: Path) -> bool:
    """Whether a file reads to its end, and holds something."""
    try:
        return bool(READS.get(path.suffix, _ends)(path))
    except (ValueError, EOFError, OSError, SyntaxError, ElementTree.ParseError):
        return False


def files(folder: Path) -> set[str]:
    """Paths in it of what is meant to be seen."""
    found = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)) for path in found if not path.name.startswith(".")}


def left(folder: Path) -> set[str]:
    """Paths in it of files that were under way."""
    return {str(path.relative_to(folder)) for path in folder.rglob(".*")}


def hashes(folder: Path) -> dict[str, str]:
    """Of every file in it, by its path there."""
    return {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in sorted(files(folder))}


def state(folder: Path) -> dict[str, tuple[int, int, int]]:
    """Number, size and time of everything in it; tells whether something was written since."""
    found = {}
    for path in folder.rglob("*"):
        try:
            status = path.lstat()
        except FileNotFoundError:  # renamed meanwhile
            continue
        found[str(path)] = status.st_ino, status.st_size, status.st_mtime_ns
    return found


def lingering(session: int) -> list[psutil.Process]:
    """Processes of a session that outlive its first one by more than they may."""
    until = time.monotonic() + GONE
    while alive := [process for process in psutil.process_iter() if _of(process, session)]:
        if time.monotonic() > until:
            return alive
        time.sleep(0.02)
    return []


def _of(process: psutil.Process, session: int) -> bool:
    try:
        return os.getsid(process.pid) == session and process.status() != psutil.STATUS_ZOMBIE
    except (ProcessLookupError, PermissionError, psutil.NoSuchProcess):
        return False
