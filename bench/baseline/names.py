"""Effects that appeared, are gone, or have another name: the significance of each, by the torque of the effect.

Naming is a threshold: an effect near it is named in one recording and not in the next. So torques are compared instead
of names. For an effect that the baseline does not name there is an upper bound - the torque from which on it would have
been named, or that the residual may hide -; it has appeared if its torque is clearly above that now. An effect that the
baseline names is fitted again, named or not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from bench.baseline.allowed import OF_EFFECTS, Allowed
from bench.baseline.comparison import Comparison
from bench.baseline.state import NamedHere, State
from bench.comparison.difference import Difference, Measured


@dataclass(frozen=True)
class Matched:
    """Effects of two states, matched.

    Attributes:
        both: pairs of one name.
        renamed: pairs that a recording cannot distinguish.
        gone: those of the baseline that are not named now.
        appeared: those named now that the baseline does not have.
    """

    both: tuple[tuple[NamedHere, NamedHere], ...]
    renamed: tuple[tuple[NamedHere, NamedHere], ...]
    gone: tuple[NamedHere, ...]
    appeared: tuple[NamedHere, ...]

    @property
    def alike(self) -> bool:
        """Whether both states have the same effects."""
        return not (self.renamed or self.gone or self.appeared)

    def others(self, baseline: State) -> list[tuple[NamedHere, NamedHere | None]]:
        """Effects of the baseline, each with its match now; None without one."""
        own = [*self.both]
        return [(effect, next((now for before, now in own if before is effect), None)) for effect in lasting(baseline)]


def lasting(state: State) -> list[NamedHere]:
    """Effects of a state that occur in every recording of the axis."""
    return [effect for effect in state.effects if not effect.effect.occasional]


def matched(baseline: State, now: State) -> Matched:
    """Pairs of the same effect, then pairs that are `ambiguous_with` each other, then the rest."""
    before, after = lasting(baseline), lasting(now)
    both = _paired(before, after, lambda one, other: one.same(other))
    renamed = _paired(before, after, lambda one, other: one.indistinguishable_from(other))
    return Matched(tuple(both), tuple(renamed), tuple(before), tuple(after))


def _paired(
    before: list[NamedHere], after: list[NamedHere], alike: Callable[[NamedHere, NamedHere], bool]
) -> list[tuple[NamedHere, NamedHere]]:
    """Pairs that are alike, removed from both lists."""
    pairs = []
    for one in list(before):
        other = next((candidate for candidate in after if alike(one, candidate)), None)
        if other is not None:
            before.remove(one)
            after.remove(other)
            pairs.append((one, other))
    return pairs


def of_both(
    pairs: Sequence[tuple[NamedHere, NamedHere]], allowed: Allowed, state: State, beside: float
) -> Iterator[Comparison]:
    """Comparisons of the quantities of effects that both states name.

    Args:
        pairs: effects in the baseline and now.
        allowed: margins and spreads.
        state: the baseline.
        beside: factor on the spread between recordings of different motion or sampling; 0 for the same.
    """
    for before, after in pairs:
        for key in before.compared.keys() & after.compared.keys():
            key_in_full, baseline, now = f"{before.name}.{key}", before.compared[key], after.compared[key]
            between = allowed.between_of(key_in_full, baseline)
            difference = Difference.of(baseline, now, between, beside * between)
            margin = allowed.margin_of(key_in_full, baseline, state)
            name = key_in_full if before.name == before.label else f"{before.label}: {key}"
            yield Comparison.of(name, baseline.unit, (baseline.value, now.value), [difference], margin)


def of_torque(
    before: NamedHere, now: Measured | None, allowed: Allowed, unlike: str, name: str, effect: str
) -> Comparison:
    """Comparison of the torque of an effect of the baseline, whatever its name is now."""
    if before.torque is None or now is None:
        held_back = "the torque balance does not hold it, so its strength is not told"
        return Comparison.of(name, "", (None, None), [], 0.0, effect, held_back)
    difference = Difference.of(before.torque, now, allowed.between_of(before.name, before.torque))
    values = before.torque.value, now.value
    margin = OF_EFFECTS * before.torque.value
    return Comparison.of(name, before.torque.unit, values, [difference], margin, effect, unlike)


def of_appeared(after: NamedHere, baseline: State, allowed: Allowed, unlike: str) -> Comparison:
    """Comparison of the torque of an effect that is new with what the baseline's recording would have shown."""
    if after.torque is None or baseline.shows is None:
        held_back = "told by its signals alone, which do not say from when on the baseline would have shown it"
        return Comparison.of(after.label, "", (None, None), [], 0.0, "appeared", held_back)
    numbers = len(after.quantities)
    least = baseline.shows.named_from(max(numbers, 1))
    nothing = Measured(0.0, after.torque.unit, after.torque.std_error)
    between = allowed.between_of(after.name, after.torque)
    difference = Difference.of(nothing, after.torque, between)
    values = None, after.torque.value
    return Comparison.of(after.label, after.torque.unit, values, [difference], least, "appeared", unlike)


def of_names(
    found: Matched, torques: Mapping[int, Measured], baseline: State, allowed: Allowed, unlike: str
) -> Iterator[Comparison]:
    """Comparisons of all names that differ between the states.

    Args:
        found: effects of both states.
        torques: of the baseline's effects as the recording now has them, by their `id`.
        baseline: the state.
        allowed: margins.
        unlike: why the motion of the two cannot be compared; empty where it can.
    """
    for before, after in found.renamed:
        yield of_torque(before, after.torque, allowed, unlike, f"{before.label} or {after.label}", "")
    for before in found.gone:
        yield of_torque(before, torques.get(id(before)), allowed, unlike, before.label, "gone")
    for after in found.appeared:
        yield of_appeared(after, baseline, allowed, unlike)
