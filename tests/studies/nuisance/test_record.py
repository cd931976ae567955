"""Exact recordings are exact enough: what the integrator's step leaves is far below the noise that is added."""

import numpy as np
import pytest

from bench.validation.independent.effects import CATALOGUE
from bench.validation.independent.references import random_motion
from bench.validation.independent.simulate import simulate
from tests.independent.axes import PLAIN
from tests.studies.nuisance.record import IDEAL, LONGEST_STEP
from tests.studies.nuisance.signals import CURRENT_NOISE, SPEED_NOISE

#: Where a contact or a limit opens and closes, runs part after it, and neither is the truth more than the other.
SWITCHING = {"backlash", "voltage_limit"}
#: Share of the noise.
ALLOWED = 0.05

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def runs():
    rng = np.random.default_rng(5)
    effects = [kind.draw(PLAIN, 0.6, rng, 0.3) for name, kind in CATALOGUE.items() if name not in SWITCHING]
    motion, many = random_motion(PLAIN, rng, 0.3), len(effects)

    def at(step: float):
        together = [[PLAIN] * many, [motion] * many, [[effect] for effect in effects], [IDEAL] * many]
        return simulate(*together, longest_step=step)

    return at(LONGEST_STEP), at(LONGEST_STEP / 4.0)


@pytest.mark.parametrize(
    ("signal", "noise"),
    [("velocity", SPEED_NOISE * PLAIN.top_speed), ("current", CURRENT_NOISE * PLAIN.peak_current)],
)
def test_a_shorter_step_changes_nothing_that_the_noise_would_not_hide(runs, signal, noise):
    apart = [np.std(coarse.trace[signal] - short.trace[signal]) for coarse, short in zip(*runs, strict=True)]
    assert max(apart) < ALLOWED * noise
