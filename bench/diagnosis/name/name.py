"""Name what is missing: in the torque balance by search, elsewhere by what the recording says of drive and sensor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from bench.diagnosis.found import NamedEffect
from bench.diagnosis.name.doubts import Evidence, doubted
from bench.diagnosis.name.policy import Policy
from bench.diagnosis.name.search import Searched, search
from bench.diagnosis.recordings import Recordings
from bench.effects.catalogue import catalogue
from bench.effects.effect import Detected, Effect
from bench.effects.present import Present
from bench.fit.fit import Fit, fit
from bench.fit.load_inertia import load_inertia
from bench.fit.parameter import Parameter
from bench.fit.quantities import uncertain
from bench.fit.shapes import unbiased
from bench.fit.systematic import hint
from bench.statistics import NORMAL95


@dataclass(frozen=True)
class Suspects:
    """What was named.

    Attributes:
        searched: steps of the search; the last one's fit has the effects of the torque balance.
        detected: what the torque balance does not hold.
        withheld: whether something was found whose name was not to be tried.
        policy: that decided.
        excluded: names that were not to be tried.
    """

    searched: Searched
    detected: Mapping[Effect, Detected]
    withheld: bool
    policy: Policy
    excluded: frozenset[str] = frozenset()

    @property
    def beside(self) -> tuple[Present, ...]:
        """Effects that the torque balance does not hold."""
        return tuple(Present.of(effect.name, found.values) for effect, found in self.detected.items())


def name(recordings: Recordings, bare: Fit, excluded: frozenset[str], policy: Policy) -> Suspects:
    """Suspects of a recording.

    Args:
        recordings: laid out.
        bare: the fit without an effect.
        excluded: effects that are not tried.
        policy: that decides.
    """
    effects = [effect for name, effect in catalogue().items() if name not in excluded]
    searched = search(bare, effects, policy)
    searched = doubted(searched, Evidence(bare, recordings.other, excluded, policy), policy.doubts)
    kept = {effect: found for effect, found in recordings.detected.items() if effect.name not in excluded}
    return Suspects(searched, kept, len(kept) < len(recordings.detected), policy, excluded)


def named(
    recordings: Recordings, fitted: Fit, detected: Mapping[Effect, Detected]
) -> tuple[list[NamedEffect], dict[str, Parameter]]:
    """Effects of a fitted balance and those beside it with their quantities, and J, K_w, K_0 beside them."""
    rig, unit = recordings.rig, recordings.unit
    numbers, others = uncertain(fitted), recordings.within_tolerance(fitted)
    hinted, over_noise = hint(fitted, catalogue().values()) or fitted, unbiased(fitted)
    parameters = {
        name: found.widened(*(float(other.theta[k] - fitted.theta[k]) for other in others)).reaching(
            float(hinted.theta[k])
        )
        for k, (name, found) in enumerate(numbers.base(recordings.base_units).items())
    }
    parameters |= load_inertia(parameters, rig)

    def unit_of(effect: Effect, name: str) -> str:
        known = (*effect.quantities, *effect.derived, *(shape.quantity for shape in effect.shapes))
        return rig.axis_kind.unit(next(quantity for quantity in known if quantity.name == name), unit)

    effects = []
    for index, term in enumerate(fitted.terms):
        less = fit(fitted.rows, fitted.hypothesis.without(index))
        evidence = {"residual_without": less.rms, "residual_with": fitted.rms, "noise_floor": fitted.floor}
        reports = [term.effect.report(other.strengths(index), term.shape, other.base) for other in others]
        by_hint = term.effect.report(hinted.strengths(index), term.shape, hinted.base)
        by_noise = term.effect.report(over_noise.strengths(index), over_noise.terms[index].shape, over_noise.base)
        found = {
            key: value.widened(*(report[key] - value.value for report in reports))
            .reaching(by_hint[key])
            .reaching(by_noise[key])
            for key, value in numbers.quantities(index, unit_of).items()
        }
        effects.append(NamedEffect(term.effect, found, term.effect.ambiguous(fitted.scope), evidence))
    for effect, found in detected.items():
        values = {
            key: Parameter(
                value,
                unit_of(effect, key),
                found.errors[key] / NORMAL95,
                (value - found.errors[key], value + found.errors[key]),
            )
            for key, value in found.values.items()
        }
        effects.append(NamedEffect(effect, values, effect.ambiguous(fitted.scope), found.evidence))
    return effects, parameters
