"""A data frame (pandas, polars, Arrow) or a dictionary of arrays instead of a file."""

import numpy as np
import pyarrow as pa

import bench

INERTIA, VISCOUS, COULOMB, TORQUE_CONSTANT = 1.5e-3, 8e-4, 0.06, 0.8  # kg*m**2, N*m*s/rad, N*m, N*m/A

rig = bench.Rig.of(
    {
        "name": "from a data frame",
        "kind": "rotary",
        "motor": {"torque_constant": f"{TORQUE_CONSTANT} N*m/A", "rotor_inertia": "2 kg*cm**2"},
    }
)

time = np.arange(6000) * 1e-3  # s
speed = 40.0 * np.sin(2.5 * time) + 25.0 * np.sin(11.0 * time)  # rad/s
acceleration = 100.0 * np.cos(2.5 * time) + 275.0 * np.cos(11.0 * time)  # rad/s**2
torque = INERTIA * acceleration + VISCOUS * speed + COULOMB * np.sign(speed)  # N*m
noise = np.random.default_rng(0).normal(size=(2, time.size))
frame = pa.table(
    {
        "time [s]": time,
        "velocity [deg/s]": np.degrees(speed + 0.02 * noise[0]),
        "current [mA]": 1e3 * (torque / TORQUE_CONSTANT + 5e-3 * noise[1]),
    }
)

trace = bench.Trace.from_arrays(frame)
estimate = bench.identify(trace, rig)
for name, true in (("moment_of_inertia", INERTIA), ("coulomb_friction_torque", COULOMB)):
    print(f"{name}: {estimate[name].value:.5g}, true {true:.5g} {estimate[name].unit}")
