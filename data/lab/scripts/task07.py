"""Task 7: the recording with friction: speed, acceleration, alpha_filt and torque on one time axis."""

import numpy as np
from course import backward_difference, filtered, graph, recording, show, torque

t, omega, current, T = recording("JLoadAndFriction")
alpha, M = backward_difference(omega, T), torque(current)
alpha_filt, sync = filtered(alpha)

show("largest speed", np.abs(omega).max(), "rad/s")
show("largest acceleration", np.abs(alpha).max(), "rad/s^2")
show("largest torque", np.abs(M).max(), "N*m")
graph(
    "task07.png",
    ("speed / (rad/s)", (t, omega, "-", "")),
    ("acceleration / (rad/s^2)", (t, alpha, "-", "")),
    ("alpha_filt / (rad/s^2)", (t[sync], alpha_filt, "-", "")),
    ("torque / (N*m)", (t, M, "-", "")),
)
