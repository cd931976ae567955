"""Whether a model explains everything: each criterion that it fails, with its figures."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.arrays import rms
from bench.axis_kind import COULOMB, VISCOUS
from bench.diagnosis.add import Added
from bench.diagnosis.policy import ERRS_TWICE, Reason
from bench.diagnosis.probability import Probabilities
from bench.parameter import Parameter


@dataclass(frozen=True)
class Gap:
    """RMS gap before and after the effects were added, on both recordings, against the noise floor.

    Attributes:
        unit: of all numbers.
        noise_floor: expected RMS from sensor noise.
        identify, holdout: (before, after) over all rows; None if not available.
        judged: share of the rows that the verdict is based on, and the gap on them; None if it is all rows.
        limit: RMS up to which a model matches the recording.
        bandwidth: of the cascade that tracked the recordings - rad/s; nan of a torque gap.
        closed_loop: velocity gap under the rig's drive without and with what shows only there; None without that.
        refined: of held-out motion before and after values were refined by simulation; None if not kept.
    """

    unit: str
    noise_floor: float
    identify: tuple[float, float] | None
    holdout: tuple[float, float] | None = None
    judged: tuple[float, float] | None = None
    limit: float = math.inf
    bandwidth: float = math.nan
    closed_loop: tuple[float, float] | None = None
    refined: tuple[float, float] | None = None

    @property
    def final(self) -> tuple[float, float] | None:
        """Before and after on the holdout where there is one, else on the recording."""
        return self.holdout or self.identify

    @property
    def times_noise(self) -> float:
        """The final gap over the noise floor; nan if not available."""
        return math.nan if self.final is None else self.final[1] / max(self.noise_floor, 1e-300)

    @property
    def within(self) -> bool:
        """Whether the model matches, as far as a gap is available."""
        return self.final is None or self.final[1] <= self.limit


def verdict(added: Added, likely: Probabilities, torque: Gap, velocity: Gap) -> tuple[str, tuple[Reason, ...]]:
    """The verdict on the effects that were added, and the objections that it is based on, the gravest first."""
    whole, suspects = added.extension.fitted, added.suspects
    against = list[Reason]()
    if suspects.policy.remains(whole):
        against.append(Reason("residual", {"times_noise": whole.chi}))
    if whole.depends is not None:
        against.append(Reason("dependence", {"reason": str(whole.depends)}))
    plain = not against
    if added.refused:  # the first, of which the others follow
        name, reason = next(iter(added.refused.items()))
        against.append(Reason("refused", {"parameter": name, "reason": reason}))
    if suspects.stopped:
        against.append(Reason("stopped", {"reason": suspects.stopped}))
    elif len(suspects.detected) < len(added.recordings.detected):  # of a name that was not to be tried
        against.append(Reason("withheld"))
    if added.effects:
        against += [*moves_worse(added, velocity), *undetermined(added, torque)]
    elif not velocity.within and velocity.final is not None:
        figures = {"after": velocity.final[1], "unit": velocity.unit, "times_noise": velocity.times_noise}
        against.append(Reason("moves_otherwise", figures))
    against += [*negative_friction(added, torque), *holdout_differs(added, torque)]
    if plain and not added.effects:
        against += likelier(likely)
    if against:
        return "unexplained_remainder", tuple(against)
    return ("explained" if added.effects else "nothing_missing"), ()


def likelier(likely: Probabilities) -> Iterator[Reason]:
    """Something is more likely than no missing effect, and is not certain enough to be named."""
    others = {" and ".join(sorted(names)): probability for names, probability in likely.sets.items() if names}
    name, probability = max({**others, "an unknown effect": likely.none}.items(), key=lambda one: one[1])
    if probability >= likely.nothing:
        yield Reason("likelier", {"name": name, "probability": probability, "nothing": likely.nothing})


def moves_worse(added: Added, velocity: Gap) -> Iterator[Reason]:
    """The model moves worse than the bare axis, by more than noise: in the recording that shows it first."""
    for recorded, pair in zip(added.recorded, (velocity.identify, velocity.holdout), strict=False):
        if pair is None:
            continue
        before, after = pair
        twice = 1.0 if added.gaps.in_phase(added.extension, recorded) else math.sqrt(ERRS_TWICE)
        if after > math.hypot(before, velocity.noise_floor) * twice:
            figures = {"recording": recorded.name, "before": before, "after": after, "unit": velocity.unit}
            yield Reason("moves_worse", figures)
            return


def undetermined(added: Added, torque: Gap) -> Iterator[Reason]:
    """A quantity is undetermined: its interval is wider than its value; the first.

    One that is minor, as a share between dry and viscous friction, does not count. A phase is wide if it may be
    anywhere in its turn, an instant if it may be anywhere in the recording. Friction as wide counts where the torque
    that it does not determine is more than noise.
    """
    time = added.recordings.trace.time
    for one in added.effects:
        for quantity in (each for each in one.effect.quantities if not each.minor):
            found = one.parameters.get(quantity.name)
            itself = np.pi if quantity.angle else float(time[-1] - time[0]) if quantity.instant else None
            if found is not None and found.half_width > (abs(found.value) if itself is None else itself):
                yield Reason("undetermined", {"effect": one.name, "quantity": quantity.name, "found": found})
                return
    for friction, (found, unit_torque) in frictions(added).items():
        if found.half_width > abs(found.value) and found.half_width * unit_torque > torque.noise_floor:
            yield Reason("undetermined", {"quantity": friction, "found": found})
            return


def negative_friction(added: Added, torque: Gap) -> Iterator[Reason]:
    """Friction is negative by more than noise, so it includes something else."""
    for friction, (found, unit_torque) in frictions(added).items():
        if found.value < 0.0 and (found.ci95[1] < 0.0 or -found.value * unit_torque > torque.noise_floor):
            yield Reason("negative", {"quantity": friction, "found": found})
            return


def frictions(added: Added) -> dict[str, tuple[Parameter, float]]:
    """Viscous and Coulomb friction, each with its RMS torque at unit strength."""
    kind, whole = added.recordings.rig.axis_kind, added.extension.fitted
    return {
        (name := kind.parameter(term)): (added.parameters[name], rms(whole.columns[:, whole.owners == term]))
        for term in (VISCOUS, COULOMB)
    }


def holdout_differs(added: Added, torque: Gap) -> Iterator[Reason]:
    """The residual of the holdout is larger than that of the recording."""
    if torque.holdout is None or torque.identify is None:
        return
    least, after = max(torque.identify[1], torque.noise_floor), torque.holdout[1]
    if after > added.suspects.policy.holdout_gap * least:
        yield Reason("holdout", {"holdout": after, "recording": least, "unit": torque.unit})
