"""MuJoCo with each effect against the independent integrator, under the same drive along the same motion.

Printed: RMS difference of velocity, and of the torque that the drive reports, beside what the effect changes in them.
"""

import numpy as np
import pytest

from bench.plant.run import run
from bench.plant.sensing import reported_states
from tests.effects.axes import AXIS, plant
from tests.effects.conftest import CASES, MOTION

#: Share of what an effect changes that the two may differ by; contact begins and ends between MuJoCo's steps.
SHARE = {("backlash",): 0.04}


#: What the bare axis may differ by: MuJoCo ends the step of a reversal with friction against the new direction.
FLOOR = {"velocity": 0.002, "measured_velocity": 0.002, "measured_position": 5e-5}


@pytest.mark.parametrize("case", CASES, ids=" + ".join)
def test_same_motion(case, truths):
    bench = plant(*case)
    states = run(bench, MOTION.references())
    seen = reported_states(bench.model, states)
    bare, true = truths[()], truths[case]
    found = {"velocity": states.velocity, "measured_velocity": seen.velocity, "measured_position": seen.position}
    for name, values in found.items():
        off, changed = rms(values - true[name]), rms(true[name] - bare[name])
        print(f"{' + '.join(case)}: {name} {off:.1e} of {changed:.3g}")
        assert off < FLOOR[name] + SHARE.get(case, 0.01) * changed
    off = rms((seen.torque - AXIS.torque_constant * true["current"])[:-1])
    changed = AXIS.torque_constant * rms(true["current"] - bare["current"])
    print(f"{' + '.join(case)}: torque {off:.1e} of {changed:.3g} N*m")
    # the independent current is that of a moment, the bench's the mean of a step
    assert off < 0.0005 + (0.05 if "voltage_limit" in case else SHARE.get(case, 0.01)) * changed


def rms(values):
    return float(np.sqrt(np.mean(values**2)))
