"""What each effect adds to M = J*alpha + K_w*w + K_0*sgn(w), read off the motion and held to its equation."""

import numpy as np
import pytest

from bench.validation.independent.effects import (
    CoggingTorque,
    DirectionDependentFriction,
    FrictionWarmup,
    LoadDependentFriction,
    LoadTorqueEvent,
    PositionDependentFriction,
    PositionDependentInertia,
    QuadraticDrag,
    StribeckFriction,
    TorqueConstantSaturation,
    TorqueOffset,
    TorqueRipple,
    TorsionSpring,
    Unbalance,
)
from bench.validation.independent.plant import Plant
from tests.independent.axes import PLAIN, run
from tests.outside import PositionNotch, Vibration

J, KW, K0, KT = PLAIN.inertia, PLAIN.viscous, PLAIN.coulomb, PLAIN.torque_constant
STEP = 20e-6

#: Effect, and its torque at (time, angle, speed, acceleration, current) as its definition says.
EQUATIONS = [
    (StribeckFriction(0.2, 4.0), lambda t, q, w, a, i: 0.14 * np.exp(-((w / 4.0) ** 2)) * np.sign(w)),
    (
        DirectionDependentFriction(0.04, 0.5),
        lambda t, q, w, a, i: 0.02 + 0.5 * 0.02 / K0 * KW * np.abs(w),
    ),
    (QuadraticDrag(2e-5), lambda t, q, w, a, i: 2e-5 * w * np.abs(w)),
    (LoadDependentFriction(0.2), lambda t, q, w, a, i: 0.2 * np.abs(KT * i) * np.sign(w)),
    (PositionDependentFriction(0.5, 0.7), lambda t, q, w, a, i: K0 * 0.5 * np.sin(q + 0.7) * np.sign(w)),
    (FrictionWarmup(0.8, 0.05, 1.0), lambda t, q, w, a, i: 0.8 * np.exp(-t / 0.05) * (K0 * np.sign(w) + KW * w)),
    (TorqueOffset(0.03), lambda t, q, w, a, i: 0.03 + 0 * w),
    (Unbalance(0.1, 0.5), lambda t, q, w, a, i: 0.1 * np.sin(q + 0.5)),
    (TorsionSpring(0.05), lambda t, q, w, a, i: 0.05 * q),
    (
        PositionDependentInertia(0.15, 2.0, 0.5),
        lambda t, q, w, a, i: J * 0.15 * (np.sin(2 * q + 0.5) * a + np.cos(2 * q + 0.5) * w**2),
    ),
    (LoadTorqueEvent(0.03, 0.06, 0.1), lambda t, q, w, a, i: 0.1 * ((t > 0.03) & (t < 0.06))),
    (CoggingTorque(0.05, 8.0, 0.2), lambda t, q, w, a, i: 0.05 * np.sin(8 * q + 0.2)),
    (TorqueRipple(0.2, 6.0, 0.2), lambda t, q, w, a, i: -KT * i * 0.2 * np.sin(6 * q + 0.2)),
    (TorqueConstantSaturation(0.3), lambda t, q, w, a, i: KT * i * 0.3 * (i / PLAIN.peak_current) ** 2),
    (
        PositionNotch(0.1, 0.4, 0.2),
        lambda t, q, w, a, i: 0.1 * np.exp(-((np.angle(np.exp(1j * (q - 0.4))) / 0.2) ** 2)),
    ),
    (Vibration(0.05, 30.0, 0.3), lambda t, q, w, a, i: 0.05 * np.sin(2 * np.pi * 30 * t + 0.3)),
]


def _push(time):
    return 1.2 * np.sin(2 * np.pi * 12.0 * time)


@pytest.fixture(scope="module")
def motion():
    return run(Plant([PLAIN] * len(EQUATIONS), [[effect] for effect, _ in EQUATIONS]), _push, 0.085, STEP)


@pytest.mark.parametrize("k", range(len(EQUATIONS)), ids=[effect.name for effect, _ in EQUATIONS])
def test_torque_of_the_effect_is_its_equation(motion, k):
    _, equation = EQUATIONS[k]
    q, w = motion["position"][:, k], motion["velocity"][:, k]
    t = motion["time"][:-1] + STEP / 2
    middle, speed = (q[1:] + q[:-1]) / 2, (w[1:] + w[:-1]) / 2
    acceleration = np.diff(w) / STEP
    current = _push(t)
    moves = (np.sign(w[1:]) == np.sign(w[:-1])) & (np.abs(speed) > 0.02)
    edges = np.minimum(np.abs(t - 0.03), np.abs(t - 0.06)) > 2 * STEP
    torque = KT * current - J * acceleration - KW * speed - K0 * np.sign(speed)
    expected = equation(t, middle, speed, acceleration, current)
    use = moves & edges
    assert use.mean() > 0.6
    assert np.abs(expected[use]).max() > 5e-3
    assert np.abs(torque - expected)[use].max() < 1e-3 * np.abs(expected[use]).max()
