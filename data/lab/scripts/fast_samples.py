"""Filtered acceleration in step with the other signals, and the samples that are fast enough (tasks 8 and 9)."""

import numpy as np
from course import backward_difference, filtered, recording, torque

t, omega, current, T = recording("JLoadAndFriction")
alpha, M = backward_difference(omega, T), torque(current)
alpha_filt, sync = filtered(alpha)
t_sync, omega_sync, M_sync = t[sync], omega[sync], M[sync]
fast = np.abs(omega_sync) >= 20
