"""The commands of docs/check.md run as they stand there, and CI's own baseline holds."""

import re
import shlex
import shutil
from pathlib import Path

import pytest

from bench.assets import asset
from bench.trace.write import write
from tests.baseline.test_command import again

ROOT = Path(__file__).resolve().parents[2]
BLOCKS = re.findall(r"^```sh\n(.*?)^```", (ROOT / "docs" / "check.md").read_text(encoding="utf-8"), re.M | re.S)
DAYS = ("monday", "tuesday", "wednesday", "thursday", "friday", "saturday")


def test_the_manual_runs(bench):
    for seed, day in enumerate(DAYS):
        write(again(seed), Path(f"{day}.csv"))
    commands = [line for block in BLOCKS for line in block.splitlines() if line.startswith("bench ")]
    assert len(commands) >= 8
    for line in commands:
        assert (bench(*shlex.split(line)[1:])[0], line) == (0, line)
    assert Path("check.json").exists()
    assert Path("check.xml").exists()


@pytest.mark.slow
def test_the_embedded_rig_is_what_it_was(bench):
    shutil.copy(asset("data", "rigs", "sh30701p.toml"), "lab.toml")
    baseline = asset("data", "baselines", "sh30701p.toml")
    bench("simulate", "lab.toml", "--out", "run.csv", "--profile", "speed_staircase", "--seed", "6")
    assert bench("check", "run.csv", "--rig", "lab.toml", "--baseline", baseline)[0] == 0
