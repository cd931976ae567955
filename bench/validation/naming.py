"""How often what is hidden is named, and what is not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.validation.coverage import Share
from bench.validation.run import Run
from bench.validation.score import Named

#: Verdicts, as the contract has them.
EXPLAINED, UNEXPLAINED = "explained", "unexplained_remainder"
#: What is hidden in a null; what is said instead of a name.
NOTHING, NOTHING_MISSING, REMAINDER, REFUSED = "nothing", "nothing missing", "only a remainder", "refused"


@dataclass(frozen=True)
class Naming:
    """Names over all runs that were diagnosed.

    Attributes:
        nulls: those of them with a false name, of runs with nothing hidden that were not refused.
        nulls_by_motion: the same by the kind of motion.
        false: the same of all runs, whatever is hidden.
        silent: of these runs, those with a false name in a verdict that explains all.
        exact: runs whose names are those of what is hidden, of all, refused ones too.
        refused: runs without a diagnosis.
        named: by effect, how often it is named where it is hidden.
        falsely: by effect, how often it is named where it is not.
        confusion: of runs with one effect or none, by what is hidden, how often each name is given, or what instead.
    """

    nulls: Share
    nulls_by_motion: Mapping[str, Share]
    false: Share
    silent: Share
    exact: Share
    refused: Share
    named: Mapping[str, Share]
    falsely: Mapping[str, int]
    confusion: Mapping[str, Mapping[str, int]]


def naming(runs: Sequence[Run]) -> Naming | None:
    """Names of the runs that were diagnosed; None if none was."""
    pairs = [(run, run.named) for run in runs if run.named is not None]
    if not pairs:
        return None
    named_runs = [(run, named) for run, named in pairs if named.verdict]
    nulls = [(run.motion, named) for run, named in named_runs if not run.hidden]
    motions = {motion: [named for other, named in nulls if other == motion] for motion in sorted({m for m, _ in nulls})}
    hidden = Counter(name for run, _ in pairs for name in run.hidden)
    missed = Counter(name for _, named in pairs for name in named.missed)
    confusion: dict[str, Counter[str]] = {}
    for run, named in pairs:
        if len(run.hidden) < 2:
            confusion.setdefault(next(iter(run.hidden), NOTHING), Counter()).update(given(named))
    return Naming(
        nulls=_false([named for _, named in nulls]),
        nulls_by_motion={motion: _false(those) for motion, those in motions.items()},
        false=_false([named for _, named in named_runs]),
        silent=Share(sum(bool(named.false) and named.verdict == EXPLAINED for _, named in named_runs), len(named_runs)),
        exact=Share(sum(named.exact for _, named in pairs), len(pairs)),
        refused=Share(len(pairs) - len(named_runs), len(pairs)),
        named={name: Share(hidden[name] - missed[name], hidden[name]) for name in sorted(hidden)},
        falsely=dict(Counter(name for _, named in named_runs for name in named.false)),
        confusion={name: dict(confusion[name]) for name in sorted(confusion, key=lambda name: (name == NOTHING, name))},
    )


def _false(names: Sequence[Named]) -> Share:
    return Share(sum(bool(named.false) for named in names), len(names))


def given(named: Named) -> tuple[str, ...]:
    """Names, or what was said instead."""
    if not named.verdict:
        return (REFUSED,)
    instead = REMAINDER if named.verdict == UNEXPLAINED else NOTHING_MISSING
    return named.names or (instead,)
