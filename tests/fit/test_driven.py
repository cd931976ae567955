"""A shift of the recorded signal against the motion moves what the signal makes, and not what the motion takes."""

import numpy as np
import pytest

from bench.fit.hypothesis import BASE, lay_out, plain
from bench.fit.rows import Rows
from bench.rig.rig import Rig
from bench.trace.trace import Trace

TIME = 1e-3 * np.arange(8000)
SPEED = 20.0 * np.sin(2.0 * np.pi * 0.7 * TIME) + 8.0 * np.sin(2.0 * np.pi * 1.9 * TIME)
ANGLE = np.cumsum(SPEED) * 1e-3
MOTOR = {"torque_constant": "0.5 N*m/A", "resistance": "2 ohm", "back_emf_constant": "0.4 V*s/rad"}
#: A known weight: M = m*g*r*sin(q).
LOAD = {"eccentric_mass": "0.3 kg", "eccentric_radius": "0.1 m"}


@pytest.mark.parametrize("signal", ["voltage", "current"])
def test_the_column_of_the_shift_is_the_rate_of_the_signal_alone(signal):
    values = 3.0 * np.cos(2.0 * np.pi * 1.1 * TIME)
    rig = Rig.of({"name": "axis", "kind": "rotary", "motor": MOTOR, "load": LOAD})
    units = {"time": "s", "velocity": "rad/s", "position": "rad", "voltage": "V", "current": "A"}
    signals = {"time": TIME, "velocity": SPEED, "position": ANGLE, signal: values}
    trace = Trace.from_arrays(signals, {name: units[name] for name in signals})
    rows = Rows.of(trace, rig)
    column = lay_out(rows, plain(rows)).columns[:, BASE.index("misalignment")]
    gain = 0.5 / 2.0 if signal == "voltage" else 0.5
    rate = rows.table(lambda s: [[(np.interp(s.time, TIME, values), 1)]])[:, 0]
    np.testing.assert_allclose(column, -gain * rate, atol=1e-9 * np.abs(rate).max())
