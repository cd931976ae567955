"""Task 9: J, viscous and Coulomb friction from A*theta = b with A = [alpha_filt, omega, sgn(omega)], b = M."""

import numpy as np
from course import graph, show, signals, value
from methods import KG_CM2, fast_samples

t, omega, _, M, alpha_filt, sync = signals("JLoadAndFriction")
alpha = np.gradient(omega, t)  # at the ends, where the filter has too few samples
alpha[sync] = alpha_filt
fast = fast_samples(omega)

A = np.column_stack([alpha, omega, np.sign(omega)])
theta = np.linalg.lstsq(A[fast], M[fast], rcond=None)[0]
J, K_w, K_0 = theta
M_est = A @ theta

show("J", J * KG_CM2, "kg*cm^2")
show("K_fric_w", K_w, "N*m*s/rad")
show("K_fric_0", K_0, "N*m")
show("E", np.sum((M - M_est)[fast] ** 2), "(N*m)^2")
show("J_load", (J - value("rotor_inertia")) * KG_CM2, "kg*cm^2")
show("RMS of M - M_est, all samples", np.sqrt(np.mean((M - M_est) ** 2)), "N*m")
graph(
    "task09.png",
    ("torque / (N*m)", (t, M, "-", "measured M"), (t, M_est, "-", "M_est, all samples")),
    ("M - M_est / (N*m)", (t, M - M_est, "-", "")),
)
