"""A torque that is known to act is taken off the balance through the same filter, with the noise it brings."""

import numpy as np
import pytest

from bench.effects.catalogue import catalogue
from bench.fit.fit import fit
from bench.fit.hypothesis import Hypothesis, Term, lay_out
from bench.fit.rows import Rows
from bench.rig.rig import Rig
from bench.trace.trace import Trace, less_known, with_known
from tests.sines import sines

RIG = Rig.of({"name": "axis", "kind": "rotary"})
TIME = 1e-3 * np.arange(8000)
J, K_W, K_0 = 2e-3, 1e-3, 0.05


def recording(noise=0.0, seed=0, torque_noise=2e-3):
    """An axis beside which r + dp/dt acts, far more than its own torque; the momentum p is known with noise."""
    rng = np.random.default_rng(seed)
    speed, acceleration, _ = sines(TIME, [(20.0, 0.7, 0.0), (20.0, 2.3, 0.0), (20.0, 6.1, 0.0)])
    r, p, rate = 2.0 * np.sin(3.0 * TIME), 0.4 * np.cos(11.0 * TIME), -4.4 * np.sin(11.0 * TIME)
    torque = J * acceleration + K_W * speed + K_0 * np.sign(speed) + r + rate
    signals = {
        "velocity": speed + 2e-3 * rng.standard_normal(TIME.size),
        "torque": torque + torque_noise * rng.standard_normal(TIME.size),
    }
    trace = Trace(TIME, signals, {"velocity": "rad/s", "torque": "N*m"}, "closed form")
    return with_known(trace, r, p + noise * rng.standard_normal(TIME.size), "N*m")


def test_the_rest_is_inertia_and_friction():
    found = fit(Rows.of(recording(), RIG), Hypothesis())
    np.testing.assert_allclose(found.theta[:3], [J, K_W, K_0], rtol=5e-3)


def test_it_leaves_noise_alone():
    """Loud enough that the jumps of dry friction, which are as fast, do not pass for noise."""
    assert fit(Rows.of(recording(torque_noise=5e-2), RIG), Hypothesis()).chi == pytest.approx(1.0, abs=0.15)


def test_its_noise_counts_in_the_floor():
    quiet, loud = (fit(Rows.of(recording(noise), RIG, cutoff=60.0), Hypothesis()) for noise in (0.0, 5e-4))
    assert loud.rms > 3.0 * quiet.rms
    assert loud.chi == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("name", ["current_filter_lag", "velocity_filter_lag", "current_loop_lag"])
def test_a_lag_that_vanishes_leaves_it_as_it_is(name):
    rows = Rows.of(recording(), RIG)
    lagging = Hypothesis((Term(catalogue()[name], (1e-12,)),))
    np.testing.assert_allclose(lay_out(rows, lagging).effort, lay_out(rows, Hypothesis()).effort, atol=1e-9)


def test_sample_by_sample_it_is_the_same_to_the_order_of_the_difference():
    trace = recording()
    rest = less_known(trace, trace["torque"])
    plain = trace.without("known_torque").without("known_momentum")
    assert less_known(plain, plain["torque"]) is plain["torque"]
    w = trace["velocity"]
    own = J * np.gradient(w, 1e-3) + K_W * w + K_0 * np.sign(w)
    assert np.sqrt(np.mean((rest - own)[5:-5] ** 2)) < 8e-3
