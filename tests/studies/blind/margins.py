"""How far the search's thresholds stand from what the blind set shows: `python -m tests.studies.blind.margins`.

Of nulls: the most that any candidate would save, over noise power, per number and independent row (`Policy.chance`),
and residual over noise floor (`remainder`). Of singles named rightly: the share of what stands above the noise floor
that the hidden effect explains, and residual over noise floor with it. Of all that is
explained: the torque gap of the holdout over that of the recording, noise at least (`holdout_gap`). Of all recordings:
where a voltage limit is said to be, by how much more voltage may be reached without falling behind (`BEYOND`).
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated
from unittest.mock import patch

import numpy as np
import typer
from rich.console import Console
from rich.progress import track

from bench.diagnosis.policy import POLICY, worth
from bench.diagnosis.recordings import fit_bare
from bench.diagnosis.search import candidates, search
from bench.effects import voltage_limit
from bench.effects.catalogue import catalogue
from bench.fit.fit import Fit
from bench.fit.rows import Rows
from bench.rig.rig import load_rig
from bench.trace.read import read
from tests.studies.blind.draw import Drawn, draw
from tests.studies.blind.record import home, truth_of
from tests.studies.blind.run import diagnosis_of
from tests.studies.blind.score import same

REMAINS = POLICY.remainder
#: Limits tried of samples beyond the top that are not behind, over those behind.
BEYONDS = (0.03, 0.06, 0.1, voltage_limit.BEYOND, 0.18, 0.3, np.inf)


def bare(folder: Path) -> Fit:
    """The fit without an effect of a case's first recording."""
    rig = load_rig(folder / "rig.toml")
    return fit_bare(Rows.of(read(folder / "run1.csv.gz", rig.trace.columns), rig))


def of_nulls(folder: Path, cases: Sequence[Drawn]) -> tuple[list[float], list[float]]:
    """Significance of the best candidate, and residual over noise floor, of each."""
    significance, chi = [], []
    for case in track(cases, "nulls", console=Console(stderr=True)):
        fitted = bare(folder / case.name)
        best = candidates(fitted, catalogue().values())[0]
        numbers = max(len(best.term.shape), 1)
        significance.append(best.gain / (numbers * fitted.rows.correlation * fitted.floor**2))
        chi.append(fitted.chi)
    return significance, chi


def of_singles(folder: Path, cases: Sequence[Drawn]) -> tuple[list[float], list[float]]:
    """Share explained by the hidden effect, and residual over noise floor, where it alone is named."""
    shares, chi = [], []
    for case in track(cases, "singles", console=Console(stderr=True)):
        before = bare(folder / case.name)
        after = search(before, list(catalogue().values()), POLICY).last
        if same(after.hypothesis.names) == same(truth_of(folder, case.name)["effects"]):
            shares.append(worth(before, after) / before.excess if before.excess else 1.0)
            chi.append(after.chi)
    return shares, chi


def of_holdouts(folder: Path, cases: Sequence[Drawn]) -> list[float]:
    """Gap of the holdout over that of the recording, noise at least, where nothing else speaks against a model."""
    ratios = []
    for case in track(cases, "holdouts", console=Console(stderr=True)):
        torque = diagnosis_of(folder / case.name, frozenset()).torque
        if torque.identify is not None and torque.holdout is not None:
            least = max(torque.identify[1], torque.noise_floor)
            ratios += [torque.holdout[1] / least] * (torque.identify[1] < REMAINS * torque.noise_floor)
    return ratios


def of_voltage(folder: Path, cases: Sequence[Drawn]) -> list[tuple[int, int]]:
    """By each of BEYONDS: how many voltage limits are found, and how many more."""
    found = np.zeros((len(BEYONDS), 2), dtype=int)
    for case in track(cases, "voltages", console=Console(stderr=True)):
        rig = load_rig(folder / case.name / "rig.toml")
        trace = read(folder / case.name / "run1.csv.gz", rig.trace.columns)
        more = voltage_limit.EFFECT.name not in truth_of(folder, case.name)["effects"]
        for row, limit in enumerate(BEYONDS):
            with patch.object(voltage_limit, "BEYOND", limit):
                found[row, int(more)] += voltage_limit.EFFECT.detect(trace, rig, 1.5 * trace.sample_period) is not None
    return [(right, wrong) for right, wrong in found.tolist()]


def main(every: Annotated[int, typer.Option(min=1, help="Take every so many of singles and holdouts.")] = 5) -> None:
    """Print the margins; the blind set must have been recorded by `python -m tests.studies.blind`."""
    folder, drawn = home(1, 8.0, None), draw(1, {"single": 252, "pair": 60, "null": 100, "outside": 32}, 8.0)
    significance, null_chi = of_nulls(folder, [case for case in drawn if case.hidden.group == "null"])
    shares, chi = of_singles(folder, [case for case in drawn if case.hidden.group == "single"][::every])
    typer.echo(
        f"{len(significance)} nulls: best candidate {np.max(significance):.1f} at most, median "
        f"{np.median(significance):.1f}; chi {np.quantile(null_chi, 0.95):.3f} at 95 %, {np.max(null_chi):.3f} at most"
    )
    typer.echo(
        f"{len(shares)} singles: share explained {np.min(shares):.2f} at least, {np.quantile(shares, 0.05):.2f} at "
        f"5 %; chi {np.quantile(chi, 0.95):.3f} at 95 %, {np.max(chi):.3f} at most"
    )
    for limit, (right, wrong) in zip(BEYONDS, of_voltage(folder, drawn), strict=True):
        typer.echo(f"samples beyond up to {limit:g}: {right} voltage limits found, {wrong} where there is none")
    apart = of_holdouts(folder, drawn[::every])
    typer.echo(f"{len(apart)} holdouts: gap {np.quantile(apart, 0.9):.2f} times at 90 %, {np.max(apart):.2f} at most")


if __name__ == "__main__":
    typer.run(main)
