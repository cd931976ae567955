"""The motion to record, and how well it determines the axis: every profile inside the rig's limits, simulated and
fitted.

What a recording determines is known before it is made: the inverse of the information matrix of its regression is the
covariance of what will be found. Each profile is simulated on the axis as the rig file describes it, its sensors' noise
included, and fitted by the engine that will fit the recording; its errors are those to expect.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.diagnosis.next_experiment import LONG_ENOUGH
from bench.diagnosis.search import candidates
from bench.effects.effect import Columns, Effect
from bench.effects.present import Present
from bench.errors import InputError, UndeterminedError
from bench.fit.fit import fit, shaped
from bench.fit.hypothesis import Hypothesis
from bench.fit.quantities import uncertain
from bench.fit.rows import Rows
from bench.names import words
from bench.parameter import Parameter
from bench.plant.drive import References
from bench.plant.plant import Plant
from bench.plant.profiles import PROFILES, MotionLimits, full_torque, plan
from bench.plant.simulate import simulate
from bench.rig.rig import Rig
from bench.trace.trace import Trace

#: Profiles to choose from: not the one that demands more than the motor has.
PLANNED = tuple(name for name, profile in PROFILES.items() if profile is not full_torque)


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """A motion at the drive's ticks, repeated until it is long enough, and quantities with the errors to expect of it.

    `reason` is why it determines nothing; empty if it does.
    """

    profile: str
    motion: References
    expected: Mapping[str, Parameter]
    reason: str = ""

    @property
    def worst(self) -> float:
        """Largest relative standard error; infinite if it determines nothing."""
        shares = [found.std_error / abs(found.value) for found in self.expected.values() if found.value]
        return max((share for share in shares if np.isfinite(share)), default=np.inf) if not self.reason else np.inf


def motions(rig: Rig, wanted: Present | None = None, profile: str | None = None) -> list[PlannedMotion]:
    """Every profile that the rig can follow, or one, the most accurate first.

    Args:
        rig: with `[drive]` and `[simulation]`, which is what is expected of axis and sensors.
        wanted: an effect that is to be determined, as strong as it may be; None: inertia and friction are.

    Raises:
        InputError: the rig lacks what a simulation needs, no such profile, or no torque balance determines the effect.
        UndeterminedError: no profile determines what is wanted.
    """
    effects = [] if wanted is None else [wanted]
    plant = Plant.from_rig(rig, effects)
    limits = MotionLimits.from_rig(rig, plant.axis.parameters, plant.cascade.control_period)
    effect = None if wanted is None else wanted.effect
    if effect is not None and not (isinstance(effect, Columns) or effect.shapes):
        raise InputError(f"--for {effect.name}", "is none of the torque balance", "allowed: an effect that has columns")
    found = []
    for name in PLANNED if profile is None else [profile]:
        once = plan(name, limits)
        motion = once.repeated(math.ceil(LONG_ENOUGH / float(once.time[-1])))
        trace = simulate(rig, name, references=motion, effects=effects).trace
        found.append(_planned(name, motion, trace, rig, effect))
    found.sort(key=lambda each: each.worst)
    if not np.isfinite(found[0].worst):
        what = "inertia and friction" if effect is None else words(effect.name)
        raise UndeterminedError(
            what, f"no profile determines it: {found[0].reason}", "nothing yet: state more of the rig"
        )
    return found


def _planned(name: str, motion: References, trace: Trace, rig: Rig, effect: Effect | None) -> PlannedMotion:
    """What a simulated recording determines of the effect, or of inertia and friction."""
    kind = rig.axis_kind
    units = kind.base_parameters()
    try:
        rows = Rows.of(trace, rig)
    except UndeterminedError as error:
        return PlannedMotion(name, motion, {}, error.reason)
    bare = fit(rows, Hypothesis())
    if effect is None:
        return PlannedMotion(name, motion, uncertain(bare).base(units))
    tried = candidates(bare, [effect])
    if not tried:
        return PlannedMotion(name, motion, {}, "the motion cannot show it")
    fitted = shaped(bare, Hypothesis().plus(tried[0][0]), 0)
    known = (*effect.quantities, *effect.derived, *(shape.quantity for shape in effect.shapes))
    own = {quantity.name: kind.unit(quantity) for quantity in reversed(known)}
    return PlannedMotion(name, motion, uncertain(fitted).quantities(0, lambda _, key: own[key]))
