"""Refine a model by the error of its simulation, from the regression's estimate and within its intervals.

One Gauss-Newton step is a bounded linear least-squares problem over the simulated velocities' derivatives, which run
side by side: within the intervals of a regression the simulation is as good as linear. Regression first, simulation
second, as in `bench.identify.refine`, where the figures stand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.optimize
from numpy.typing import NDArray

from bench.diagnose.added import present_of
from bench.diagnose.found import NamedEffect
from bench.diagnose.held import Recorded, VelocityGaps
from bench.effects.present import Present
from bench.errors import InputError
from bench.identify.estimate import Parameter
from bench.plant.model_file import StoredModel

Array = NDArray[np.float64]

#: Step of a derivative, in standard errors; bounds of the move, in standard errors: the interval of 95 %.
STEP, REACH = 0.5, 1.96
#: Whole numbers, and times that a simulation sees only in samples.
HELD = frozenset({"harmonic", "start", "end"})
BASE = ("inertia", "viscous_friction_coefficient", "coulomb_friction")


@dataclass(frozen=True)
class Numbers:
    """Values of a model that a regression left uncertain.

    Attributes:
        effects, parameters: as named: quantities with intervals; of the parameters the first three.
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
        """The free numbers of what was named."""
        free = [((-1, name), parameters[name]) for name in list(parameters)[:3]]
        for index, effect in enumerate(effects):
            known = dict(present_of(effect.name, _values(effect)).values)
            free += [((index, key), p) for key, p in effect.parameters.items() if key in known and key not in HELD]
        free = [(place, p) for place, p in free if np.isfinite(p.std_error) and p.std_error > 0.0]
        values, errors = np.array([p.value for _, p in free]), np.array([p.std_error for _, p in free])
        return cls(tuple(effects), parameters, tuple(place for place, _ in free), values, errors)

    def model(self, stored: StoredModel, values: Array) -> StoredModel:
        """The model with other values; InputError where it cannot have them."""
        moved = self.named(values)
        base = [max(p.value, 0.0) for p in list(moved[1].values())[:3]]
        parameters = replace(stored.model.parameters, **dict(zip(BASE, base, strict=True)))
        present: tuple[Present, ...] = tuple(present_of(effect.name, _values(effect)) for effect in moved[0])
        return replace(stored, model=replace(stored.model, parameters=parameters, effects=present))

    def named(self, values: Array) -> tuple[list[NamedEffect], dict[str, Parameter]]:
        """Effects and parameters with other values; intervals keep their width, as both read the same noise."""
        parameters = dict(self.parameters)
        effects = [dict(effect.parameters) for effect in self.effects]
        for (index, key), value in zip(self.places, values.tolist(), strict=True):
            table = parameters if index < 0 else effects[index]
            before = table[key]
            low, high = (bound - before.value + value for bound in before.ci95)
            table[key] = replace(before, value=value, ci95=(low, high))
        found = [replace(e, parameters=table) for e, table in zip(self.effects, effects, strict=True)]
        return found, parameters


def polished(stored: StoredModel, numbers: Numbers, recorded: Recorded, gaps: VelocityGaps) -> Array | None:
    """Values (p,) whose simulation comes closest to a recording; None where a simulation on the way is not to be had.

    Args:
        stored: the model as the regression has it.
        numbers: that may move.
        recorded: the recording.
        gaps: that simulates.
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
    found = scipy.optimize.lsq_linear(jacobian, -differences[0], bounds=(-REACH, REACH))
    return numbers.values + numbers.errors * found.x


def _values(effect: NamedEffect) -> dict[str, float]:
    return {key: parameter.value for key, parameter in effect.parameters.items()}
