"""A serial log of labels and values, with a line of the firmware's among them."""

import numpy as np

from tests.faults.drive import drive

RIG = """name = "wheel"
kind = "rotary"

[motor]
torque_constant = "0.1 N*m/A"

[trace.columns]
velocity = "spd_act_lft [rpm]"
current = "iq_lft [A]"
"""


def write(folder):
    time, _, velocity, current = drive(2e-4, 3e-4, 0.02, 0.1)
    lines = [
        f"timestamp:{1642047 + round(1e3 * t)}  batt_vlt:4081  spd_act_lft[rpm]:{30 / np.pi * w:.2f}  iq_lft[A]:{i:.4f}"
        for t, w, i in zip(time, velocity, current, strict=True)
    ]
    lines.insert(700, "-- temperature warning --")
    (folder / "log.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
