"""Realistic axes: four to six small effects at once, recorded soundly, twice.

`python -m tests.studies.nuisance --realistic 40`. Asked: nine tenths of the effects named, none false, J within its
interval in nine tenths of the cases.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

import numpy as np

from bench.validation.independent.effects import CATALOGUE, any_effects
from bench.validation.independent.rig import random_rig
from bench.validation.independent.sensors import random_sensors
from tests.cases import Hidden, record, write_case
from tests.studies.blind.draw import Drawn
from tests.studies.blind.record import truth_of
from tests.studies.blind.score import same, twins
from tests.studies.frame import csv_of, running, table
from tests.studies.nuisance.answer import Answer, ask
from tests.studies.nuisance.record import TOGETHER

#: Severity of each effect, and how many there are.
SEVERITY, MANY = (0.15, 0.4), (4, 6)
#: Of the first recording, about; the control period of all axes, so that they are simulated together - s.
DURATION, CONTROL_PERIOD = 5.0, 250e-6
HEADINGS = ("case", "hidden", "severities", "missed", "false", "verdict", "inertia_half_widths", "seconds", "said")


@dataclass(frozen=True)
class Realistic:
    """A case, judged.

    Attributes:
        hidden: effects of the case.
        missed: those of them that are not named, nor their twins.
        false: names that are neither.
        half_widths: error of J in half widths of its interval, nan without J.
    """

    name: str
    hidden: tuple[str, ...]
    severities: tuple[float, ...]
    answer: Answer
    missed: tuple[str, ...]
    false: tuple[str, ...]
    half_widths: float


def severities_of(seed: int, place: int, count: int) -> list[float]:
    """Of each effect of a case."""
    return np.random.default_rng([seed, place, 4]).uniform(*SEVERITY, count).tolist()


def draw(seed: int, count: int) -> list[Drawn]:
    """Rotary axes with four to six compatible effects each."""
    return [one(seed, place) for place in range(count)]


def one(seed: int, place: int) -> Drawn:
    """The case at a place; the same however many are drawn."""
    rng = np.random.default_rng([seed, place, 3])
    name = f"realistic-{place:03d}"
    axis = replace(random_rig(rng, name), control_period=CONTROL_PERIOD)
    names = any_effects(int(rng.integers(MANY[0], MANY[1] + 1)), rng)
    severities = severities_of(seed, place, len(names))
    effects = [CATALOGUE[effect].draw(axis, s, rng, DURATION) for effect, s in zip(names, severities, strict=True)]
    mean = float(np.mean(severities))
    return Drawn(Hidden(name, axis, tuple(effects), random_sensors(axis, rng), "realistic", mean, DURATION), place)


def scored(folder: Path, drawn: Sequence[Drawn], seed: int, jobs: int, show: bool = True) -> list[Realistic]:
    """Record what is missing, diagnose all, judge them; in the order drawn."""
    with running(jobs, show) as run:
        run.counted("recording", len(drawn), recorded(folder, drawn, seed, run.pool))
        answers = run.each("diagnosing", answered, [(folder / case.name,) for case in drawn])
    scores = []
    for case, answer in zip(drawn, answers, strict=True):
        severities = severities_of(seed, case.number, len(case.hidden.effects))
        scores.append(judged(case.name, truth_of(folder, case.name), tuple(severities), answer))
    return scores


def recorded(folder: Path, drawn: Sequence[Drawn], seed: int, pool: Executor) -> Iterator[int]:
    """Record what is not recorded yet; yields how many cases are done, as they are."""
    missing = [case for case in drawn if not _kept(folder / case.name / "truth.json", case)]
    yield len(drawn) - len(missing)
    tasks = [pool.submit(_record, folder, missing[k : k + TOGETHER], seed) for k in range(0, len(missing), TOGETHER)]
    for task in as_completed(tasks):
        yield task.result()


def _kept(truth: Path, case: Drawn) -> bool:
    """Whether this very case is recorded, not one of its name that was drawn by other rules."""
    return truth.exists() and json.loads(truth.read_text(encoding="utf-8")).get("drawn") == repr(case.hidden)


def _record(folder: Path, drawn: Sequence[Drawn], seed: int) -> int:
    cases, numbers = [case.hidden for case in drawn], [case.number for case in drawn]
    runs = record(cases, seed, numbers=numbers)
    for case, pair in zip(cases, runs, strict=True):
        entry = write_case(folder, case, pair) | {"drawn": repr(case)}
        # last, since it says that the case is complete
        (folder / case.name / "truth.json").write_text(json.dumps(entry, indent=1), encoding="utf-8")
    return len(drawn)


def answered(place: Path) -> Answer:
    """What `bench diagnose` says of the first recording, with the second as holdout."""
    return ask("diagnose", [place / "run1.csv.gz"], place / "rig.toml", "--holdout", str(place / "run2.csv.gz"))


def judged(name: str, truth: dict, severities: tuple[float, ...], answer: Answer) -> Realistic:
    """Which names are missed, which false, and where J stands."""
    hidden = tuple(truth["effects"])
    missed = tuple(effect for effect in hidden if twins(effect) not in same(answer.named))
    false = tuple(effect for effect in answer.named if twins(effect) not in same(hidden))
    half_widths = float("nan")
    if answer.inertia is not None:
        value, low, high = answer.inertia
        half_widths = abs(value - truth["inertia"]) / max(0.5 * (high - low), 1e-300)
    return Realistic(name, hidden, severities, answer, missed, false, half_widths)


def markdown(scores: Sequence[Realistic], command: str) -> str:
    """All figures of a run."""
    parts = ("# Realistic axes", f"`{command}`", headline(scores), by_effect(scores), not_right(scores))
    return "\n\n".join(parts) + "\n"


def headline(scores: Sequence[Realistic]) -> str:
    """What the whole set comes to."""
    hidden, missed = sum(len(s.hidden) for s in scores), sum(len(s.missed) for s in scores)
    alone = sum(bool(s.false) and s.answer.verdict != "unexplained_remainder" for s in scores)
    rows = [
        ("effects named", f"{hidden - missed} of {hidden}, {100.0 * (1.0 - missed / hidden):.1f} %", "90 %"),
        ("cases with a false name", f"{sum(bool(s.false) for s in scores)} of {len(scores)}", "0"),
        ("of these without a remainder", str(alone), "0"),
        ("J within its 95 % interval", f"{sum(s.half_widths <= 1.0 for s in scores)} of {len(scores)}", "90 %"),
        ("J within three half widths", f"{sum(s.half_widths <= 3.0 for s in scores)} of {len(scores)}", ""),
        ("named exactly", f"{sum(not (s.missed or s.false) for s in scores)} of {len(scores)}", ""),
        ("no diagnosis", f"{sum(s.answer.status != 0 for s in scores)} of {len(scores)}", ""),
        ("seconds a case, median", f"{median(s.answer.seconds for s in scores):.1f}", ""),
    ]
    return table(("what", "measured", "asked"), rows)


def by_effect(scores: Sequence[Realistic]) -> str:
    """How often each effect is hidden, named, and falsely named."""
    rows = []
    for effect in CATALOGUE:
        hidden = sum(effect in score.hidden for score in scores)
        missed = sum(effect in score.missed for score in scores)
        false = sum(effect in score.false for score in scores)
        rows.append((effect, hidden - missed, hidden, false))
    return "## By effect\n\n" + table(("effect", "named", "hidden", "falsely named"), rows)


def not_right(scores: Sequence[Realistic]) -> str:
    """Cases with something missed or false, or J outside."""
    rows = []
    for s in scores:
        if s.missed or s.false or not s.half_widths <= 1.0:
            said = s.answer.verdict or s.answer.said
            names = (", ".join(those) for those in (s.hidden, s.missed, s.false))
            rows.append((s.name, *names, said, f"{s.half_widths:.2f}"))
    return "## Not right\n\n" + table(("case", "hidden", "missed", "false", "verdict", "J, half widths"), rows)


def cases_csv(scores: Sequence[Realistic]) -> str:
    """One line a case."""
    rows = []
    for s in scores:
        strong = " ".join(f"{severity:.2f}" for severity in s.severities)
        names = ("+".join(those) for those in (s.missed, s.false))
        cells = (f"{s.half_widths:.2f}", f"{s.answer.seconds:.1f}", s.answer.said)
        rows.append((s.name, "+".join(s.hidden), strong, *names, s.answer.verdict, *cells))
    return csv_of(HEADINGS, rows)
