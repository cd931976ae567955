"""A servo of 12 bit at 200 Hz, in closed form: noise of its acceleration hides what a lower cut-off shows."""

import numpy as np
import pytest

import bench
from tests.export.two_links import waves

TRUE = {"moment_of_inertia": 0.03, "viscous_friction_coefficient": 0.05, "coulomb_friction_torque": 0.06}
STEP = 2.0 * np.pi / 2**12


def recorded(seed: int, cogging: float) -> dict[str, np.ndarray]:
    """Half a minute - s, rad, N*m -; the cogging torque is below a third of the noise at the highest cut-off."""
    rng = np.random.default_rng(seed)
    time = np.arange(6000) / 200.0
    angle, speed, acceleration = waves(
        time, rng.uniform(0.1, 0.35, 4), rng.uniform(0.1, 1.5, 4), rng.uniform(0, 6.3, 4)
    )
    inertia, viscous, coulomb = TRUE.values()
    torque = inertia * acceleration + viscous * speed + coulomb * np.sign(speed) + cogging * np.sin(12.0 * angle)
    position = STEP * np.round((angle + 1e-4 * rng.standard_normal(time.size)) / STEP)
    return {"time": time, "position": position, "torque": torque + 0.004 * rng.standard_normal(time.size)}


@pytest.mark.parametrize("seed", range(2))
def test_cogging_that_noise_hides_at_the_highest_cutoff_is_named(seed):
    found = bench.diagnose(recorded(seed, 0.024))
    assert found.names == ["cogging_torque"]
    assert found.effects[0].parameters["amplitude"].value == pytest.approx(0.024, rel=0.05)


def test_nothing_is_named_without_it_and_inertia_is_as_sure_as_its_interval_says():
    off = []
    for seed in range(106, 110):
        found = bench.diagnose(recorded(seed, 0.0))
        assert found.verdict == "nothing_missing"
        low, high = found.parameters["moment_of_inertia"].ci95
        off.append((found.parameters["moment_of_inertia"].value - TRUE["moment_of_inertia"]) / (0.5 * (high - low)))
    assert np.sqrt(np.mean(np.square(off))) < 0.7  # 0.51 where intervals of 95 % are right
