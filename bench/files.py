"""Input and output files: every fault of an input is a clear error, outputs appear whole or not at all."""

from __future__ import annotations

import hashlib
import os
import re
import secrets
import stat
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from contextvars import ContextVar
from dataclasses import dataclass, field
from io import BufferedReader
from pathlib import Path

from bench.bounds import require_size
from bench.errors import InputError

#: Bytes that are taken at a time.
_PIECE = 1 << 20
#: Device and inode of a file.
Identity = tuple[int, int]


@dataclass(frozen=True)
class _Touched:
    """Files of the running command: all that it has read or will read, and those that it made itself."""

    read: set[Identity] = field(default_factory=set)
    made: set[Identity] = field(default_factory=set)


_TOUCHED: ContextVar[_Touched | None] = ContextVar("touched", default=None)
#: Files by which a folder is one recording, and the endings of its files that are read.
_OF_FOLDERS, _READ = ("meta/info.json", "metadata.yaml"), (".parquet", ".json", ".yaml", ".db3", ".mcap")
#: Ending of lock files, and names of those of files that are being written.
_LOCK = ".lock"
_UNDER_WAY = re.compile(r"\.bench-[0-9a-f]{12}-.*\.lock", re.DOTALL)


def marker(path: Path) -> Path:
    """The file itself, or of a folder that is one recording the file that describes it."""
    found = (path / name for name in _OF_FOLDERS) if path.is_dir() else ()
    return next((file for file in found if file.is_file()), path)


def read_bytes(path: str | Path, kind: str, replaced: bool = False) -> bytes:
    """Content of a regular file; `kind` is what it should be, for messages, e.g. `a trace`.

    InputError: not there, not a regular file, not readable, or beyond the bound on size.
    """
    with opened(Path(path), kind, replaced) as file:
        require_size(path, size := os.fstat(file.fileno()).st_size)
        return file.read(size)


@contextmanager
def opened(path: Path, kind: str, replaced: bool = False) -> Iterator[BufferedReader]:
    """A regular file, open for reading; an input of the running command from then on, unless it is to be `replaced`.

    Whatever the bench reads that is no part of it is opened here. Raises as `read_bytes`.
    """
    give = f"give the path of {kind}"
    try:
        state = path.stat()
        if stat.S_ISDIR(state.st_mode):
            raise InputError(path, "found a folder", give)
        if not stat.S_ISREG(state.st_mode):  # a pipe may never end, a device has no end
            raise InputError(path, "found a pipe or a device", f"{give}, a regular file")
        with path.open("rb") as file:
            made = hasattr(os, "fstatvfs") and not os.fstatvfs(file.fileno()).f_blocks  # /proc, /sys
            if made and not state.st_size:
                raise InputError(path, "found a file that the system makes while it is read", f"{give}, a regular file")
            touched, own = _TOUCHED.get(), _identity(os.fstat(file.fileno()))
            if touched is not None and not replaced and own not in touched.made:
                touched.read.add(own)
            yield file
    except FileNotFoundError as error:
        raise InputError(path, "no such file", give) from error
    except (OSError, ValueError) as error:  # ValueError: a null character in the path
        raise InputError(path, f"cannot be read ({reason(error)})", give) from error


def read_text(path: str | Path, kind: str, replaced: bool = False) -> str:
    """Content of a regular file that is UTF-8 text, its line ends as they are; arguments and errors of `read_bytes`."""
    content = read_bytes(path, kind, replaced)
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        found = f"found byte 0x{content[error.start]:02x}, which is not UTF-8"
        raise InputError(f"{path}: line {line}", found, f"allowed: {kind}, in UTF-8") from error


def sha256(path: Path) -> str:
    """SHA-256 of a file, or of those of a recording's folder, in digits; raises as `read_bytes`, but for its size."""
    digest = hashlib.sha256()
    if marker(path) != path:
        files = sorted(file for file in path.rglob("*") if file.suffix in _READ and file.is_file())
        return hashlib.sha256("".join(map(sha256, files)).encode()).hexdigest()
    with opened(path, "a file") as file:
        left = os.fstat(file.fileno()).st_size
        while left > 0 and (piece := file.read(min(left, _PIECE))):
            digest.update(piece)
            left -= len(piece)
    return digest.hexdigest()


def reason(error: Exception) -> str:
    """The system's message of an error, without the path."""
    return (isinstance(error, OSError) and error.strerror) or str(error) or type(error).__name__


@contextmanager
def keeping(inputs: Iterable[Path]) -> Iterator[None]:
    """Until the outermost such block ends no output replaces one of these files, nor any read within, by any link."""
    outer = _TOUCHED.get()
    touched = outer or _Touched()
    for path in inputs:
        with suppress(OSError, ValueError):  # there is none, which reading it will report
            touched.read.add(_identity(path.stat()))
    token = _TOUCHED.set(touched)
    try:
        yield
    finally:
        _TOUCHED.reset(token)


def _identity(state: os.stat_result) -> Identity:
    return state.st_dev, state.st_ino


def require_writable(path: str | Path) -> Path:
    """The file of an output, links resolved; InputError if it is an input, a folder, a pipe, a device or a loop."""
    path = Path(path)
    try:
        target = path.resolve()
        state = target.stat() if os.path.lexists(target) else None
    except (OSError, RuntimeError, ValueError) as error:  # RuntimeError: a loop, before Python 3.13
        raise InputError(path, f"cannot be written ({reason(error)})", "name a file that can be written") from error
    if state is None:
        return target
    if (touched := _TOUCHED.get()) is not None and _identity(state) in touched.read - touched.made:
        raise InputError(path, "is an input of this command, which an output may not replace", "name another file")
    if stat.S_ISDIR(state.st_mode):
        raise InputError(path, "found a folder", "name a file")
    if not stat.S_ISREG(state.st_mode):
        raise InputError(path, "found a pipe or a device", "name a regular file, or - where standard output is allowed")
    return target


@contextmanager
def whole(path: str | Path, lasting: bool = True) -> Iterator[Path]:
    """A temporary path next to `path` that takes its name once the block has ended well, and is gone otherwise.

    The file is on the disk before it takes the name, unless it is one of many that can be made again (not `lasting`).
    Links are followed; permissions are those of the file that is replaced, else what the umask allows. Its folder is
    made; files of runs that were killed while they wrote to it are removed. InputError: it cannot be written to, or is
    an input.
    """
    target = require_writable(path)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        _remove_unfinished(target.parent)
        temporary = target.with_name(f".bench-{secrets.token_hex(6)}-{target.stem[:32]}{target.suffix[-16:]}")
        with _locked(temporary.with_name(temporary.name + _LOCK)):
            try:
                temporary.touch(exist_ok=False)  # 0o666 less the umask
                if target.exists():
                    temporary.chmod(stat.S_IMODE(target.stat().st_mode))
                yield temporary
                if lasting:
                    _flush(temporary, os.O_RDWR)
                temporary.replace(target)
                if (touched := _TOUCHED.get()) is not None:
                    touched.made.add(_identity(target.stat()))
                if lasting and os.name == "posix":  # Windows opens no folder
                    _flush(target.parent, os.O_RDONLY)
            finally:
                temporary.unlink(missing_ok=True)
    except OSError as error:
        found = f"cannot be written ({reason(error)})"
        raise InputError(path, found, "name a file in a folder that can be written to") from error


def _remove_unfinished(folder: Path) -> None:
    """Remove files of runs that were killed while they wrote: those whose lock no process has."""
    for name in filter(_UNDER_WAY.fullmatch, os.listdir(folder)):  # noqa: PTH208 (a name is enough)
        with suppress(OSError), _locked(folder / name, wait=False):  # a Timeout, too: another process writes it
            (folder / name.removesuffix(_LOCK)).unlink(missing_ok=True)


def _flush(path: Path, flags: int) -> None:
    """Flush a file, or the names in a folder, to the disk."""
    handle = os.open(path, flags)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


@contextmanager
def _locked(path: Path, wait: bool = True) -> Iterator[None]:
    """Hold a lock file, which is removed in the end; this thread may hold it more than once."""
    from filelock import FileLock  # 0.03 s

    lock = FileLock(path, is_singleton=True)
    with lock.acquire(blocking=wait):
        try:
            yield
        finally:
            if lock.lock_counter == 1:
                with suppress(OSError):  # Windows removes it with the lock
                    path.unlink()


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Make a folder and lock it for writing: another run of the bench waits until this one is done."""
    with ExitStack() as stack:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            stack.enter_context(_locked(folder.resolve() / f".bench{_LOCK}"))
        except (OSError, ValueError) as error:
            found = f"cannot be written to ({reason(error)})"
            raise InputError(folder, found, "name a folder that can be written to") from error
        yield


def write_text(path: str | Path, text: str, lasting: bool = True) -> None:
    """Write a text file, UTF-8, whole or not at all; what no text may hold (half a surrogate) is written as \\udc80."""
    with whole(path, lasting) as temporary:
        temporary.write_bytes(text.encode("utf-8", errors="backslashreplace"))
