"""Task 7: the recording with friction: angle, speed, acceleration and torque on one time axis."""

import numpy as np
from course import backward_difference, graph, recording, show, torque

t, omega, current, T = recording("JLoadAndFriction")
alpha, M = backward_difference(omega, T), torque(current)
phi = np.concatenate([[0], np.cumsum((omega[1:] + omega[:-1]) / 2) * T])

show("largest speed", np.abs(omega).max(), "rad/s")
show("largest acceleration", np.abs(alpha).max(), "rad/s^2")
show("largest torque", np.abs(M).max(), "N*m")
graph(
    "task07.png",
    ("angle / rad", (t, phi, "-", "")),
    ("speed / (rad/s)", (t, omega, "-", "")),
    ("acceleration / (rad/s^2)", (t, alpha, "-", "")),
    ("torque / (N*m)", (t, M, "-", "")),
)
