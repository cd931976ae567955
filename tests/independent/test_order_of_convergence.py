"""The splitting around the exact friction is of second order, whatever acts (contacts aside: `test_backlash`)."""

import numpy as np
import pytest

from bench.validation.independent.effects import (
    CoggingTorque,
    ElasticCoupling,
    LoadDependentFriction,
    PositionDependentInertia,
    PreslidingFriction,
    QuadraticDrag,
    StribeckFriction,
    TorsionSpring,
    Unbalance,
)
from bench.validation.independent.plant import Plant
from tests.independent.axes import PLAIN, run

SETS = {
    "spring and drag": [TorsionSpring(0.5), QuadraticDrag(2e-5)],
    "unbalance and cogging": [Unbalance(0.2, 0.3), CoggingTorque(0.1, 12.0, 1.0)],
    "inertia": [PositionDependentInertia(0.2, 2.0, 0.5)],
    "Stribeck and load": [StribeckFriction(0.15, 3.0), LoadDependentFriction(0.1)],
    "elastic": [ElasticCoupling(40.0, 0.01)],
    "presliding": [PreslidingFriction(4.0, 0.003)],
}


@pytest.mark.parametrize("name", SETS)
def test_halving_the_step_quarters_the_error(name, capsys):
    def end(step):
        # a smooth push that starts, stops and turns the axis several times
        states = run(Plant([PLAIN], [SETS[name]]), lambda t: 0.6 * np.sin(60.0 * t) + 0.2, 0.128, step)
        return np.array([states["position"][-1, 0], states["velocity"][-1, 0]])

    exact = end(16e-6)
    errors = [np.abs(end(step) - exact) for step in (512e-6, 256e-6, 128e-6, 64e-6)]
    order = np.log2(errors[0] / errors[-1]).mean() / 3.0
    with capsys.disabled():
        print(f"\n{name}: order {order:.2f}, error at 64 us {errors[-1][0]:.1e} rad {errors[-1][1]:.1e} rad/s")
    assert order > 1.6
    assert errors[-1][1] < 2e-3
