"""The shape of one effect - a Stribeck speed, a lag, a pitch - searched for the least residual, the others held."""

from __future__ import annotations

import numpy as np
import scipy.optimize

from bench.diagnose.candidates import EVENT
from bench.diagnose.fit import Fit, fit
from bench.diagnose.grids import is_pitch, spacing
from bench.diagnose.hypothesis import (
    BACKLASH,
    CURRENT_LAG,
    ECCENTRICITY,
    ELASTIC,
    TRANSFORMS,
    VELOCITY_LAG,
    Hypothesis,
    Named,
)
from bench.diagnose.outside import NOTCH, physics_of
from bench.diagnose.workbench import Workbench


def shaped(bench: Workbench, hypothesis: Hypothesis, index: int) -> Fit:
    """Search one effect's shape for the least residual, the others held."""
    effect = hypothesis.effects[index]
    free = free_shapes(effect, bench)
    if not free:
        return fit(bench, hypothesis)
    start, held = np.array(effect.shape), bench
    if effect.name == ECCENTRICITY and BACKLASH in hypothesis.names:
        held = bench.held
        fit(held, hypothesis)
    pitch = is_pitch_of(effect, bench)
    scale = spacing(bench) if pitch else _scale(effect)

    def misfit(offset: np.ndarray) -> float:
        shape = start.copy()
        shape[free] = _moved(effect, start[free], offset * scale, pitch)
        found = fit(held, hypothesis.reshaped(index, tuple(shape.tolist())))
        return float(np.log(np.sum(found.residual**2)))

    if len(free) == 1:
        best = scipy.optimize.minimize_scalar(
            lambda x: misfit(np.array([x])), bounds=(-1.0, 1.0), method="bounded", options={"xatol": 4e-3}
        )
        offset = np.array([best.x])
    else:
        best = scipy.optimize.minimize(
            misfit,
            np.zeros(len(free)),
            method="Nelder-Mead",
            options={"initial_simplex": _simplex(len(free)), "xatol": 3e-3, "fatol": 1e-4, "maxfev": 120},
        )
        offset = np.asarray(best.x)
    shape = start.copy()
    shape[free] = _moved(effect, start[free], offset * scale, pitch)
    return fit(bench, hypothesis.reshaped(index, tuple(shape.tolist())))


def _simplex(size: int) -> np.ndarray:
    return np.vstack([np.zeros(size), 0.5 * np.eye(size)])


def free_shapes(effect: Named, bench: Workbench) -> list[int]:
    """Indices of the shape quantities that vary continuously."""
    if effect.name == BACKLASH:
        return []
    if effect.name in TRANSFORMS or effect.name == EVENT:
        return list(range(len(effect.shape)))
    physics = physics_of(effect.name)
    return [index for index, shape in enumerate(physics.shapes) if not shape.whole or is_pitch(bench, shape)]


def is_pitch_of(effect: Named, bench: Workbench) -> bool:
    """Whether an effect repeats by a pitch along a linear axis."""
    known = effect.name not in TRANSFORMS and effect.name != EVENT
    return known and any(is_pitch(bench, shape) for shape in physics_of(effect.name).shapes)


def _scale(effect: Named) -> float:
    """How far a search goes at first: as factor e**scale of positive quantities, as distance of the others."""
    if effect.name == EVENT:
        return 0.05
    if effect.name == ECCENTRICITY:
        return 0.3 * max(float(np.linalg.norm(effect.shape)), 1e-4)
    return {ELASTIC: 0.35, CURRENT_LAG: 1.0, VELOCITY_LAG: 1.0}.get(effect.name, 0.9)


def _moved(effect: Named, start: np.ndarray, offset: np.ndarray, pitch: bool) -> np.ndarray:
    if pitch or effect.name in (EVENT, ECCENTRICITY):
        return start + offset
    if effect.name == NOTCH:  # an angle and a width
        return np.array([start[0] + offset[0], start[1] * np.exp(offset[1])])
    return start * np.exp(offset)
