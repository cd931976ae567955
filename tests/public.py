"""Public axes as a user meets them: the shipped rig, one command each, what comes out beside what is published.

`python -m tests.public --out docs` writes `docs/public_axes_table.md`. The recordings are other people's: they stay in
`../shared/data`, and `data/sources.toml` says where they come from.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import track

from bench.assets import asset
from bench.files import write_text
from tests.shared import SHARED

DATA = SHARED / "data"
BASE = ("moment_of_inertia", "moving_mass", "viscous_friction_coefficient", "coulomb_friction_")


@dataclass(frozen=True)
class Line:
    """One command over a public recording.

    Attributes:
        axis: whose.
        command: of the bench.
        files: recordings below `../shared/data`; `**` finds several.
        rig: one of `data/rigs`, or one that stands with the recordings.
        published: what others know of it.
        holdout: below `../shared/data`.
    """

    axis: str
    command: str
    files: tuple[str, ...]
    rig: str
    published: str
    holdout: str = ""

    def arguments(self) -> list[str]:
        """Of the command line."""
        recordings = sorted(str(path) for pattern in self.files for path in DATA.glob(pattern))
        rig = asset("data", "rigs", self.rig) if "/" not in self.rig else DATA / self.rig
        holdout = ["--holdout", str(DATA / self.holdout)] if self.holdout else []
        return [self.command, *recordings, "--rig", str(rig), *holdout]

    @property
    def heading(self) -> str:
        """The command as somebody would type it, files without their folders."""
        words = (word if word.startswith("-") else Path(word).name for word in self.arguments())
        return (
            "bench " + " ".join(words) if len(self.files) < 3 and "*" not in self.files[0] else f"bench {self.command}"
        )


EMPS = "M 95.11 ± 0.22 kg, Fv 203.5 N·s/m, Fc 20.39 N; friction differs by direction"
GO1 = "J 0.0281 kg·m²; speed column 0.16 of the derivative of position"
HSM = "J 1.2e-4 kg·m² (catalogue), 1.0 to 1.25e-4 by own fits"
BAM = "m·l² + armature 6.7e-3 kg·m², weight 0.4805 N·m"
LINES = (
    Line("EMPS", "identify", ("emps/DATA_EMPS.mat",), "emps.toml", EMPS),
    Line("EMPS", "diagnose", ("emps/DATA_EMPS.mat",), "emps.toml", EMPS, "emps/DATA_EMPS_PULSES.mat"),
    Line("LAAS", "identify", ("laas_anticogging/acc_current.txt",), "laas.toml", "J 1.939e-4 A·s²/rad by own fit"),
    Line("LAAS", "diagnose", ("laas_anticogging/speed_test1.txt",), "laas.toml", "cogging 72, 18, 12, 24, 36 a turn"),
    Line("TRO 1", "friction", ("tro2021_screw/driveNo1/steady_state/*/*.csv",), "tro2021.toml", "Stribeck"),
    Line("TRO 2", "friction", ("tro2021_screw/driveNo2/steady_state/*/*.csv",), "tro2021.toml", "no Stribeck"),
    Line(
        "TRO 3", "friction", ("tro2021_screw/driveNo3/steady_state/*/*.csv",), "tro2021.toml", "no Stribeck, an offset"
    ),
    *(
        Line("BAM XL330", "diagnose", (f"bam_xl330/2026-01-15_{clock}.json",), "bam_xl330.toml", BAM)
        for clock in ("10h28m32", "10h29m04", "10h29m37", "10h30m10")
    ),
    Line("Damiao 1", "identify", ("real/damiao_m1/r?.csv.gz",), "real/damiao_m1/rig.toml", "J 0.024 to 0.027 kg·m²"),
    Line(
        "Damiao 4",
        "identify",
        ("real/damiao_m4/r1.csv.gz",),
        "real/damiao_m4/rig.toml",
        "speed column 0.503 of the derivative of position",
    ),
    *(
        Line("Go1", "identify", (f"real/go1_1kg/{name}.csv.gz",), "real/go1_1kg/rig.toml", GO1)
        for name in ("sin_sin", "sin_time_square", "lift_and_drop", "up_and_down")
    ),
    Line("HSM150, one way", "identify", ("real/hsm150/pos_006_1.csv.gz",), "real/hsm150/rig.toml", HSM),
    Line("HSM150, both ways", "identify", ("real/hsm150/*.csv.gz",), "real/hsm150/rig.toml", HSM),
)


def outcome(line: Line) -> str:
    """What the command line says: verdict, names, quantities, or the reason of its refusal."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "found.json"
        command = [sys.executable, "-m", "bench", *line.arguments(), "--json", str(path)]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        found = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    if done.returncode:
        said = next((row for row in done.stderr.splitlines() if "warning" not in row.lower()), done.stderr)
        return f"refused, exit {done.returncode}: {' '.join(said.split())}".replace(str(DATA), "...")
    if line.command == "friction":
        named, left = found["effect"], found["unexplained"]
        return f"{named['name'] if named else 'none named'}; unexplained {left['before']:.4f} to {left['after']:.4f}"
    parts = [found["verdict"].replace("_", " ")] if "verdict" in found else []
    parts += [", ".join(f"{effect['name']}{_waves(effect)}" for effect in found.get("effects", []))]
    parts += [_quantities(found["parameters"])]
    if "explained" in found:
        parts += [f"explains {found['explained']:.1%}"]
    return "; ".join(part for part in parts if part)


def _waves(effect: dict[str, Any]) -> str:
    harmonic = effect["parameters"].get("harmonic")
    return f" {harmonic['value']:.4g}" if harmonic else ""


def _quantities(parameters: dict[str, Any]) -> str:
    quantities = {name: found for name, found in parameters.items() if name.startswith(BASE)}
    return ", ".join(
        f"{name.split('_')[0]} {found['value']:.4g} ± {0.5 * (found['ci95'][1] - found['ci95'][0]):.2g} {found['unit']}"
        for name, found in quantities.items()
    )


def main(
    only: Annotated[str, typer.Option(help="Axes whose name begins so.")] = "",
    out: Annotated[Path | None, typer.Option(help="Folder for public_axes_table.md.")] = None,
) -> None:
    """Run every command and print the table."""
    chosen = [line for line in LINES if line.axis.startswith(only)]
    rows = [
        f"| {line.axis} | `{line.heading}` | {line.published} | {outcome(line)} |"
        for line in track(chosen, "axes", console=Console(stderr=True))
    ]
    text = "\n".join(
        [
            "# Public axes by one command each",
            "",
            "`python -m tests.public --out docs` made this table; recordings: `data/sources.toml`, rigs: `data/rigs`.",
            "",
            "| axis | command | published | the bench |",
            "|---|---|---|---|",
            *rows,
        ]
    )
    typer.echo(text)
    if out is not None:
        write_text(out / "public_axes_table.md", text + "\n")


if __name__ == "__main__":
    typer.run(main)
