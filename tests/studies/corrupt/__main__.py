"""`python -m tests.studies.corrupt --recordings 4000 --out docs/corrupt.md`: what becomes of corrupted recordings."""

from __future__ import annotations

import tempfile
import zlib
from collections import Counter
from pathlib import Path
from typing import Annotated

import numpy as np
import typer

import bench
from bench.errors import BenchError
from bench.gate.gate import warnings_of
from bench.rig.rig import Rig
from tests.fit.motions import Truth, recording
from tests.studies.corrupt import files, signals
from tests.studies.frame import table

#: An inertia beyond this share of the true one is wrong.
WRONG = 0.02
OUTCOMES = ("refused", "told", "right", "wrong")
#: A motor with a disk, 1.5e-3 kg*m**2 in all; recordings are of axes that differ from it by up to a tenth.
INERTIA, APART = 1.5e-3, 0.1
RIG = Rig.of(
    {
        "name": "motor with a disk",
        "kind": "rotary",
        "motor": {"torque_constant": "0.8 N*m/A", "rotor_inertia": "2 kg*cm**2", "peak_current": "30 A"}
        | {"maximum_speed": "320 rad/s"},
        "load": {"outer_diameter": f"{np.sqrt(8.0 * (INERTIA - 2e-4)):.9g} m", "mass": "1 kg"},
        "trace": {"columns": {"time": "time [s]", "velocity": "velocity [rad/s]", "current": "current [A]"}},
    }
)
KINDS = ("nothing", *signals.KINDS, *files.KINDS)


def corrupted(kind: str, number: int, folder: Path) -> tuple[Path, float]:
    """File of a recording corrupted by one kind, and its true inertia - kg*m**2."""
    rng = np.random.default_rng([number, zlib.crc32(kind.encode())])
    inertia = INERTIA * (1.0 + APART * rng.uniform(-1.0, 1.0))
    trace = recording(rng, Truth(inertia=inertia), duration=4.0)
    columns = trace.time, trace["velocity"], trace["current"]
    if kind in signals.KINDS:
        columns = signals.KINDS[kind](rng, *columns)
    kept, change = files.KINDS.get(kind, ("csv", lambda _, content: content))
    path = folder / f"run.{kept.split()[0]}"
    path.write_bytes(change(rng, {**files.KEPT, **files.SUMMED}[kept](columns)))
    return path, inertia


def outcome(kind: str, number: int, folder: Path) -> tuple[str, str]:
    """One of OUTCOMES, and the line in which it was refused or told, if any."""
    path, inertia = corrupted(kind, number, folder)
    try:
        columns = files.COLUMNS.get(path.suffix[1:])
        trace = bench.read(path, RIG.trace if columns is None else columns)
        found = bench.identify(trace, RIG)
    except BenchError as error:
        return "refused", str(error)
    lines = [*found.warnings, *warnings_of(found.checks), *trace.notes]
    if lines:
        return "told", lines[0]
    return ("wrong" if abs(found["moment_of_inertia"].value / inertia - 1.0) > WRONG else "right"), ""


def main(
    recordings: Annotated[int, typer.Option(help="Of all kinds together.")] = 4000,
    only: Annotated[str, typer.Option(help="Kinds whose name holds this.")] = "",
    verbose: Annotated[bool, typer.Option(help="Print every outcome.")] = False,
    out: Annotated[Path | None, typer.Option(help="File for the table.")] = None,
) -> None:
    """Corrupt recordings, identify them, and count what was said."""
    kinds = [kind for kind in KINDS if only in kind]
    found = {kind: Counter[str]() for kind in kinds}
    with tempfile.TemporaryDirectory() as place:
        for number in range(recordings):
            kind = kinds[number % len(kinds)]
            what, line = outcome(kind, number, Path(place))
            found[kind][what] += 1
            if verbose:
                typer.echo(f"{kind}: {what} {line[:200]}")
    text = markdown(found, recordings)
    typer.echo(text)
    if out is not None:
        out.write_text(text, encoding="utf-8")


def markdown(found: dict[str, Counter[str]], recordings: int) -> str:
    """Markdown of the outcomes."""
    every = sum(found.values(), Counter[str]())
    hidden = sum((found[kind] for kind in found if kind in signals.OF_ANOTHER_AXIS), Counter[str]())
    seen = recordings - hidden.total()
    rows = [(kind, *(one[what] for what in OUTCOMES)) for kind, one in found.items()]
    lines = [
        f"{recordings} recordings, {len(found)} kinds: {', '.join(f'{every[what]} {what}' for what in OUTCOMES)}.",
        f"Wrong without a word: {every['wrong'] - hidden['wrong']} of {seen}, "
        f"and {hidden['wrong']} of {hidden.total()} that are what another axis would give.",
        "",
        table(("kind", *OUTCOMES), rows),
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    typer.run(main)
