"""Task 6: J as the mean of M/alpha where the axis accelerates hard; J_load beside the theory of the disk."""

import numpy as np
from course import KG_CM2, backward_difference, graph, recording, show, torque, value

t, omega, current, T = recording("JLoadWithoutFriction")
alpha, M = backward_difference(omega, T), torque(current)

alpha_max = np.abs(alpha).max()
hard = np.abs(alpha) >= alpha_max / 4
J = np.mean(M[hard] / alpha[hard])

show("alpha_max", alpha_max, "rad/s^2")
show("J", J * KG_CM2, "kg*cm^2")
show("J_load", (J - value("rotor_inertia")) * KG_CM2, "kg*cm^2")
show("J_load, theory", value("disk_inertia") * KG_CM2, "kg*cm^2")
show("RMS of M - J·α", np.sqrt(np.mean((M - J * alpha)[hard] ** 2)), "N*m")
graph(
    "task06.png",
    ("torque / (N*m)", (t, M, "-", "measured M"), (t, J * alpha, "-", "J*alpha")),
    ("M - J*alpha / (N*m)", (t, M - J * alpha, "-", "")),
)
