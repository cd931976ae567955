"""The verdict, with every objection to a model that claims to explain everything; warnings beside it.

Each objection is a function that gives its reason in one line, empty if there is none.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from bench.arrays import rms
from bench.axis_kind import COULOMB, OFFSET, VISCOUS, AxisKind
from bench.diagnosis.add import Added
from bench.diagnosis.name import NamedEffect, Suspects
from bench.diagnosis.policy import ERRS_TWICE
from bench.diagnosis.recordings import Recordings
from bench.fit.fit import Fit
from bench.fit.rows import Rows
from bench.gate.signals import clipped
from bench.names import words
from bench.parameter import Parameter
from bench.rig.rig import Rig
from bench.trace.trace import Trace


@dataclass(frozen=True)
class Gap:
    """RMS gap before and after the effects were added, on both recordings, against the noise floor.

    Attributes:
        unit: of all numbers.
        noise_floor: expected RMS from sensor noise alone.
        identify, holdout: (before, after) over all rows; None if not available.
        judged: share of the rows that the verdict is based on, and the gap on them; None if it is all rows.
    """

    unit: str
    noise_floor: float
    identify: tuple[float, float] | None
    holdout: tuple[float, float] | None
    judged: tuple[float, float] | None = None


@dataclass(frozen=True)
class Shown:
    """What a diagnosis shows, as far as the verdict depends on it.

    Attributes:
        recordings, suspects, added: as found.
        torque, velocity: gaps of the bare axis and of the model.
    """

    recordings: Recordings
    suspects: Suspects
    added: Added
    torque: Gap
    velocity: Gap

    @property
    def whole(self) -> Fit:
        """The torque balance with all effects."""
        return self.added.extension.whole.fitted

    @property
    def effects(self) -> list[NamedEffect]:
        """The named effects."""
        return self.added.refined.effects

    @property
    def friction(self) -> dict[str, tuple[Parameter, float]]:
        """Viscous and Coulomb friction, each with its RMS torque at unit strength."""
        kind, whole, parameters = self.recordings.rig.axis_kind, self.whole, self.added.refined.parameters
        return {
            kind.parameter(term): (parameters[kind.parameter(term)], rms(whole.columns[:, whole.owners == term]))
            for term in (VISCOUS, COULOMB)
        }


def remains(shown: Shown) -> str:
    """The torque residual is clearly above noise: by what multiple of the floor."""
    if not shown.suspects.policy.remains(shown.whole):
        return ""
    return f"what is left is {shown.whole.chi:.3g} times the noise"


def refused(shown: Shown) -> str:
    """A parameter is not determined beside the effects: the first, of which others follow, and why."""
    reasons = (f"{words(name)} is not determined: {reason}" for name, reason in shown.added.refused.items())
    return next(reasons, "")


def unfinished(shown: Shown) -> str:
    """The search ended at a limit, or found an effect that was excluded."""
    stopped = shown.suspects.searched.stopped
    return stopped or ("an effect that was not to be tried" if shown.suspects.withheld else "")


def moves_worse(shown: Shown) -> str:
    """The model moves worse than the bare axis, by more than noise: in the recording that shows it first."""
    if not shown.effects:
        return ""
    gap, added = shown.velocity, shown.added
    for recorded, pair in zip(added.recorded, (gap.identify, gap.holdout), strict=False):
        if pair is None:
            continue
        allowed = math.hypot(pair[0], gap.noise_floor)
        if pair[1] > allowed * (1.0 if added.gaps.in_phase(added.extension.whole, recorded) else math.sqrt(ERRS_TWICE)):
            name, before, after = recorded.name, *pair
            return f"simulated motion of the {name} is worse with it: {before:.3g} -> {after:.3g} {gap.unit}"
    return ""


def undetermined(shown: Shown) -> str:
    """A quantity is undetermined: its interval is wider than its value.

    One that is minor, as a share between dry and viscous friction, does not count. A phase is wide if it may be
    anywhere in its turn, an instant if it may be anywhere in the recording. Friction as wide counts where the torque
    that it leaves open is more than noise.
    """
    if not shown.effects:
        return ""
    time = shown.recordings.trace.time
    for named in shown.effects:
        for quantity in (each for each in named.effect.quantities if not each.minor):
            found = named.parameters.get(quantity.name)
            itself = np.pi if quantity.angle else float(time[-1] - time[0]) if quantity.instant else None
            if found is not None and found.half_width > (abs(found.value) if itself is None else itself):
                return f"{named.name}: {_with_interval(quantity.name, found)} is not determined"
    for name, (found, torque) in shown.friction.items():
        if found.half_width > abs(found.value) and found.half_width * torque > shown.torque.noise_floor:
            return f"{_with_interval(name, found)} is not determined"
    return ""


def negative_friction(shown: Shown) -> str:
    """Friction is negative by more than noise, so it includes something else."""
    for name, (found, torque) in shown.friction.items():
        if found.value < 0.0 and (found.ci95[1] < 0.0 or -found.value * torque > shown.torque.noise_floor):
            return f"{_with_interval(name, found)} is negative"
    return ""


def holdout_apart(shown: Shown) -> str:
    """The model does not hold on the holdout: how far that is off."""
    gap = shown.torque
    if gap.holdout is None or gap.identify is None:
        return ""
    least = max(gap.identify[1], gap.noise_floor)
    if gap.holdout[1] <= shown.suspects.policy.holdout_gap * least:
        return ""
    return f"the holdout stands apart: {gap.holdout[1]:.3g} {gap.unit} are left there, {least:.3g} here"


#: In the order in which they are listed.
OBJECTIONS: tuple[Callable[[Shown], str], ...] = (
    remains,
    refused,
    unfinished,
    moves_worse,
    undetermined,
    negative_friction,
    holdout_apart,
)


def verdict(shown: Shown) -> tuple[str, list[str]]:
    """The verdict, and the objections that it rests on."""
    against = [objected for objection in OBJECTIONS if (objected := objection(shown))]
    if against:
        return "unexplained_remainder", against
    return ("explained" if shown.effects else "nothing_missing"), []


def _with_interval(name: str, found: Parameter) -> str:
    return f"{name.replace('_', ' ')} ({found.value:.3g} ± {found.half_width:.2g} {found.unit})"


def suspicions(trace: Trace, rig: Rig, parameters: Mapping[str, Parameter]) -> list[str]:
    """Warnings: less inertia than the rotor alone has, or a signal that stands at the end of its range."""
    inertia, rotor = parameters.get("moment_of_inertia"), rig.motor.rotor_inertia
    if inertia is None or rotor is None or inertia.unit != "kg*m**2" or inertia.ci95[1] >= rotor:
        return clipped(trace, rig)
    return [
        f"the moment of inertia, {inertia.value:.3g} kg*m**2, is less than the rotor's alone, {rotor:.3g} kg*m**2: "
        "check the units of current and speed and the torque constant",
        *clipped(trace, rig),
    ]


def left_open(rows: Rows, kind: AxisKind) -> list[str]:
    """A warning of what motion in one direction does not determine."""
    if not rows.scope.one_way:
        return []
    offset, friction = kind.parameter(OFFSET), kind.parameter(COULOMB)
    forward = float(np.mean(rows.values(lambda s: s.sign))) > 0.0
    return [
        f"the axis moves {'forward' if forward else 'backward'} only: {friction} holds any "
        f"{offset} too, and no effect on friction was sought; record both directions for that"
    ]


def impacts(fitted: Fit, unit: str) -> list[str]:
    """A warning if rows that depend on the instants of impacts were excluded from the verdict."""
    share = 1.0 - float(fitted.determined.mean())
    if share == 0.0:
        return []
    return [
        f"{100.0 * share:.0f} % of the rows follow impacts so closely that their torque hangs on instants which the "
        f"recording does not tell: the verdict is by the others, on which {fitted.rms:.3g} {unit} are left; the torque "
        "gap counts all"
    ]


def out_of_phase(added: Added) -> list[str]:
    """A warning of recordings along which simulated waves, or impacts, lose the phase of the measured motion."""
    lost = [each.name for each in added.recorded if not added.gaps.in_phase(added.extension.whole, each)]
    return [
        f"the simulated position leaves the {name}'s by more than waves or impacts allow: they are judged by their "
        "torque at the measured position, and by the velocity gap where its squares double"
        for name in lost
    ]
