"""Task 9: J, viscous and Coulomb friction from A*theta = b with A = [alpha_filt, omega, sgn(omega)], b = M."""

import numpy as np
from course import KG_CM2, graph, recording, show, value
from fast_samples import M, M_sync, alpha_filt, fast, omega, omega_sync, sync, t

A = np.column_stack([alpha_filt, omega_sync, np.sign(omega_sync)])[fast]
theta = np.linalg.lstsq(A, M_sync[fast], rcond=None)[0]
E = np.sum((M_sync[fast] - A @ theta) ** 2)
J, K_w, K_0 = theta

show("J", J * KG_CM2, "kg*cm^2")
show("K_fric_w", K_w, "N*m*s/rad")
show("K_fric_0", K_0, "N*m")
show("E", E, "(N*m)^2")
show("J_load", (J - value("rotor_inertia")) * KG_CM2, "kg*cm^2")

every = np.gradient(omega, recording("JLoadAndFriction")[3])  # at the ends, where the filter has too few samples
every[sync] = alpha_filt
M_est = J * every + K_w * omega + K_0 * np.sign(omega)
show("RMS of M - M_est, all samples", np.sqrt(np.mean((M - M_est) ** 2)), "N*m")
graph(
    "task09.png",
    ("torque / (N*m)", (t, M, "-", "measured M"), (t, M_est, "-", "M_est, all samples")),
    ("M - M_est / (N*m)", (t, M - M_est, "-", "")),
)
