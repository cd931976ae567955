"""What the rig's tolerances leave open, against the equation of motion: all coefficients go with kT."""

import numpy as np
import pytest

from bench.fit.identify import identify
from bench.rig.rig import Rig
from tests.fit.motions import NAMES, RIG, recording


class UncertainTwice(Rig):
    """A rig whose torque constant may be off for two reasons that do not know of each other."""

    def within_tolerance(self):
        for factor in (1.03, 1.04):
            yield self.model_copy(
                update={"motor": self.motor.model_copy(update={"torque_constant": factor * self.motor.torque_constant})}
            )


def test_independent_tolerances_add_in_squares():
    trace, rig = recording(np.random.default_rng(0)), UncertainTwice(**dict(RIG))
    exact, found = identify(trace, RIG, 66.0), identify(trace, rig, 66.0)
    for name in NAMES:
        reach = 0.05 * found[name].value
        assert found[name].value == exact[name].value
        assert found[name].half_width == pytest.approx(np.hypot(exact[name].half_width, reach), rel=5e-3)
        assert found[name].std_error == pytest.approx(np.hypot(exact[name].std_error, reach / 1.959964), rel=5e-3)


def test_a_tolerance_is_common_to_recordings_and_no_average_lessens_it():
    traces, rig = [recording(np.random.default_rng(k)) for k in range(3)], UncertainTwice(**dict(RIG))
    exact, found = identify(traces, RIG, 66.0), identify(traces, rig, 66.0)
    for name in NAMES:
        reach = 0.05 * found[name].value
        assert found[name].half_width == pytest.approx(np.hypot(exact[name].half_width, reach), rel=5e-3)
