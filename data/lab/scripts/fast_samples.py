"""Filtered acceleration in step with the other signals, and the samples that are fast enough (tasks 8 and 9)."""

import numpy as np
from course import backward_difference, recording, torque

WIDTH = 4  # differences in a mean
DELAY = WIDTH // 2  # the mean is (WIDTH - 1)/2 samples late, the backward difference half a sample

t, omega, current, T = recording("JLoadAndFriction")
alpha, M = backward_difference(omega, T), torque(current)
alpha_filt = np.convolve(alpha[1:], np.ones(WIDTH) / WIDTH, mode="valid")
sync = slice(DELAY, DELAY + alpha_filt.size)
t_sync, omega_sync, M_sync = t[sync], omega[sync], M[sync]
fast = np.abs(omega_sync) >= 20
