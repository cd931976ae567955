"""Refine a model by its simulation error, and keep the result only if it reduces the gap of held-out motion.

One Gauss-Newton step is a bounded linear least-squares problem over the derivatives of the simulated velocity, which
are simulated in parallel: within the intervals of a regression the simulation is nearly linear. Regression first,
simulation second, as in `bench.fit.refine`, which has the figures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.arrays import NORMAL95, Array
from bench.diagnosis.model import Stage, present_of
from bench.diagnosis.name import NamedEffect, Suspects, named
from bench.diagnosis.recordings import Recordings
from bench.diagnosis.tracking import HeldOut, Recorded, VelocityGaps
from bench.effects.present import Present
from bench.errors import InputError
from bench.fit.parameter import Parameter
from bench.plant.measured_motion import measured_velocity
from bench.plant.model_file import StoredModel
from bench.trace.noise import white_noise

#: Largest velocity gap of a complete model on the shared cases, over the white noise of the recorded speed
#: (docs/diagnose.md). Changes below it are insignificant, and refining such a model cannot help.
NULL = 3.5
#: Least relative reduction of the gap of held-out motion by a refined model; less is chance.
WON = 0.02
#: Step of a derivative, in standard errors; moves are bounded by the interval of 95 %.
STEP = 0.5
BASE = ("inertia", "viscous_friction_coefficient", "coulomb_friction")


@dataclass(frozen=True)
class Refined:
    """A model with its effects and parameters.

    Attributes:
        model: None if MuJoCo cannot simulate it.
        effects, parameters: with the values of the model.
        gap: velocity gap of held-out motion before and after refinement - rad/s (m/s); None if not refined.
    """

    model: StoredModel | None
    effects: list[NamedEffect]
    parameters: dict[str, Parameter]
    gap: tuple[float, float] | None


def refined(recordings: Recordings, stage: Stage, suspects: Suspects, held_out: HeldOut, gaps: VelocityGaps) -> Refined:
    """The quantities of a model with their intervals, refined if that is possible and helps.

    It is possible if effects were added, no unexplained remainder would bias the values, and the gap exceeds that of a
    complete model.
    """
    effects, parameters = named(recordings, stage.fitted, stage.detected(suspects))
    plain = Refined(stage.model, effects, parameters, None)
    if stage.model is None or not effects or suspects.policy.remains(stage.fitted):
        return plain
    before = gaps.of(stage, held_out.recorded)
    if not before > NULL * white_noise(measured_velocity(recordings.trace)):
        return plain
    numbers = Numbers.of(effects, parameters)
    found = refined_model(stage.model, numbers, held_out, gaps)
    if found is None or not found[2] < (1.0 - WON) * before:
        return plain
    model, values, after = found
    return Refined(model, *numbers.named(values), gap=(before, after))


def refined_model(
    stored: StoredModel, numbers: Numbers, held_out: HeldOut, gaps: VelocityGaps
) -> tuple[StoredModel, Array, float] | None:
    """The model refined on the motion that is not held out; None if that fails.

    Returns:
        The model, its values (p,), and its velocity gap in the motion held out - rad/s (m/s).
    """
    values = stepped(stored, numbers, held_out.seen, gaps)
    if values is None:
        return None
    try:
        model = numbers.model(stored, values)
    except InputError:
        return None
    (velocity,) = gaps.velocities([model], [held_out.recorded])
    return model, values, held_out.recorded.gap(velocity)


@dataclass(frozen=True)
class Numbers:
    """The free values of a model.

    Attributes:
        effects, parameters: as named, with intervals; of the parameters the first three.
        places: (effect's index, quantity) of each free one, (-1, name) of J, K_w and K_0.
        values, errors: (p,) and their standard errors.
    """

    effects: tuple[NamedEffect, ...]
    parameters: Mapping[str, Parameter]
    places: tuple[tuple[int, str], ...]
    values: Array
    errors: Array

    @classmethod
    def of(cls, effects: Sequence[NamedEffect], parameters: Mapping[str, Parameter]) -> Numbers:
        """The free values of named effects and parameters."""
        free = [((-1, name), parameters[name]) for name in list(parameters)[:3]]
        for index, effect in enumerate(effects):
            fixed = {slot.quantity.name for slot in effect.effect.shapes if slot.whole or slot.quantity.instant}
            known = dict(present_of(effect.effect, effect.values).values)
            free += [((index, key), p) for key, p in effect.parameters.items() if key in known and key not in fixed]
        free = [(place, p) for place, p in free if np.isfinite(p.std_error) and p.std_error > 0.0]
        values, errors = np.array([p.value for _, p in free]), np.array([p.std_error for _, p in free])
        return cls(tuple(effects), parameters, tuple(place for place, _ in free), values, errors)

    def model(self, stored: StoredModel, values: Array) -> StoredModel:
        """The model with other values; InputError if they are not allowed."""
        moved = self.named(values)
        base = [max(p.value, 0.0) for p in list(moved[1].values())[:3]]
        if not base[0]:
            raise InputError(stored.name, "found no inertia", "allowed: above zero")
        parameters = replace(stored.model.parameters, **dict(zip(BASE, base, strict=True)))
        present: tuple[Present, ...] = tuple(present_of(effect.effect, effect.values) for effect in moved[0])
        return replace(stored, model=replace(stored.model, parameters=parameters, effects=present))

    def named(self, values: Array) -> tuple[list[NamedEffect], dict[str, Parameter]]:
        """Effects and parameters with other values; intervals keep their width, as the noise is the same."""
        parameters = dict(self.parameters)
        effects = [dict(effect.parameters) for effect in self.effects]
        for (index, key), value in zip(self.places, values.tolist(), strict=True):
            table = parameters if index < 0 else effects[index]
            before = table[key]
            low, high = (bound - before.value + value for bound in before.ci95)
            table[key] = replace(before, value=value, ci95=(low, high))
        found = [replace(e, parameters=table) for e, table in zip(self.effects, effects, strict=True)]
        return found, parameters


def stepped(stored: StoredModel, numbers: Numbers, recorded: Recorded, gaps: VelocityGaps) -> Array | None:
    """Values (p,) with the least simulation error on a recording; None if a simulation fails.

    Args:
        stored: the model as the regression has it.
        numbers: the free values.
        recorded: the recording.
        gaps: simulates it.
    """
    moved = numbers.values + np.diag(STEP * numbers.errors)
    try:
        models = [stored, *(numbers.model(stored, row) for row in moved)]
    except InputError:
        return None
    simulated = gaps.velocities(models, [recorded] * len(models))
    differences = [recorded.difference(velocity) for velocity in simulated if velocity is not None]
    if len(differences) < len(models):
        return None
    jacobian = np.stack([other - differences[0] for other in differences[1:]], axis=1) / STEP
    from scipy.optimize import lsq_linear  # 0.2 s, which only a named effect has to pay

    found = lsq_linear(jacobian, -differences[0], bounds=(-NORMAL95, NORMAL95))
    return numbers.values + numbers.errors * found.x
