"""The commands that are tried, each with inputs so small that a run is short."""

from __future__ import annotations

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tests.hostile import RIG, ROOT, columns, csv_of


@dataclass(frozen=True)
class Command:
    """A line of `bench` that writes into `out`.

    Attributes:
        line: arguments.
        resumes: goes on where an earlier run was ended, so that its time says nothing of a run from the start.
    """

    line: str
    resumes: bool = False


COMMANDS = {
    "demo": Command("demo --out out"),
    "simulate": Command("simulate simulated.toml --out out/run.csv.gz --seed 1"),
    "identify": Command("identify run.csv --rig rig.toml --out out --json out/found.json"),
    "diagnose": Command("diagnose run.csv --rig rig.toml --out out"),
    "check": Command("check run.csv --rig rig.toml --baseline out/base.toml --update"),
    "export": Command("export model.toml --snippet --joint elbow --out out/joint.xml"),
    "fleet": Command("fleet fleet.csv --out out", resumes=True),
    "lab": Command("lab --data recordings --out out"),
}


def make_inputs(folder: Path) -> None:
    """Everything that the commands read, and the folder that they write to."""
    (folder / "rig.toml").write_text(RIG)
    (folder / "run.csv").write_text(csv_of(*columns()))
    (folder / "short.csv").write_text(csv_of(*columns(2000)))
    shutil.copy(ROOT / "data" / "rigs" / "sh30701p.toml", folder / "simulated.toml")
    head, rows = "file,rig,axis,time\n", "run.csv,rig.toml,one,0\nshort.csv,rig.toml,one,1\nnone.csv,rig.toml,one,2\n"
    (folder / "fleet.csv").write_text(head + rows)
    (folder / "model.toml").write_text(
        'schema = "bench.model/1"\nkind = "rotary"\n[parameters]\nmoment_of_inertia = "0.0022 kg*m**2"\n'
        'viscous_friction_coefficient = "8e-4 N*m*s/rad"\ncoulomb_friction_torque = "0.06 N*m"\nload_torque = "0 N*m"\n'
        'motor_moment_of_inertia = "0.0002 kg*m**2"\n'
    )
    (folder / "recordings").mkdir()
    shutil.copy(ROOT / "data" / "traces" / "JLoadWithoutFriction.trace", folder / "recordings")
    (folder / "out").mkdir()


def arguments(line: str) -> list[str]:
    return [sys.executable, "-m", "bench", *line.split()]


def finished(line: str, folder: Path, environment: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """A run to its end."""
    return subprocess.run(
        arguments(line), cwd=folder, env=environment, capture_output=True, text=True, errors="replace", check=False
    )
