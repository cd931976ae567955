"""Outcome against truth, judged as the shared cases are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from tests.studies.blind.parameters import WHOLE, Compared, compared
from tests.studies.blind.run import Outcome

#: Names that the contract says no recording of the kind tells apart.
TWINS = (
    frozenset({"torque_offset", "direction_dependent_friction"}),
    frozenset({"current_loop_lag", "velocity_filter_lag"}),
)


def twins(name: str) -> frozenset[str]:
    """A name with its twin, if it has one."""
    return next((pair for pair in TWINS if name in pair), frozenset({name}))


def same(names: Sequence[str]) -> set[frozenset[str]]:
    """Names with twins taken as one."""
    return {twins(name) for name in names}


@dataclass(frozen=True)
class Score:
    """A case, judged.

    Attributes:
        right: names are exactly those hidden; none, and a remainder, if the physics is outside or taken away.
        inertia_error: relative, nan if it or all is refused.
        closed: share of the holdout torque gap above the noise floor that is closed, None if nothing stands above.
        without_truth: whether the hidden effects were taken out of the catalogue.
        quantities: by effect and quantity, what is reported beside the truth.
    """

    name: str
    truth: Mapping
    outcome: Outcome
    right: bool
    inertia_error: float
    closed: float | None
    without_truth: bool
    quantities: dict[str, dict[str, Compared]] = field(default_factory=dict)

    @property
    def group(self) -> str:
        """Of the case."""
        return self.truth["group"]

    @property
    def hidden(self) -> str:
        """Names hidden, joined."""
        return "+".join(self.truth["effects"])

    @property
    def intervals(self) -> list[bool]:
        """Whether each interval holds the truth, of what has one."""
        return [found.inside for those in self.quantities.values() for key, found in those.items() if key not in WHOLE]


def score(name: str, truth: Mapping, outcome: Outcome, without_truth: bool = False) -> Score:
    """Judge an outcome; `without_truth` if the hidden effects were taken out of the catalogue."""
    if outcome.refused:
        right = False
    elif truth["group"] == "outside" or (without_truth and truth["effects"]):
        right = not outcome.named and outcome.verdict == "unexplained_remainder"
    else:
        right = same(list(outcome.named)) == same(truth["effects"])
    held = {}
    for effect in truth["effects"]:
        for named in twins(effect) & set(outcome.named):
            held[effect] = compared(truth, effect, named, outcome.named[named])
    error = outcome.inertia / truth["inertia"] - 1.0
    return Score(name, truth, outcome, right, error, _closed(outcome), without_truth, held)


def _closed(outcome: Outcome) -> float | None:
    if outcome.holdout is None:
        return None
    before, after, floor = outcome.holdout
    return 1.0 - (after - floor) / (before - floor) if before > floor else None
