"""Task 3: the torque constant kT = M/I from stall and from peak."""

from course import show, value

show("kT from stall", value("continuous_stall_torque") / value("continuous_stall_current"), "N*m/A")
show("kT from peak", value("peak_torque") / value("peak_current"), "N*m/A")
