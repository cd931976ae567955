"""A motor whose position comes from Hall sensors, 90 steps a turn, without a speed signal."""

import numpy as np

INERTIA, VISCOUS, COULOMB, CONSTANT = 8e-3, 3e-3, 0.25, 0.5


def write(folder):
    rng, time = np.random.default_rng(4), 2e-3 * np.arange(5000)
    omega, amplitude, phase = np.array([[2.1, 5.3, 11.7], [80.0, 30.0, 8.0], [0.3, 1.1, 2.0]])[:, :, None]
    speed = np.sum(amplitude * np.sin(omega * time + phase), axis=0)
    acceleration = np.sum(amplitude * omega * np.cos(omega * time + phase), axis=0)
    position = np.sum(-amplitude / omega * np.cos(omega * time + phase), axis=0)
    torque = INERTIA * acceleration + VISCOUS * speed + COULOMB * np.sign(speed)
    current = torque / CONSTANT + 0.05 * rng.normal(size=time.size)
    step = 2.0 * np.pi / 90.0
    table = np.column_stack([time, current, step * np.floor(position / step)])
    np.savetxt(folder / "log.csv", table, "%.8g", ",", header="time [s],current [A],position [rad]", comments="")
    (folder / "rig.toml").write_text('name = "hub"\nkind = "rotary"\n[motor]\ntorque_constant = "0.5 N*m/A"\n')
