"""Weights of the probabilities, fitted to cases whose truth is known: `python -m tests.studies.certainty SET...`.

A set is a folder of cases as `python -m tests.studies.blind` and `python -m tests.studies.injected --write` leave them,
of seeds that nothing is judged by. Each case counts once as it is and, every second one, once with its truth taken out
of the catalogue. The weights are those that make the right answers likeliest, mean log loss, and a little penalty for
large ones; each is taken away and halved and doubled to see what it is worth.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from scipy.optimize import minimize

from bench.arrays import Array
from bench.diagnosis.policy import POLICY
from bench.diagnosis.probability import LEAST, MUCH
from bench.effects.catalogue import catalogue
from bench.files import write_text
from tests.studies.blind.score import same
from tests.studies.certainty.features import Hypothesis, Known, folders, kept, known
from tests.studies.frame import publish, running

WEIGHTS = ("remaining", "over", "number", "outside", "none")
#: Of the squares of weights in the loss: they stay finite where cases are separated without an error.
PENALTY = 2e-4
#: A right answer is never taken for less likely.
FLOOR = 1e-5
BINS = 10
SETS = """Sets of seeds that nothing is judged by:
`python -m tests.studies.blind --seed 1001 --singles 126 --pairs 30 --nulls 40 --outside 24 --crowds 48`, of which the
even singles and the first 20 nulls, and `python -m tests.studies.injected --seed 1001 --write injected --cases 110`.
The value of each weight is the mean log loss of the right answer, here of the cases that reach it, after the others
were fitted again. A weight of one more effect and one of an event with a remainder, fitted with these, came to 0.4
and -0.6 and saved 0.006 of it; with both halves of the cases judged by weights of the other 0.009."""


class Table:
    """Hypotheses of all cases as arrays (c, h), padded."""

    def __init__(self, cases: Sequence[Known]) -> None:
        most = max(len(case.hypotheses) for case in cases)

        def column(values: Iterable[Sequence[float]]) -> Array:
            return np.array([np.pad(np.asarray(row, dtype=float), (0, most - len(row))) for row in values])

        names = [field.name for field in fields(Hypothesis) if field.name not in ("names", "standing")]
        self.of = {name: column([[getattr(h, name) for h in c.hypotheses] for c in cases]) for name in names}
        self.there = column([[1.0] * len(case.hypotheses) for case in cases]) > 0.0
        self.right = column([[case.right(h) for h in case.hypotheses] for case in cases])
        self.lacking = np.array([case.truth is None for case in cases])

    def shares(self, weights: Mapping[str, float]) -> Array:
        """Probabilities (c, h + 1), the last one of what was not tried."""
        logs = (
            -weights["remaining"] * (np.maximum(self.of["remaining"], LEAST) + self.of["below"])
            - weights["over"] * np.minimum(self.of["over"], MUCH)
            - weights["number"] * self.of["numbers"]
            - weights["outside"] * self.of["outside"]
        )
        logs = np.column_stack([np.where(self.there, logs, -np.inf), np.full(len(logs), weights["none"])])
        shares = np.exp(logs - logs.max(axis=1, keepdims=True))
        return shares / shares.sum(axis=1, keepdims=True)

    def of_right(self, shares: Array) -> Array:
        """Probability of the right answer (c,)."""
        none = shares[:, -1] + np.sum(shares[:, :-1] * self.of["outside"], axis=1)
        return np.where(self.lacking, none, np.sum(shares[:, :-1] * self.right, axis=1))

    def loss(self, weights: Mapping[str, float]) -> float:
        """Mean negative logarithm of it, and the penalty."""
        right = np.maximum(self.of_right(self.shares(weights)), FLOOR)
        return float(-np.log(right).mean() + PENALTY * sum(value**2 for value in weights.values()))


def fitted(table: Table, start: Mapping[str, float], held: frozenset[str] = frozenset()) -> dict[str, float]:
    """Weights of the least loss; those `held` stay as they are."""
    free = [name for name in WEIGHTS if name not in held]
    at = np.array([start[name] for name in free])
    for _ in range(4):  # a simplex that has shrunk on a ridge is set up again
        at = minimize(
            lambda x: table.loss({**start, **dict(zip(free, x, strict=True))}),
            at,
            method="Nelder-Mead",
            options={"maxiter": 3000, "xatol": 1e-3, "fatol": 1e-6},
        ).x
    return {**start, **dict(zip(free, at.tolist(), strict=True))}


def names_of(case: Known, shares: Array) -> dict[str, float]:
    """Probability of each name of a case; of two that no recording tells apart, of either."""
    found: dict[frozenset[str], float] = {}
    for one, share in zip(case.hypotheses, shares.tolist(), strict=False):
        for name in same([name for name in one.there if name in catalogue()]):
            found[name] = found.get(name, 0.0) + share
    return {min(name): share for name, share in found.items()}


def reliability(cases: Sequence[Known], shares: Array) -> tuple[list[str], float]:
    """Rows of a table of names by their probability, and the expected calibration error."""
    pairs = [(p, c.true(name)) for c, row in zip(cases, shares, strict=True) for name, p in names_of(c, row).items()]
    said, true = np.array(pairs, dtype=float).T
    place, rows, error = np.minimum((BINS * said).astype(int), BINS - 1), [], 0.0
    for k in range(BINS):
        own = place == k
        if own.any():
            rows.append(f"| {k / BINS:.1f} | {own.sum()} | {said[own].mean():.3f} | {true[own].mean():.3f} |")
            error += abs(said[own].mean() - true[own].mean()) * own.mean()
    return rows, error


def beside_outside(cases: Sequence[Known], shares: Array, standing: bool) -> tuple[float, float]:
    """Probability of names beside an effect from outside the catalogue that do or do not stand, and the share there."""
    pairs = [
        (share, case.true(name))
        for case, row in zip(cases, shares, strict=True)
        for one, share in zip(case.hypotheses, row.tolist(), strict=False)
        for name in (one.names if one.outside else ())
        if name in catalogue() and (name in one.standing) == standing
    ]
    said, true = np.array(pairs, dtype=float).reshape(-1, 2).T
    return float(said.sum()), float(said @ true / said.sum())


def by_group(cases: Sequence[Known], shares: Array, right: Array) -> list[str]:
    """Rows of a table: cases, names exactly right, a wrong name, none of the catalogue likelier than not."""
    rows = []
    for group in sorted({case.group for case in cases}):
        own = [k for k, case in enumerate(cases) if case.group == group]
        exact = wrong = none = 0
        for k in own:
            case, likely = cases[k], names_of(cases[k], shares[k])
            named = [name for name, share in likely.items() if share > 0.5]
            exact += case.right(Hypothesis(tuple(named), 0.0, 0.0, 0.0, 0, False)) or (case.truth is None and not named)
            wrong += any(not case.true(name) for name in named)
            outside = sum(p for p, one in zip(shares[k], case.hypotheses, strict=False) if one.outside)
            none += shares[k, -1] + outside > 0.5
        reach = sum(cases[k].reachable for k in own)
        rows.append(f"| {group} | {len(own)} | {reach} | {exact} | {wrong} | {none} | {right[own].mean():.3f} |")
    return rows


def markdown(cases: Sequence[Known], found: Mapping[str, float], command: str) -> str:
    """The tables."""
    usable = [case for case in cases if case.reachable]
    table, every = Table(usable), Table(cases)
    decided = {name: getattr(POLICY, name) for name in WEIGHTS}
    shares = every.shares(decided)
    rows, error = reliability(cases, shares)
    lines = ["# How sure?", "", f"`{command}`, {len(cases)} cases; {len(usable)} of them reach the right answer.", ""]
    lines += [SETS, ""]
    lines += ["| weight | in the policy | fitted | loss without it | halved | doubled |", "|---|---|---|---|---|---|"]
    for name in WEIGHTS:
        without = table.loss(fitted(table, dict(found) | {name: 0.0}, frozenset({name})))
        others = (table.loss(decided | {name: factor * decided[name]}) for factor in (0.5, 2.0))
        figures = " | ".join(f"{value:.4f}" for value in (without, *others))
        lines.append(f"| {name} | {decided[name]:g} | {found[name]:.2f} | {figures} |")
    lines += ["", f"Mean log loss {table.loss(decided):.4f} by the policy, {table.loss(found):.4f} as fitted.", ""]
    lines += ["| group | cases | reach it | exactly right | a wrong name | none > .5 | mean P of the right answer |"]
    lines += ["|---|---|---|---|---|---|---|", *by_group(cases, shares, every.of_right(shares))]
    lines += ["", f"Names by their probability; expected calibration error {error:.3f}:", ""]
    lines += ["| from | names | mean probability | true |", "|---|---|---|---|", *rows]
    shown = [case.true(name) for case in cases for name in case.detected if "withheld" not in case.group]
    lines += ["", f"Of {len(shown)} names that the signals show directly {sum(shown)} are true."]
    for stand, left in ((True, "the residual doubles"), (False, "it is less")):
        said, there = beside_outside(cases, shares, stand)
        figures = f"{said:.1f} by probability, {there:.0%} are true."
        lines += [f"Of names next to an unknown effect without which {left}, {figures}"]
    return "\n".join(lines) + "\n"


def main(
    sets: Annotated[list[Path], typer.Argument(help="Folders of cases.", exists=True)],
    features: Annotated[Path, typer.Option(help="File of what was found of them, made if it is not there.")],
    jobs: Annotated[int, typer.Option(min=1)] = 2,
    out: Annotated[Path | None, typer.Option(help="Folder for certainty.md.")] = None,
) -> None:
    """Fit the weights of the probabilities and tell what each is worth."""
    if not features.exists():
        asked = [(case, False) for case in folders(sets)]
        asked += [(case, True) for home in sets for case in folders([home])[::2] if has_truth(case)]
        with running(jobs) as run:
            found = [asdict(case) for case in run.each("hypotheses", known, asked) if case is not None]
        write_text(features, json.dumps(found))
    cases = kept(features)
    start = {name: getattr(POLICY, name) for name in WEIGHTS}
    weights = fitted(Table([case for case in cases if case.reachable]), start)
    command = f"python -m tests.studies.certainty {' '.join(home.name for home in sets)} --features {features.name}"
    text = markdown(cases, weights, command)
    typer.echo(text)
    publish(out, {"certainty.md": text})


def has_truth(case: Path) -> bool:
    """Whether something of the catalogue is hidden in a case, and nothing else beside it that is not known."""
    truth = json.loads((case / "truth.json").read_text(encoding="utf-8"))
    return bool(truth["effects"]) and truth["group"] not in ("outside", "injected")


if __name__ == "__main__":
    typer.run(main)
