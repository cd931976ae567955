"""How far the voltage limit's threshold is from what the blind set shows: `python -m tests.studies.blind.margins`.

Of all recordings of the set: where a voltage limit is found, by how much more voltage may be reached without falling
behind (`BEYOND`). The set must have been recorded by `python -m tests.studies.blind`.
"""

from __future__ import annotations

from unittest.mock import patch

import numpy as np
import typer
from rich.console import Console
from rich.progress import track

from bench.effects import voltage_limit
from bench.rig.rig import load_rig
from bench.trace.read import read
from tests.studies.blind.draw import draw
from tests.studies.blind.record import home, truth_of

#: Limits tried of samples beyond the top that are not behind, over those behind.
BEYONDS = (0.03, 0.06, 0.1, voltage_limit.BEYOND, 0.18, 0.3, np.inf)


def main() -> None:
    """Print how many voltage limits are found by each of BEYONDS, and how many where there is none."""
    folder, drawn = home(1, 8.0, None), draw(1, {"single": 252, "pair": 60, "null": 100, "outside": 32}, 8.0)
    found = np.zeros((len(BEYONDS), 2), dtype=int)
    for case in track(drawn, "voltages", console=Console(stderr=True)):
        rig = load_rig(folder / case.name / "rig.toml")
        trace = read(folder / case.name / "run1.csv.gz", rig.trace.columns)
        more = voltage_limit.EFFECT.name not in truth_of(folder, case.name)["effects"]
        for row, limit in enumerate(BEYONDS):
            with patch.object(voltage_limit, "BEYOND", limit):
                found[row, int(more)] += voltage_limit.EFFECT.detect(trace, rig, 1.5 * trace.sample_period) is not None
    for limit, (right, wrong) in zip(BEYONDS, found.tolist(), strict=True):
        typer.echo(f"samples beyond up to {limit:g}: {right} voltage limits found, {wrong} where there is none")


if __name__ == "__main__":
    typer.run(main)
