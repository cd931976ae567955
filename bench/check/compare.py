"""Hold two states of an axis against each other: quantities, names, gaps and verdict, with one false-alarm rate."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from bench.check.allowed import OTHER_MOTION, Allowed
from bench.check.comparison import CHANGED, RESULTS, SAME, UNDECIDED, Comparison
from bench.check.conditions import unlike
from bench.check.difference import Difference, holm
from bench.check.measured import Measured
from bench.check.names import Matched, matched, of_both, of_names
from bench.check.observe import Observed
from bench.check.same_rig import differing
from bench.check.state import GAPS, TORQUE_GAP, VELOCITY_GAP, NamedHere, State
from bench.effects.catalogue import catalogue


@dataclass(frozen=True)
class Checked:
    """What a check found.

    Attributes:
        result: `same`, `changed` or `undecided`.
        comparisons: of every quantity and name, worst first.
        baseline, now: the states.
        appeared, gone: effects that are named in one of the states only, with their comparisons.
        rig, conditions: a line for each thing that differs in the rig, and in motion and sampling.
        false_alarm_rate: of all comparisons together.
        family: comparisons that were made, those of effects that nobody named counted.
    """

    result: str
    comparisons: tuple[Comparison, ...]
    baseline: State
    now: State
    appeared: tuple[tuple[NamedHere, Comparison], ...]
    gone: tuple[tuple[NamedHere, Comparison], ...]
    rig: tuple[str, ...]
    conditions: tuple[str, ...]
    false_alarm_rate: float
    family: int


def compare(baseline: State, now: Observed, allowed: Allowed, rate: float) -> Checked:
    """Whether the axis is the same.

    Args:
        baseline: what it was.
        now: what recordings, or a model, tell of it.
        allowed: margins and spreads.
        rate: at which an axis that differs by no margin is called changed.
    """
    state = now.state
    rig, moved = differing(baseline.rig, state.rig), unlike(baseline.conditions, state.conditions)
    found = matched(baseline, state)
    parameters, torques = ({}, {}) if found.alike or now.fitted is None else _under(baseline, found, now)
    other_motion = "the motion is not that of the baseline" if moved else ""
    names = [*of_names(found, torques, baseline, allowed, other_motion)]
    pairs = [*of_both(found.both, allowed, baseline, OTHER_MOTION if moved else 0.0)]
    silent = _silent(baseline, state) if baseline.shows is not None else 0
    family = len(baseline.quantities) + len(names) + len(pairs) + silent
    sure = all(one.chance <= rate / family for one in names)
    under = {name: one for name, one in parameters.items() if name == TORQUE_GAP or not sure}
    comparisons = [*_of_quantities(baseline, state, under, allowed, bool(moved), found.alike), *pairs, *names]
    if rig:
        comparisons = [replace(one, chance=1.0, held_back="the rig is not that of the baseline") for one in comparisons]
    rejected = holm({one.name: one.chance for one in comparisons}, rate, silent)
    answered = [one.answered(rejected) for one in comparisons]
    answered.sort(key=lambda one: (RESULTS.index(one.result), one.chance))
    by_name = {one.name: one for one in answered}
    return Checked(
        result=_together(answered, baseline, state),
        comparisons=tuple(answered),
        baseline=baseline,
        now=state,
        appeared=tuple((effect, by_name[effect.label]) for effect in found.appeared),
        gone=tuple((effect, by_name[effect.label]) for effect in found.gone),
        rig=tuple(rig),
        conditions=tuple(moved),
        false_alarm_rate=rate,
        family=family,
    )


def _under(baseline: State, found: Matched, now: Observed) -> tuple[dict[str, Measured], dict[int, Measured | None]]:
    """Quantities now with the effects of the baseline, and the torque of each of these, by its `id`."""
    others = found.others(baseline)
    parameters, torques = now.under(others)
    return parameters, {id(effect): torque for (effect, _), torque in zip(others, torques, strict=True)}


def _of_quantities(
    baseline: State,
    now: State,
    under: Mapping[str, Measured],
    allowed: Allowed,
    moved: bool,
    alike: bool,
) -> Iterator[Comparison]:
    """Comparisons of parameters and gaps.

    Args:
        baseline, now: the states.
        under: quantities now with the effects of the baseline. A name that has surely come or gone has changed the
            axis, and each state is told by its own; one on the edge has not, and a change has to show with both.
        allowed: margins and spreads.
        moved: whether motion or sampling differ.
        alike: whether the effects are the same.
    """
    for name in (name for name in baseline.quantities if name in now.quantities):
        before, after = baseline.quantities[name], now.quantities[name]
        views = [after] + ([under[name]] if name in under else [])
        if name == VELOCITY_GAP and not alike:
            continue  # of models with other effects, which are told apart by these
        held_back = "what a model leaves depends on the motion" if name in GAPS and moved else ""
        if name == TORQUE_GAP and name in under:
            views = [under[name]]  # how much the baseline's effects leave now, whatever else was found
        if before.unit != after.unit:
            yield Comparison.of(name, before.unit, (before.value, None), [], 0.0, held_back=f"now in {after.unit}")
            continue
        between = allowed.between_of(name, before)
        beside = OTHER_MOTION * between if moved else 0.0
        differences = [Difference.of(before, view, between, beside) for view in views]
        margin = allowed.margin_of(name, before, baseline)
        values = before.value, views[0].value
        yield Comparison.of(name, before.unit, values, differences, margin, held_back=held_back)


def _silent(baseline: State, now: State) -> int:
    """Effects of the catalogue that neither state names: they were looked for too."""
    return len(set(catalogue()) - {effect.name for effect in (*baseline.effects, *now.effects)})


def _together(answered: list[Comparison], baseline: State, now: State) -> str:
    """One answer: a verdict that alone differs is on the edge of its threshold, and decides nothing."""
    results = {one.result for one in answered}
    if CHANGED in results:
        return CHANGED
    return SAME if results <= {SAME} and baseline.verdict == now.verdict else UNDECIDED
