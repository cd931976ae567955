"""Task 5: the recording without friction: speed, acceleration, alpha_filt and torque on one time axis."""

from course import four_graphs

four_graphs("task05", "JLoadWithoutFriction")
