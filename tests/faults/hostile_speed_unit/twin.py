"""The shipped rig of the lab, its viscous friction in N*m/(1/min)."""

import re
from pathlib import Path

from bench.assets import asset


def write(folder: Path) -> None:
    text = asset("data", "rigs", "sh30701p.toml").read_text(encoding="utf-8")
    line = 'viscous_friction_coefficient = "0.0002 N*m/(1/min)"'
    text, count = re.subn(r"^viscous_friction_coefficient = .*$", line, text, flags=re.MULTILINE)
    assert count == 1
    (folder / "lab.toml").write_text(text, encoding="utf-8")
