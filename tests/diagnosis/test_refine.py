"""One step of the refinement, on simulations that are linear in the model's numbers, so that it is known exactly."""

import numpy as np
import pytest

from bench.arrays import NORMAL95
from bench.diagnosis.add import Numbers, refined, stepped
from bench.diagnosis.model import Extension, HeldOut
from bench.diagnosis.name import Suspects
from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import Probabilities
from bench.diagnosis.recordings import Recordings
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis
from bench.parameter import Parameter
from tests.diagnosis.constructed import COULOMB, INERTIA, RIG, VISCOUS, moved, recorded
from tests.diagnosis.hand_made import term

TRUTH = np.array([INERTIA, VISCOUS, COULOMB])
ERRORS = np.array([1e-6, 1e-5, 1e-3])
TRACE = recorded(moved(3.0), lambda motion: 0.02 * motion.position)
#: What each number does to the simulated velocity, per standard error - rad/s - (n, 3).
EACH = np.random.default_rng(5).normal(size=(len(TRACE), 3))


class Linear:
    """Velocity gaps of a simulator that is linear in J, K_w and K_0 and exact at the truth.

    Args:
        before, after: gaps of held-out motion that it states, without the step and of the model after it - rad/s.
    """

    def __init__(self, before=1.0, after=1.0):
        self.before, self.after = before, after

    def velocities(self, models, recordings):
        if len(models) == 1:
            return [TRACE["velocity"] + self.after]
        found = []
        for stored in models:
            own = stored.model.parameters
            numbers = np.array([own.inertia, own.viscous_friction_coefficient, own.coulomb_friction])
            found.append(TRACE["velocity"] + EACH @ ((numbers - TRUTH) / ERRORS))
        return found

    def of(self, stage, recorded):
        return self.before


@pytest.fixture(scope="module")
def whole():
    """Recordings, held-out motion, model and suspects of a recording whose spring is named."""
    recordings = Recordings.of(TRACE, RIG, None)
    fitted = fit(recordings.rows, Hypothesis((term("torsion_spring"),)))
    stage = Extension(recordings.rows, fitted.hypothesis, {}, RIG)
    suspects = Suspects(fitted, (fitted,), Probabilities({}, 1.0), {}, Policy())
    return recordings, HeldOut.of(recordings, False, True, fitted), stage, suspects


def parameters(values):
    names = ("moment_of_inertia", "viscous_friction_coefficient", "coulomb_friction_torque")
    return {
        name: Parameter(value, "", error, (value - NORMAL95 * error, value + NORMAL95 * error))
        for name, value, error in zip(names, values, ERRORS, strict=True)
    }


@pytest.mark.parametrize("away", [(1.0, -1.5, 0.5), (-0.3, 0.1, 1.9)])
def test_a_step_within_the_intervals_ends_at_the_truth(whole, away):
    _, held_out, stage, _ = whole
    numbers = Numbers((), parameters(TRUTH + np.array(away) * ERRORS))
    found = stepped(numbers.model(stage.model, numbers.values), numbers, held_out.seen, Linear())
    assert found == pytest.approx(TRUTH, rel=1e-9)


def test_a_step_is_bounded_by_the_intervals(whole):
    _, held_out, stage, _ = whole
    numbers = Numbers((), parameters(TRUTH + np.array([0.0, 0.0, 5.0]) * ERRORS))
    found = stepped(numbers.model(stage.model, numbers.values), numbers, held_out.seen, Linear())
    assert found[2] == pytest.approx(TRUTH[2] + (5.0 - NORMAL95) * ERRORS[2], rel=1e-9)


@pytest.mark.parametrize(("after", "kept"), [(0.981, False), (0.979, True), (1.5, False)])
def test_a_step_is_kept_that_takes_two_hundredths_of_the_held_out_gap(whole, monkeypatch, after, kept):
    recordings, held_out, stage, suspects = whole
    model, *_, gap = refined(recordings, stage, suspects, held_out, Linear(1.0, after))
    assert gap == (pytest.approx((1.0, after)) if kept else None)
    assert (model is stage.model) is not kept


@pytest.mark.parametrize(("floors", "kept"), [(3.4, False), (3.6, True)])
def test_a_gap_of_three_and_a_half_noises_is_not_refined(whole, floors, kept):
    """The speed's white noise is 0.03 rad/s."""
    before = floors * 0.03
    *_, gap = refined(*[whole[k] for k in (0, 2, 3, 1)], Linear(before, 0.5 * before))
    assert (gap is not None) is kept


def test_intervals_move_with_their_values():
    numbers = Numbers((), parameters(TRUTH))
    _, moved_to = numbers.named(2.0 * TRUTH)
    for (name, found), value, error in zip(moved_to.items(), TRUTH, ERRORS, strict=True):
        assert found.value == pytest.approx(2.0 * value), name
        assert found.ci95 == pytest.approx((2.0 * value - NORMAL95 * error, 2.0 * value + NORMAL95 * error)), name
