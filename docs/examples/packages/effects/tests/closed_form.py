"""A motion in closed form, the torque of a plain axis along it, and the diagnosis of a recording.

The truth of the tests thus does not depend on the bench.
"""

import numpy as np

import bench

J, K_W, K_0, K_T = 1.5e-3, 8e-4, 0.06, 0.8
RIG = bench.Rig.of(
    {
        "name": "closed form",
        "kind": "rotary",
        "motor": {"torque_constant": "0.8 N*m/A", "peak_current": "8 A", "rotor_inertia": "5e-4 kg*m**2"},
    }
)
TIME = 1e-3 * np.arange(6000)
SPEED, FREQUENCY = np.array([[40.0, 30.0, 15.0, 6.0], [0.4, 1.3, 3.7, 11.0]])[:, :, None]
#: Names under which the catalogue may come to have the same physics as an example.
TWINS = frozenset({"torque_constant_drift", "current_gain_asymmetry"})


def motion(passed=lambda s: 1.0):
    """Speed - rad/s - and acceleration - rad/s**2 - (n,), sines from rest; settled behind a transfer function of s."""
    s = 2j * np.pi * FREQUENCY
    waves = SPEED * passed(s) * np.exp(s * TIME)
    return waves.imag.sum(axis=0), (s * waves).imag.sum(axis=0)


def torque():
    """Motor torque of the plain axis - N*m - (n,)."""
    speed, acceleration = motion()
    return J * acceleration + K_W * speed + K_0 * np.sign(speed)


def diagnosed(reported):
    """Diagnosis of a recording of the motion with a torque as the drive reports it - N*m - (n,)."""
    rng = np.random.default_rng(1)
    speed = motion()[0] + 0.03 * rng.normal(size=TIME.size)
    current = (reported + 5e-3 * rng.normal(size=TIME.size)) / K_T
    trace = bench.Trace.from_arrays({"time [s]": TIME, "velocity [rad/s]": speed, "current [A]": current})
    return bench.diagnose(trace, RIG, excluded=TWINS)


def assert_found(diagnosis, name, **true):
    """This effect alone is found, each true value lies within its interval, and nothing remains unexplained."""
    assert [effect.name for effect in diagnosis.effects] == [name]
    assert diagnosis.verdict == "explained"
    for quantity, value in true.items():
        low, high = diagnosis.effects[0].parameters[quantity].ci95
        assert low < value < high
        assert high - low < 0.2 * abs(value)
