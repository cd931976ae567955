"""Filtered acceleration in step with the other signals, and the samples that are fast enough (tasks 8 and 9)."""

import numpy as np
from course import signals

t, omega, alpha, M, alpha_filt, sync = signals("JLoadAndFriction")
t_sync, omega_sync, M_sync = t[sync], omega[sync], M[sync]
fast = np.abs(omega_sync) >= 20
