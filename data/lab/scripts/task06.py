"""Task 6: J as the mean of M/alpha where the axis accelerates hard; J_load beside the theory of the disk."""

import numpy as np
from course import graph, show, signals, value
from methods import KG_CM2, mean_inertia

t, _, alpha, M, *_ = signals("JLoadWithoutFriction")
J, alpha_max, hard = mean_inertia(alpha, M)

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
