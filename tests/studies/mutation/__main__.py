"""Command line: draw mutants, show each to the tests that run what was changed, tell which were noticed."""

from __future__ import annotations

import ast
import json
import os
import shutil
import subprocess
import sys
import time
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track

from tests.studies.frame import table
from tests.studies.mutation.mutants import DECIDING, ROOT, Mutant, drawn
from tests.studies.mutation.reach import REACH

ENVIRONMENT = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
PYTEST = [sys.executable, "-m", "pytest", "-q", "-x", "-n", "0", "-p", "no:cacheprovider", "--tb=no", "--no-header"]
#: What pytest returns where it cannot begin: no test has failed, unless a file that it was to run cannot be imported.
USAGE = 4
#: Tests of a second at most are shown first, whatever folder they are of.
QUICK = 1.0
#: What tests share is set up by the first of them, and the seconds of the others do not hold it: 120 s on a busy
#: machine, so that beyond a limit of 60 s mutants passed for endless - s.
SETTING_UP = 400.0


@dataclass(frozen=True)
class Fate:
    """What became of a mutant: the first test that failed with it, or none of so many; after so many seconds."""

    mutant: Mutant
    killed_by: str
    tests: int
    seconds: float


@dataclass(frozen=True)
class Reach:
    """What the tests run of the bench.

    Attributes:
        seconds: of each test, as pytest calls it.
        running: tests that run a function, by its `path:line`.
    """

    seconds: Mapping[str, float]
    running: Mapping[str, set[str]]

    def seeing(self, mutant: Mutant) -> list[str]:
        """Tests that run what a mutant may change: those of its own folder first, and quick ones."""
        tests = set().union(*(self.running.get(function, ()) for function in mutant.functions))
        own, spent = "/".join(("tests", *mutant.path.split("/")[1:2], "")), self.seconds
        return sorted(tests, key=lambda test: (spent[test] > QUICK, not test.startswith(own), spent[test]))


def reached(folder: Path, anew: bool) -> Reach:
    """Of all tests, measured where the folder does not hold them."""
    if anew or not any(folder.glob("*.json")):
        folder.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, "-m", "pytest", "-q", "-p", "tests.studies.mutation.reach", "--no-header", "--tb=no"]
        reach = {REACH: str(folder.resolve())}  # tests change the working folder
        subprocess.run(command, cwd=ROOT, env={**os.environ, **ENVIRONMENT, **reach}, check=True)
    seconds: dict[str, float] = {}
    running: dict[str, set[str]] = defaultdict(set)
    there = collected()
    for path in folder.glob("*.json"):
        told = json.loads(path.read_text(encoding="utf-8"))
        for test, (spent, ran) in told["tests"].items():
            if test not in there:  # of a state before: to pytest an error, which kills nothing
                continue
            seconds[test] = spent
            for number in ran:
                running[told["functions"][number]].add(test)
    return Reach(seconds, running)


def collected() -> set[str]:
    """Tests that there are."""
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "--collect-only", "--no-header"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, check=True, text=True)
    return {line for line in done.stdout.splitlines() if "::" in line}


def fate(mutant: Mutant, reach: Reach, copy: Path, most: float) -> Fate:
    """Shows a mutant to the tests that see it.

    Args:
        mutant: to make.
        reach: of the tests.
        copy: of the project, to make it in.
        most: seconds of tests that it is shown to, as they take without it.
    """
    path, began, shown, spent = copy / mutant.path, time.monotonic(), 0, 0.0
    text = path.read_text(encoding="utf-8")
    changed = mutant.applied(text)
    ast.parse(changed)
    path.write_text(changed, encoding="utf-8")
    killed_by = ""
    try:
        for tests in _batches(reach.seeing(mutant), reach.seconds):
            if spent > most:
                break
            seconds = sum(reach.seconds[test] for test in tests)
            done = subprocess.run(
                [*PYTEST, *sorted(tests)],  # those of a file together, as they share what it sets up
                cwd=copy,
                env={**os.environ, **ENVIRONMENT, "PYTHONPATH": str(copy)},
                capture_output=True,
                check=False,
                text=True,
                timeout=SETTING_UP + 20.0 * seconds,
            )
            shown, spent = shown + len(tests), spent + seconds
            failed = [line.split()[1] for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
            assert done.returncode != USAGE or failed, done.stderr
            if done.returncode not in (0, 5):  # 5: nothing to run
                killed_by = failed[0] if failed else "the tests do not start"
                break
    except subprocess.TimeoutExpired:
        killed_by = "it does not end"
    finally:
        path.write_text(text, encoding="utf-8")
    return Fate(mutant, killed_by, shown, time.monotonic() - began)


def _batches(tests: Iterable[str], seconds: Mapping[str, float]) -> Iterable[list[str]]:
    """Tests that one process runs, each time twice as many seconds, so that starting it is not all it does."""
    batch: list[str] = []
    enough = QUICK
    for test in tests:
        batch.append(test)
        if sum(seconds[each] for each in batch) > enough:
            yield batch
            batch, enough = [], 2.0 * enough
    if batch:
        yield batch


def markdown(fates: Sequence[Fate], command: str, equivalent: Mapping[str, str]) -> str:
    """The table."""
    survived = [each for each in fates if not each.killed_by]
    told = [each for each in survived if str(each.mutant) in equivalent]
    killed, counted = len(fates) - len(survived), len(fates) - len(told)
    lines = ["# Mutants", "", f"`{command}`", ""]
    lines += [f"{len(fates)} mutants, {len(told)} of them equivalent; {killed} of {counted} killed.", ""]
    rows = [(f"`{each.mutant}`", each.tests, equivalent.get(str(each.mutant), "")) for each in survived]
    lines += [table(("survived", "tests that ran it", "equivalent, as"), rows), ""]
    lines += [table(("killed", "by"), [(f"`{one.mutant}`", f"`{one.killed_by}`") for one in fates if one.killed_by])]
    return "\n".join(line.replace("||", "\\|\\|") for line in lines) + "\n"


def main(
    count: Annotated[int, typer.Option(min=1, help="Mutants to draw.")] = 200,
    seed: Annotated[int, typer.Option(min=0)] = 1,
    folders: Annotated[list[str] | None, typer.Option("--in", help="Folders of bench. Repeatable.")] = None,
    jobs: Annotated[int, typer.Option(min=1)] = 2,
    most: Annotated[float, typer.Option(help="Seconds of tests that a mutant is shown to.")] = 1e9,
    reach: Annotated[Path, typer.Option(help="Folder of what each test runs.")] = Path(".reach"),
    anew: Annotated[bool, typer.Option("--anew", help="Measure that anew.")] = False,
    listed: Annotated[bool, typer.Option("--list", help="List the mutants and stop.")] = False,
    equivalent: Annotated[Path | None, typer.Option(help="JSON: mutants that change nothing, and why.")] = None,
    out: Annotated[Path | None, typer.Option(help="Folder for mutants.md.")] = None,
) -> None:
    """Change the bench in one place at a time and see that a test fails."""
    chosen = drawn(count, seed, tuple(folders) if folders else DECIDING)
    if listed:
        typer.echo("\n".join(map(str, chosen)))
        return
    tests = reached(reach, anew)
    same = json.loads(equivalent.read_text(encoding="utf-8")) if equivalent is not None else {}
    with TemporaryDirectory() as made, ThreadPoolExecutor(jobs) as pool:
        copies: SimpleQueue[Path] = SimpleQueue()
        for k in range(jobs):
            copies.put(_copy(Path(made) / str(k)))

        def shown(mutant: Mutant) -> Fate:
            copy = copies.get()
            try:
                return fate(mutant, tests, copy, most)
            finally:
                copies.put(copy)

        console, fates = Console(stderr=True), []
        for found in track(pool.map(shown, chosen), "mutants", total=len(chosen), console=console):
            fates.append(found)
            console.print(f"{found.killed_by or 'SURVIVED'}: {found.mutant} ({found.seconds:.0f} s)", markup=False)
    where = "".join(f" --in {name}" for name in folders or ())
    told = markdown(fates, f"python -m tests.studies.mutation --count {count} --seed {seed}{where}", same)
    typer.echo(told)
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        (out / "mutants.md").write_text(told, encoding="utf-8")


def _copy(folder: Path) -> Path:
    """A copy of the project with the shared recordings beside it."""
    project = folder / "project"
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True, text=True)
    for name in filter(None, listed.stdout.split("\0")):  # all of it: a test that misses a file fails of that
        (project / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, project / name)
    shared = ROOT.parent / "shared"
    if shared.exists():
        (folder / "shared").symlink_to(shared)
    return project


if __name__ == "__main__":
    typer.run(main)
