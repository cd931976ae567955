"""The balance of a joint with known gains against motions of closed form, and how a joint breaks loose."""

import numpy as np
import pytest

from bench.errors import UndeterminedError
from bench.rig.rig import Rig
from bench.servos.breakaway import _impulse, _standing, static_friction
from bench.servos.commanded import Gains, balance
from bench.trace.trace import Trace, with_known
from tests.sines import sines

KP, KD, RATE = 30.0, 0.5, 500.0
J, VISCOUS, COULOMB, BIAS, DELAY = 0.02, 0.1, 0.2, 0.03, 0.0071
RIG = Rig.of({"name": "joint", "kind": "rotary"}, "test")
#: Size - rad -, frequency - Hz - and phase - rad - of the waves of the motion.
WAVES = ((0.5, 0.4, 0.0), (0.2, 1.1, 1.0), (0.08, 2.3, 2.0))


def log(noise, seconds=20.0):
    """A log whose goal makes a joint without links move by the waves."""
    time = np.arange(round(seconds * RATE)) / RATE
    q, w, alpha = sines(time + DELAY + 0.5 / RATE, WAVES)  # a held goal acts half a period later
    torque = J * alpha + (VISCOUS + KD) * w + COULOMB * np.sign(w)
    goal = torque / KP + q - BIAS
    measured = sines(time, WAVES)[0] + noise * np.random.default_rng(3).standard_normal(time.size)
    units = {"time": "s", "position": "rad", "position_reference": "rad"}
    trace = Trace.from_arrays({"time": time, "position": measured, "position_reference": goal}, units)
    zero = np.zeros(time.size)
    return with_known(trace, zero, zero, "N*m")


@pytest.mark.parametrize(("noise", "share"), [(1e-6, 2e-3), (2e-4, 1e-2)])
def test_a_motion_of_closed_form_gives_the_parameters_back(noise, share):
    of = balance(log(noise), RIG, Gains(KP, KD))
    found = of.found.parameters(0.005)
    truth = {
        "moment_of_inertia": J,
        "armature": J - 0.005,
        "viscous_friction_coefficient": VISCOUS,
        "coulomb_friction_torque": COULOMB,
        "joint_bias": BIAS,
    }
    for name, value in truth.items():
        assert found[name].value == pytest.approx(value, rel=share), name
    assert found["dead_time"].value == pytest.approx(DELAY, abs=5e-5)
    with pytest.raises(UndeterminedError, match="breaks loose 0 times"):  # as it never rests
        static_friction(of)


def test_intervals_grow_with_the_noise():
    few, many = (balance(log(noise), RIG, Gains(KP, KD)).found.errors for noise in (5e-5, 5e-4))
    assert np.all(many > 3.0 * few)


@pytest.mark.parametrize("damping", [0.2, 2.0 * np.sqrt(0.05 * 8.0), 5.0])
def test_the_impulse_response_solves_its_equation(damping):
    time = np.linspace(0.0, 0.5, 20001)
    x = _impulse(0.05, damping, 8.0, time)
    speed = np.gradient(x, time, edge_order=2)
    assert x[0] == 0.0
    assert speed[0] == pytest.approx(1.0 / 0.05, rel=1e-3)
    rest = 0.05 * np.gradient(speed, time) + damping * speed + 8.0 * x
    assert np.abs(rest[2:-2]).max() < 1e-3


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_joint_that_creeps_is_not_at_rest_whichever_way(way):
    """At rest for 0.2 s, then 0.16 of the largest noise a sample on, and at rest there."""
    noise, rng = 1e-4, np.random.default_rng(0)
    path = np.concatenate([np.zeros(100), 0.16 * noise * np.arange(100), np.full(100, 16.0 * noise)])
    found = [*_standing(way * (path + 0.1 * noise * rng.normal(size=path.size)), 20, noise)]
    assert found[0][0] < 20 and found[-1][1] > 280
    resting = np.zeros(path.size, dtype=bool)
    for first, last in found:
        resting[first : last + 1] = True
    assert not resting[130:170].any()
    assert resting[:90].mean() > 0.5 and resting[-90:].mean() > 0.5


@pytest.mark.parametrize("held", [8, 64, 512])
def test_noise_alone_is_rest_however_long_a_rest_lasts(held):
    """The mean of a half errs by s/sqrt(n): what two halves may differ by falls with the length, and no faster."""
    noise = np.random.default_rng(1).uniform(-np.sqrt(3.0), np.sqrt(3.0), 6000)
    found = [*_standing(1e-4 * noise, held, 1e-4)]
    windows = sum(last - first - held + 2 for first, last in found)
    assert windows > 0.95 * (noise.size - held)
