"""Steady speeds of a joint recorded as position and torque, without a speed."""

import numpy as np

VISCOUS, COULOMB = 8.0, 1.4  # N*m*s/rad, N*m


def write(folder):
    rng = np.random.default_rng(4)
    time = np.arange(400) * 0.015
    for number, speed in enumerate(np.geomspace(0.02, 0.2, 9)):
        for sign, name in ((1.0, ""), (-1.0, "n")):
            angle = np.rad2deg(sign * speed * time + 2e-5 * rng.normal(size=time.size))
            torque = sign * (VISCOUS * speed + COULOMB) + 0.05 * rng.normal(size=time.size)
            rows = np.column_stack([time, angle, torque])
            head = "time [s],q2 [deg],tau2 [Nm]"
            np.savetxt(folder / f"ci_{name}{number}.csv", rows, "%.5f", ",", header=head, comments="")
    mapped = 'time = "time [s]"\nposition = "q2 [deg]"\ntorque = "tau2 [Nm]"\n'
    (folder / "rig.toml").write_text(f'name = "joint"\nkind = "rotary"\n[trace.columns]\n{mapped}')
