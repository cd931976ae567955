"""How far estimates lie from the truth, how often their intervals hold it, and how often names are right."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import special

from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.diagnosis.diagnosis import Diagnosis
from bench.diagnosis.name import NamedEffect
from bench.parameter import Parameter
from bench.validation.independent.effects import Effect as Hidden
from bench.validation.independent.rig import Axis
from bench.validation.plan import Case

#: Terms of the equation of motion that are judged, as `Axis` has them too.
TERMS = (INERTIA, VISCOUS, COULOMB)


@dataclass(frozen=True)
class Scored:
    """One estimated quantity with its true value.

    Attributes:
        by: identify or diagnose.
        effect: that it belongs to, empty for J, K_w and K_0.
        quantity: its name; of J, K_w and K_0 the term of the equation of motion.
        true: true value; of an angle within half a turn of the estimate - the parameter's unit.
        scale: of errors: magnitude of the true value; 1 for an angle or zero.
        parameter: the estimate.
    """

    by: str
    effect: str
    quantity: str
    true: float
    scale: float
    parameter: Parameter

    @property
    def error(self) -> float:
        """Estimate less true value, over the scale."""
        return (self.parameter.value - self.true) / self.scale

    @property
    def half_width(self) -> float:
        """Half width of the interval of 95 %, over the scale."""
        return self.parameter.half_width / self.scale

    def inside(self, level: float) -> bool:
        """Whether the interval of a level contains the true value."""
        low, high = self.parameter.interval(level)
        return bool(low <= self.true <= high)


def base(by: str, case: Case, parameters: Mapping[str, Parameter]) -> Iterator[Scored]:
    """J, K_w and K_0, as far as they are determined, by identify or diagnose; parameters by the contract's names."""
    for term in TERMS:
        name, true = case.rig.axis_kind.parameter(term), getattr(case.axis, term)
        if name in parameters:
            yield Scored(by, "", term, true, true, parameters[name])


def of_effects(effects: Iterable[Hidden], axis: Axis, diagnosis: Diagnosis) -> Iterator[Scored]:
    """Quantities of the effects that are named and hidden in an axis, without integers, which have no interval."""
    hidden = {effect.name: effect.quantities(axis) for effect in effects}
    for named in diagnosis.effects:
        truth = hidden.pop(named.name, {})
        angles = {quantity.name for quantity in named.effect.quantities if quantity.angle}
        integers = {shape.quantity.name for shape in named.effect.shapes if shape.whole}
        for name, parameter in named.parameters.items():
            if name in truth and parameter.std_error > 0.0 and name not in integers:
                true = truth[name]
                if name in angles:
                    true = parameter.value + math.remainder(true - parameter.value, 2.0 * np.pi)
                scale = 1.0 if name in angles or true == 0.0 else abs(true)
                yield Scored("diagnose", named.name, name, true, scale, parameter)


@dataclass(frozen=True)
class Named:
    """The names of a diagnosis.

    Attributes:
        verdict: as the contract has it; empty if there is none.
        names: those given.
        false: of these, those not hidden. A name matches effects that it is reported to be ambiguous with.
        missed: hidden effects that are not named.
        reason: why there is no diagnosis.
    """

    verdict: str = ""
    names: tuple[str, ...] = ()
    false: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    reason: str = ""

    @classmethod
    def of(cls, verdict: str, named: Sequence[NamedEffect], hidden: Sequence[str]) -> Named:
        """Names compared with the hidden effects; a name that is given twice matches only one."""
        left, false = list(hidden), []
        for effect in named:
            matched = next((name for name in (effect.name, *effect.ambiguous_with) if name in left), None)
            if matched is None:
                false.append(effect.name)
            else:
                left.remove(matched)
        return cls(verdict, tuple(effect.name for effect in named), tuple(false), tuple(left))

    @property
    def exact(self) -> bool:
        """Whether the names are exactly those of the hidden effects."""
        return bool(self.verdict) and not self.false and not self.missed


@dataclass(frozen=True)
class Run:
    """One run.

    Attributes:
        index, plant, motion, kind, hidden, severity: as drawn.
        noise: of speed and current, as white/mains.
        sample_period, duration: of the recording - s.
        status: done; refused by `identify`, which reports what it found all the same; failed where there is no
            recording.
        reason: why it is not done.
        scored: quantities, by `identify` and by `diagnose`.
        named: by `diagnose`, if it was run.
    """

    index: int
    plant: str
    motion: str
    kind: str
    noise: str
    sample_period: float
    duration: float
    hidden: tuple[str, ...]
    severity: float
    status: Literal["done", "refused", "failed"] = "done"
    reason: str = ""
    scored: tuple[Scored, ...] = ()
    named: Named | None = None


#: Levels of the intervals that are compared with the truth.
LEVELS = (0.5, 0.8, 0.95)


@dataclass(frozen=True)
class Share:
    """A share of cases with its bounds, exact by the binomial distribution.

    C. J. Clopper, E. S. Pearson, Biometrika 26, 1934, 404-413.

    Attributes:
        count, of: how many, and of how many.
    """

    count: int
    of: int

    @property
    def value(self) -> float:
        """The share; nan of none."""
        return self.count / self.of if self.of else math.nan

    @property
    def bounds(self) -> tuple[float, float]:
        """Of 95 %: 2.5 % on each side, and 0 and 1 of none."""
        if not self.of:
            return 0.0, 1.0
        beyond, others = (1.0 - 0.95) / 2.0, self.of - self.count
        low = special.betaincinv(self.count, others + 1, beyond) if self.count else 0.0
        high = special.betaincinv(self.count + 1, others, 1.0 - beyond) if others else 1.0
        return float(low), float(high)


@dataclass(frozen=True)
class Coverage:
    """One quantity over a group of runs.

    Attributes:
        by: identify or diagnose.
        group: of runs.
        quantity: term of the equation of motion, or quantity of the effect that the group is called by.
        runs: of the group.
        told: runs that estimate the quantity.
        bias, bias_error: mean of the errors over the true value, and its standard error.
        spread: standard deviation of these.
        typical: root of their mean square.
        half_width: median, over the true value.
        width_over_error: root of the mean square of half widths over `typical`: 1.96 of a normal distribution's.
        inside: share of the intervals that hold the truth, by `LEVELS`.
        whole: whether the group is all runs with so much hidden, or named, and not a part of them.
    """

    by: str
    group: str
    quantity: str
    runs: int
    told: int
    bias: float
    bias_error: float
    spread: float
    typical: float
    half_width: float
    width_over_error: float
    inside: tuple[Share, ...]
    whole: bool = True

    @classmethod
    def of(
        cls, by: str, quantity: str, scored: Sequence[Scored], runs: int, group: str = "", whole: bool = True
    ) -> Coverage:
        """Coverage of a quantity; nan without estimates."""
        error, half = (np.array([getattr(one, name) for one in scored]) for name in ("error", "half_width"))
        told, nan = len(scored), math.nan
        spread = float(np.std(error, ddof=1)) if told > 1 else nan
        typical, wide = (float(np.sqrt(np.mean(values**2))) if told else nan for values in (error, half))
        return cls(
            by=by,
            group=group,
            quantity=quantity,
            runs=runs,
            told=told,
            bias=float(np.mean(error)) if told else nan,
            bias_error=spread / math.sqrt(told) if told > 1 else nan,
            spread=spread,
            typical=typical,
            half_width=float(np.median(half)) if told else nan,
            width_over_error=wide / typical if typical > 0.0 else nan,
            inside=tuple(Share(sum(one.inside(level) for one in scored), told) for level in LEVELS),
            whole=whole,
        )


def coverage(runs: Sequence[Run]) -> list[Coverage]:
    """Each quantity of `identify`, then of `diagnose`, over all groups of runs."""
    found = []
    for by in ("identify", "diagnose"):
        for name, whole, some in _groups(runs, by):
            scored = [one for run in some for one in run.scored if one.by == by and not one.effect]
            for term in TERMS:
                those = [one for one in scored if one.quantity == term]
                found.append(Coverage.of(by, term, those, len(some), name, whole))
    return found + _of_effects(runs)


def _groups(runs: Sequence[Run], by: str) -> Iterator[tuple[str, bool, list[Run]]]:
    """By how much is hidden; nulls of `identify` by what else differs, diagnosed runs by whether that is named."""
    asked = [run for run in runs if run.status != "failed" and (by == "identify" or run.named is not None)]
    for count in sorted({len(run.hidden) for run in asked}):
        some = [run for run in asked if len(run.hidden) == count]
        name = ("nulls", "1 effect", f"{count} effects")[min(count, 2)]
        yield name, True, some
        if by == "identify" and count == 0:
            yield from ((part, False, those) for part, those in _apart(some))
        elif by == "diagnose" and count > 0:
            yield f"{name} named", True, [run for run in some if run.named is not None and run.named.exact]


def _parts(run: Run) -> tuple[str, ...]:
    """What runs of a kind differ in: plant, noise, kind of axis and motion."""
    white = set(run.noise.split("/")) == {"white"}
    return (
        {"mujoco": "by MuJoCo", "independent": "by the integrator"}[run.plant],
        "white noise" if white else "other noise too",
        f"{run.kind} axis",
        f"motion: {run.motion}",
    )


def _apart(runs: Sequence[Run]) -> Iterator[tuple[str, list[Run]]]:
    """Runs by each of their parts; not by what all share."""
    for names in zip(*map(_parts, runs), strict=True):
        distinct = sorted(set(names))
        for part in distinct if len(distinct) > 1 else ():
            yield part, [run for run, name in zip(runs, names, strict=True) if name == part]


def _of_effects(runs: Sequence[Run]) -> list[Coverage]:
    """Quantities of the effects that were named where they are hidden."""
    scored: dict[tuple[str, str], list[Scored]] = defaultdict(list)
    for one in (one for run in runs for one in run.scored if one.effect):
        scored[one.effect, one.quantity].append(one)
    hidden = Counter(name for run in runs if run.named is not None for name in run.hidden)
    return [
        Coverage.of("diagnose", quantity, those, hidden[effect], effect, False)
        for (effect, quantity), those in sorted(scored.items(), key=lambda entry: entry[0])
    ]


#: Verdicts, as the contract has them.
EXPLAINED, UNEXPLAINED = "explained", "unexplained_remainder"
#: What is hidden in a null; what is reported instead of a name.
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
    """Names, or what was reported instead."""
    if not named.verdict:
        return (REFUSED,)
    instead = REMAINDER if named.verdict == UNEXPLAINED else NOTHING_MISSING
    return named.names or (instead,)
