"""What the integrator's own step leaves, by a quarter of it: far below any noise (`test_order_of_convergence`)."""

import numpy as np
import pytest

from bench.validation.independent.effects import CATALOGUE
from bench.validation.independent.sensors import Sensors
from bench.validation.independent.simulate import LONGEST_STEP, simulate
from tests.effects.axes import Reversals
from tests.independent.axes import PLAIN

#: Where a contact or a limit opens and closes, runs part after it, and neither is the truth more than the other.
SWITCHING = {"backlash", "voltage_limit"}
SECONDS, QUIET = 0.15, Sensors(sample_period=PLAIN.control_period, encoder_resolution=0.0)


@pytest.fixture(scope="module")
def runs():
    rng = np.random.default_rng(5)
    effects = {name: kind.draw(PLAIN, 0.6, rng, SECONDS) for name, kind in CATALOGUE.items() if name not in SWITCHING}
    motion, many = Reversals(SECONDS), len(effects)

    def at(step: float):
        together = [[PLAIN] * many, [motion] * many, [[effect] for effect in effects.values()], [QUIET] * many]
        return [run.trace for run in simulate(*together, longest_step=step)]

    return {name: pair for name, *pair in zip(effects, at(LONGEST_STEP), at(LONGEST_STEP / 4.0), strict=True)}


@pytest.mark.parametrize(
    ("signal", "largest", "allowed"), [("velocity", PLAIN.top_speed, 5e-6), ("current", PLAIN.peak_current, 2e-5)]
)
def test_a_shorter_step_changes_nothing_that_noise_would_not_hide(runs, signal, largest, allowed):
    apart = {name: np.std(own[signal] - short[signal]) / largest for name, (own, short) in runs.items()}
    print({name: f"{share:.1e}" for name, share in apart.items()})  # pytest -s
    assert max(apart.values()) < allowed
