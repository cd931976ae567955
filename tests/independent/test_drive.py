"""The drive against a cascade written for one axis."""

from dataclasses import replace

import numpy as np

from bench.validation.independent.simulate import Drive
from tests.independent.axes import PLAIN


def test_it_is_the_contract_s_cascade_with_its_limit_and_held_integrator():
    rng = np.random.default_rng(1)
    axes = [PLAIN, replace(PLAIN, integral_gain=40.0, position_gain=50.0, peak_current=1.5, torque_constant=0.3)]
    drive = Drive(axes, 250e-6)
    integrals, limited = [0.0, 0.0], 0
    for _ in range(400):
        q_ref, w_ref, a_ref, q, w = rng.normal(size=(5, 2)) * np.array([[0.1], [3.0], [100.0], [0.1], [3.0]])
        seen = drive.current((q_ref, w_ref, a_ref), q, w)
        for k, axis in enumerate(axes):
            e = w_ref[k] + axis.position_gain * (q_ref[k] - q[k]) - w[k]
            torque = axis.velocity_gain * e + axis.integral_gain * integrals[k] + axis.inertia_feedforward * a_ref[k]
            current = torque / axis.torque_constant
            if abs(current) < axis.peak_current:
                integrals[k] += 250e-6 * e
            else:
                current, limited = np.copysign(axis.peak_current, current), limited + 1
            assert abs(seen[k] - current) < 1e-12
    assert 20 < limited < 780
