"""Task 7: the recording with friction: speed, acceleration, alpha_filt and torque on one time axis."""

from course import four_graphs

four_graphs("task07", "JLoadAndFriction")
