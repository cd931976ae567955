"""`python -m tests.studies.fleet --out docs/fleet/table.md`: what a fleet's run endures, and how fast it is."""

from __future__ import annotations

import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Annotated

import numpy as np
import pyarrow.parquet as pq
import typer

from bench.bounds import bounds
from bench.fleet.evaluate import Job, evaluate
from bench.fleet.manifest import read_manifest
from bench.jobs.each import each
from bench.jobs.process import Limits
from bench.rig.rig import load_rig
from tests.fleet.made import DAMAGES, Made, fleet_of
from tests.fleet.storage import offer
from tests.studies.frame import table

ROOT = Path(__file__).resolve().parents[2]
CHANGED = frozenset({7, 23, 40, 58, 91})
EACH, HANGING, DEADLY = 10, 3, 2
#: What a manifest may name instead of a recording: devices, folders, and storages that nobody asked for.
ELSEWHERE = ("file:///dev/zero", "/dev/stdin", "/proc/kmsg", "/", "zip://a.csv::file:///x.zip", "dir:///etc")
ELSEWHERE += (
    "reference://x",
    "tar://a::/x.tar",
    "local:///etc/passwd",
    "simplecache::https://127.0.0.1:9/x",
    "a\tb://c",
)


def main(
    recordings: Annotated[int, typer.Option(help="Of the fleet; 0: its speed only.")] = 1000,
    timed: Annotated[int, typer.Option(help="Of the fleet whose speed is measured; 0: none.")] = 200,
    duration: Annotated[float, typer.Option(help="Of one of these, at 1 kHz, in s.")] = 30.0,
    deadline: Annotated[float, typer.Option(help="Of one recording, in s.")] = 20.0,
    hostile: Annotated[float, typer.Option(help="Share of its recordings that give no result.")] = 0.05,
    out: Annotated[Path | None, typer.Option(help="File for the table.")] = None,
) -> None:
    """Measure what is said of fleets, and write it down."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        lines = _endured(folder, recordings, deadline, hostile) if recordings else []
        lines += _speed(folder / "timed", timed, duration) if timed else []
    options = f"--recordings {recordings} --hostile {hostile:g} --timed {timed} --duration {duration:g}"
    command = f"python -m tests.studies.fleet {options}"
    text = "\n\n".join(["# A fleet, measured", f"`{command}`", table(("what", "found"), lines)]) + "\n"
    typer.echo(text)
    if out is not None:
        out.parent.mkdir(parents=True, exist_ok=True)
        out.write_text(text, encoding="utf-8")


def _endured(folder: Path, recordings: int, deadline: float, hostile: float) -> list[tuple[str, object]]:
    """A fleet with a share damaged, some that hang and some that end their process: run, killed, run again."""
    made = fleet_of(folder / "fleet", axes=recordings // EACH, each=EACH, changed=CHANGED)
    wrong = _spoilt(made, recordings, hostile)
    offer(folder / "site")
    manifest = made.write()
    began = time.monotonic()
    _run(folder, manifest, "whole", deadline).communicate()
    seconds = time.monotonic() - began
    most = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    table = (folder / "whole" / "fleet.parquet").read_bytes()
    rows = pq.read_table(folder / "whole" / "fleet.parquet").to_pylist()
    statuses = Counter(row["status"] for row in rows)
    sound = [row for place, row in enumerate(rows) if place not in wrong]
    kept, left = _killed_half_way(folder, manifest, deadline, recordings)
    again = _run(folder, manifest, "killed", deadline).communicate()[0]
    evaluated = int(re.search(r"(\d+) evaluated now", again)[1])
    same = (folder / "killed" / "fleet.parquet").read_bytes() == table
    called = _called_changed(folder / "whole")
    named = sum(axis in CHANGED for axis in called)
    risen = sum(axis < recordings // EACH for axis in CHANGED)
    counts = ", ".join(f"{count} {status}" for status, count in sorted(statuses.items()))
    distinct = len({row["result"] for row in rows} - {None})  # empty files are one, what cannot be begun is none
    return [
        (f"{recordings} recordings, {len(wrong)} of them damaged, hanging or deadly", counts),
        ("sound ones done", f"{sum(row['status'] == 'done' for row in sound)} of {len(sound)}"),
        (
            "rows without a result that give no reason",
            sum(row["status"] != "done" and not row["reason"] for row in rows),
        ),
        ("reasons", "; ".join(_reasons(rows))),
        (
            "axes whose friction rose by 15 %",
            f"{named} named of {risen}; of others {len(called) - named}",
        ),
        ("whole run, two workers", f"{seconds:.0f} s; {most:.0f} MB its largest process"),
        ("killed half-way (SIGKILL to all its processes)", f"{kept} results kept, {left} processes left"),
        ("run again", f"{evaluated} evaluated, {distinct - kept} were missing; same table: {same}"),
    ]


def _spoilt(made: Made, recordings: int, hostile: float) -> set[int]:
    """Places of the recordings that are replaced by ones that give no result."""
    rng = np.random.default_rng(0)
    count = round(hostile * recordings) + HANGING + DEADLY
    places = rng.choice(len(made.rows), count, replace=False).tolist()
    for number, place in enumerate(places):
        file = made.rows[place].split(",")[0]
        if number < HANGING + DEADLY:
            url = f"{'never' if number < HANGING else 'deadly'}://disk/{file}"
            made.rows[place] = made.rows[place].replace(file, url)
        elif number % 2 and hostile > 0.05:
            made.rows[place] = made.rows[place].replace(file, ELSEWHERE[number // 2 % len(ELSEWHERE)])
        else:
            DAMAGES[number % len(DAMAGES)](made.folder / file)
    return set(places)


def _run(folder: Path, manifest: Path, out: str, deadline: float) -> subprocess.Popen[str]:
    """The command, in a group of processes of its own."""
    path = os.pathsep.join([str(ROOT), str(folder / "site")])
    command = [sys.executable, "-m", "bench", "fleet", str(manifest), "--out", str(folder / out)]
    command += ["--deadline", f"{deadline:g}", "--workers", "2", "--storage", "never", "--storage", "deadly"]
    environment = {**os.environ, "PYTHONPATH": path}
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment, start_new_session=True)


def _killed_half_way(folder: Path, manifest: Path, deadline: float, recordings: int) -> tuple[int, int]:
    """How many results a run has left that was killed, and how many of its processes live on."""
    process = _run(folder, manifest, "killed", deadline)
    results = folder / "killed" / "results"
    while len(list(results.rglob("[0-9a-f]*.json"))) < recordings // 2:
        assert process.poll() is None, "it ended before it could be killed"
        time.sleep(0.2)
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    time.sleep(2.0)
    try:
        os.killpg(process.pid, 0)
        left = 1
    except ProcessLookupError:
        left = 0
    return len(list(results.rglob("[0-9a-f]*.json"))), left


def _reasons(rows: list[dict]) -> list[str]:
    """Each reason with how often it was given."""
    reasons = Counter(row["reason"] for row in rows if row["reason"])
    return [f"{count}x {reason[:70].replace('|', '/')}" for reason, count in reasons.most_common()]


def _called_changed(out: Path) -> list[int]:
    """Numbers of the axes that a run's summary calls changed."""
    changed = json.loads((out / "summary.json").read_text(encoding="utf-8"))["changed"]
    return sorted({int(one["axis"].removeprefix("press ")) for one in changed})


def _speed(folder: Path, recordings: int, duration: float) -> list[tuple[str, object]]:
    """Recordings a second by one worker and by two, once all of them have begun to work."""
    manifest = read_manifest(fleet_of(folder, axes=recordings // 10, each=10, duration=duration).write())
    rig, rates, starts = load_rig(folder / "rig.toml"), {}, {}
    tasks = [Job(place, "", rig, False, bounds()) for place in manifest.located("file")]
    for workers in (1, 2):
        began = time.monotonic()
        ended = [time.monotonic() for _ in each(evaluate, tasks, Limits(), workers)]
        warm = 4 * workers
        starts[workers] = ended[0] - began
        rates[workers] = (len(ended) - 1 - warm) / (ended[-1] - ended[warm])
    load, cores = os.getloadavg()[0], os.cpu_count()
    return [
        (
            f"{recordings} recordings of {duration:g} s at 1 kHz: first result after",
            f"{starts[1]:.1f} s, {starts[2]:.1f} s",
        ),
        (
            "recordings a second, one worker and two",
            f"{rates[1]:.2f}, {rates[2]:.2f}: {rates[2] / rates[1]:.2f} times",
        ),
        ("cores, load at the end", f"{cores}, {load:.1f}"),
    ]


if __name__ == "__main__":
    typer.run(main)
