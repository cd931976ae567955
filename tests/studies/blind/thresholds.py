"""Every number off, halved and doubled: `python -m tests.studies.blind.thresholds --help`.

Over a part of the blind set, and over effects put into real and realistic recordings. A case's recordings are laid out
once and named under every policy, a search going on from the fits of the policy as it is. The judgement of held-out
motion that follows has no threshold of its own and is left out for its time.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from bench.diagnosis.policy import POLICY, Policy
from bench.diagnosis.probability import Contender, probabilities, weighed
from bench.diagnosis.recordings import Recordings, fit_bare
from bench.diagnosis.search import search
from bench.effects.catalogue import catalogue
from bench.errors import BenchError
from bench.fit.fit import Fit
from bench.rig.rig import Rig, load_rig
from bench.trace.read import read
from bench.trace.trace import Trace
from bench.validation.independent.effects import CATALOGUE
from tests.studies.blind.draw import Drawn, draw
from tests.studies.blind.record import home, recorded, truth_of
from tests.studies.blind.score import same
from tests.studies.blind.variants import FACTORS, Threshold, thresholds
from tests.studies.frame import publish, running, table
from tests.studies.injected.__main__ import owns_of
from tests.studies.injected.cases import Case, Known, effect_of
from tests.studies.injected.cases import draw as draw_injected
from tests.studies.injected.sources import Source, real, simulated

COUNTS = {"single": 252, "pair": 60, "null": 100, "outside": 32}
#: Group of effects that were put into recordings.
INJECTED = "injected"
AS_IS = "as is"


@dataclass(frozen=True)
class Named:
    """What one policy makes of a case: names, and whether something is left unexplained; refused: neither."""

    names: tuple[str, ...] = ()
    remains: bool = False
    refused: bool = False


def variants_of(folder: Path) -> dict[str, Named]:
    """A blind case under the policy as it is, with each threshold halved and doubled."""
    rig = load_rig(folder / "rig.toml")
    return variants(rig, *(read(folder / f"{run}.csv.gz", rig.trace.columns) for run in ("run1", "run2")))


def variants_with(case: Case, source: Source, own: Known) -> dict[str, Named]:
    """The same of an effect that is put into a recording."""
    effect = effect_of(case, own)
    assert effect is not None, f"{case.name} is not possible"
    return variants(own.host.rig, source.made_with(own.host, effect))


def variants(rig: Rig, trace: Trace, holdout: Trace | None = None) -> dict[str, Named]:
    """Recordings under the policy as it is, with each threshold halved and doubled."""
    keys = [AS_IS, *(key(each, factor) for each in thresholds() for factor in each.factors)]
    try:
        recordings = Recordings.of([trace], rig, holdout)
    except BenchError:
        return dict.fromkeys(keys, Named(refused=True))
    bare = fit_bare(recordings.rows)
    first = tried(recordings, bare, POLICY)
    found = {AS_IS: named(recordings, first, POLICY)}
    for each in thresholds():
        for label, factor in each.factors.items():
            with each.times(factor) as policy:
                again = tried(recordings, bare, policy, [one.fitted for one in first])
                found[key(each, label)] = named(recordings, again, policy)
    return found


def key(threshold: Threshold, factor: str) -> str:
    """Of a variant."""
    return f"{threshold.owner}.{threshold.name} {factor}"


def tried(recordings: Recordings, bare: Fit, policy: Policy, known: Sequence[Fit] = ()) -> list[Contender]:
    """The hypotheses that a policy comes to, from what another one visited."""
    visited = search(bare, [*catalogue().values()], policy, known=known).visited
    return weighed(visited, recordings.holdout_rows, policy)


def named(recordings: Recordings, hypotheses: Sequence[Contender], policy: Policy) -> Named:
    """The likeliest names under a policy."""
    likely = probabilities(hypotheses, frozenset(), policy)
    last = likely.fits[likely.chosen]
    names = (*last.hypothesis.names, *(effect.name for effect in recordings.detected))
    return Named(names, policy.remains(last))


@dataclass(frozen=True)
class Tally:
    """Cases of each group that are right, and cases in which a name is wrong."""

    right: Mapping[str, int]
    wrong: int

    @classmethod
    def of(cls, truths: Sequence[Mapping[str, Any]], found: Sequence[Named]) -> Tally:
        """Of cases under one policy."""
        right, wrong = dict.fromkeys((*COUNTS, INJECTED), 0), 0
        for truth, said in zip(truths, found, strict=True):
            hidden = set() if truth["group"] == "outside" else same(truth["effects"])
            exact = not said.refused and same(said.names) == hidden
            if truth["group"] == INJECTED:  # next to what the recording has of its own
                exact = same([truth["put in"]]) <= same(said.names) <= hidden
            right[truth["group"]] += exact and (said.remains or truth["group"] != "outside")
            wrong += bool(same(said.names) - hidden)
        return cls(right, wrong)

    def __str__(self) -> str:
        return " ".join(str(self.right[group]) for group in (*COUNTS, INJECTED)) + f", {self.wrong}"


def sample(seed: int, duration: float, one_in: int) -> list[Drawn]:
    """Every so many-th case of each group; of singles a later one in each round of effects, so that all come."""
    kept = []
    for group, count in COUNTS.items():
        cases = draw(seed, {group: count}, duration)
        rounds = len(CATALOGUE) if group == "single" else count
        kept += [case for k, case in enumerate(cases) if (k % rounds + k // rounds) % one_in == 0]
    return kept


def markdown(truths: Sequence[Mapping[str, Any]], found: Sequence[Mapping[str, Named]], command: str) -> str:
    """The table."""

    def tally(variant: str) -> Tally:
        return Tally.of(truths, [variants[variant] for variants in found])

    cases = [sum(truth["group"] == group for truth in truths) for group in (*COUNTS, INJECTED)]
    as_is, rows = tally(AS_IS), []
    for each in thresholds():
        others = {factor: tally(key(each, factor)) for factor in each.factors}
        idle = " (changes nothing here)" if all(other == as_is for other in others.values()) else ""
        cells = [others.get(factor, "") for factor in FACTORS]
        owner = each.owner.rpartition(".")[2].partition(":")[0]
        rows.append((f"{owner}.{each.name}", f"{each.value:g}", f"{each.decides}{idle}", as_is, *cells))
    lines = [
        "# Thresholds",
        "",
        f"Each alone off, halved and doubled over {len(truths)} cases of the [blind and injected sets](validation.md).",
        f"`{command}`",
        "",
        "Counts: singles, pairs, nulls, cases outside the catalogue and injected effects that are right,",
        f"of {', '.join(map(str, cases))}; then cases with a wrong name. Names before held-out motion judges them.",
        "",
        table(("threshold", "value", "what it decides", "as is", *FACTORS), rows),
    ]
    return "\n".join(lines) + "\n"


def main(
    one_in: Annotated[int, typer.Option(min=1, help="Share of the blind set: each so many-th of a group.")] = 6,
    injected: Annotated[int, typer.Option(min=0, help="Effects put into recordings.")] = 0,
    most: Annotated[int, typer.Option(min=1, help="Cases of the blind set at most, for a try.")] = sum(COUNTS.values()),
    seed: int = 1,
    duration: Annotated[float, typer.Option(help="Of the first recording, about - s.")] = 8.0,
    jobs: Annotated[int, typer.Option(min=1)] = 2,
    out: Annotated[Path | None, typer.Option(help="Folder for thresholds.md.")] = None,
) -> None:
    """Halve and double each threshold that decides on names, and count what becomes of recordings of known truth."""
    drawn, folder = sample(seed, duration, one_in)[:most], home(seed, duration, None)
    sources = {source.name: source for source in ([*real(), *simulated(seed, 12, jobs)] if injected else [])}
    owns, _ = owns_of([*sources.values()], jobs) if sources else ({}, {})
    into = [each for each in draw_injected([*owns], [], seed) if effect_of(each, owns[each.source])][:injected]
    with running(jobs) as run:
        run.counted("recording", len(drawn), recorded(folder, drawn, seed, run.pool))
        found = run.each("naming", variants_of, [(folder / case.name,) for case in drawn])
        items = [(case, sources[case.source], owns[case.source]) for case in into]
        found += run.each("naming effects put in", variants_with, items)
    truths = [truth_of(folder, case.name) for case in drawn]
    truths += [
        {"group": INJECTED, "put in": case.effect, "effects": [case.effect, *own.beside]} for case, _, own in items
    ]
    command = f"python -m tests.studies.blind.thresholds --one-in {one_in} --injected {injected} --seed {seed}"
    text = markdown(truths, found, command)
    typer.echo(text)
    publish(out, {"thresholds.md": text})


if __name__ == "__main__":
    typer.run(main)
