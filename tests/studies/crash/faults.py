"""A full disk, a folder that cannot be written to, two runs with one folder: one line, and nothing lost."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tests.hostile import bound_by_permissions
from tests.studies.crash.commands import Command, arguments, finished, make_inputs
from tests.studies.crash.look import files, hashes, left, whole

#: Shares of what a command writes that a disk has room for, or one file may have.
SHARES = (0.0, 0.02, 0.1, 0.3, 0.6, 0.9)


@dataclass
class Outcome:
    """Runs and faults; about: how it was tried."""

    runs: int = 0
    faults: list[str] = field(default_factory=list)
    about: str = ""


def full_disk(command: Command, folder: Path, shares: Sequence[float] = SHARES) -> Outcome:
    """Write where one file (RLIMIT_FSIZE) or, as root, the whole file system (a small tmpfs) has no room for it all."""
    make_inputs(folder)
    out, environment, outcome = folder / "out", dict(os.environ), Outcome()
    if finished(command.line, folder, environment).returncode:
        return Outcome(1, ["a run without a limit failed"])
    before, sizes = hashes(out), [path.stat().st_size for path in out.rglob("*") if path.is_file()]
    for share in shares:
        limit = int(share * max(sizes))
        _refused(command, folder, environment, before, outcome, f"files of {limit} bytes", limit)
    if os.geteuid() == 0:
        for share in filter(None, shares):
            room = max(4096, int(share * sum(sizes)) // 4096 * 4096)
            shutil.rmtree(out)
            out.mkdir()
            mounted = subprocess.run(
                ["mount", "-t", "tmpfs", "-o", f"size={room}", "tmpfs", str(out)], check=False, capture_output=True
            )
            if mounted.returncode:
                outcome.about = "(no tmpfs may be mounted: limits of file size alone)"
                break
            try:
                _refused(command, folder, environment, None, outcome, f"disk of {room} bytes")
            finally:
                subprocess.run(["umount", str(out)], check=True)
    return outcome


def _refused(
    command: Command,
    folder: Path,
    environment: dict[str, str],
    before: dict[str, str] | None,
    outcome: Outcome,
    what: str,
    limit: int | None = None,
    before_it: Sequence[str] = (),
) -> None:
    """A run that has to end in one line, with every file whole or as it was."""

    def confine() -> None:
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    done = subprocess.run(
        [*before_it, *arguments(command.line)], cwd=folder, env=environment, capture_output=True, text=True,
        errors="replace", check=False, preexec_fn=confine,
    )  # fmt: skip
    outcome.runs += 1
    lines = [line for line in done.stderr.splitlines() if line.startswith("bench: ")]
    if done.returncode not in (0, 2) or (done.returncode == 2 and len(lines) != 1):
        outcome.faults.append(f"{what}: status {done.returncode}, {done.stderr.strip()[-400:]}")
    out = folder / "out"
    outcome.faults += [f"{what}: {name} is not whole" for name in files(out) if not whole(out / name)]
    if strays := left(out):
        outcome.faults.append(f"{what}: left {sorted(strays)}")
    if before is not None and (gone := set(before) - files(out)):
        outcome.faults.append(f"{what}: {sorted(gone)} lost")
    if before is not None and len(before) == 1 and done.returncode and hashes(out) != before:
        outcome.faults.append(f"{what}: refused, and its only output is another one")


def read_only(command: Command, folder: Path) -> Outcome:
    """Write into a folder that permissions close; root does it without its right to pass over them."""
    bound = bound_by_permissions()
    if bound is None:
        return Outcome(about="(not tried: root, and no setpriv)")
    make_inputs(folder)
    out, outcome = folder / "out", Outcome()
    if finished(command.line, folder, dict(os.environ)).returncode:
        return Outcome(1, ["a run into a folder of one's own failed"])
    before = hashes(out)
    for path in (out, *(path for path in out.rglob("*") if path.is_dir())):
        path.chmod(0o555)
    _refused(command, folder, dict(os.environ), before, outcome, "read-only folder", before_it=bound)
    if hashes(out) != before:
        outcome.faults.append("read-only folder: something in it has changed")
    for path in (out, *(path for path in out.rglob("*") if path.is_dir())):
        path.chmod(0o755)
    return outcome


def two_writers(command: Command, folder: Path) -> Outcome:
    """Two runs at once: each succeeds or is refused in one line, and what lies there is all from one of them."""
    make_inputs(folder)
    out, environment, outcome = folder / "out", dict(os.environ), Outcome()
    alone = []
    for line in (command.line, command.other):
        runs = []
        for _ in range(2):
            shutil.rmtree(out)
            out.mkdir()
            finished(line, folder, environment)
            runs.append(hashes(out))
        alone.append({name: value for name, value in runs[0].items() if runs[1].get(name) == value})
    telling = {name for name in alone[0].keys() & alone[1].keys() if alone[0][name] != alone[1][name]}
    outcome.about = f"({len(telling)} files tell whose they are)"
    for _ in range(3):
        shutil.rmtree(out)
        out.mkdir()
        lines = (command.line, command.other)
        pipe = subprocess.PIPE
        both = [
            subprocess.Popen(arguments(line), cwd=folder, env=environment, stdout=pipe, stderr=pipe, text=True)
            for line in lines
        ]
        for line, process in zip(lines, both, strict=True):
            error = process.communicate()[1]
            if process.returncode not in (0, 2) or (process.returncode == 2 and error.count("\n") != 1):
                outcome.faults.append(f"{line}: status {process.returncode}, {error.strip()[-300:]}")
        outcome.runs += 2
        outcome.faults += [f"{name} is not whole" for name in files(out) if not whole(out / name)]
        if strays := left(out):
            outcome.faults.append(f"left {sorted(strays)}")
        now = hashes(out)
        whose = {name: [now.get(name) == one[name] for one in alone].index(True) for name in telling
                 if now.get(name) in (alone[0][name], alone[1][name])}  # fmt: skip
        outcome.faults += [f"{name} is neither's" for name in telling - whose.keys()]
        if len(set(whose.values())) > 1:
            outcome.faults.append(f"files of both: {whose}")
    return outcome


FAULTS: dict[str, Callable[[Command, Path], Outcome]] = {
    "full disk": full_disk,
    "read-only folder": read_only,
    "two writers": two_writers,
}
