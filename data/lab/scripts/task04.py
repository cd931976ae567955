"""Task 4: kT(Iq) = a*Iq**2 + b*Iq + c from three conditions."""

import numpy as np
from course import graph, show, torque_constant, value

i0, imax = value("continuous_stall_current"), value("peak_current")
kt = torque_constant(np.array([0, i0, imax]))
a = (kt[2] - kt[1]) / (imax**2 - i0**2)  # b = 0: two points of the parabola give a

show("a", a, "N*m/A^3")
show("b", 0.0, "N*m/A^2")
show("c", kt[0], "N*m/A")
current = np.linspace(0, imax, 400)
points = ([i0, imax], [value("continuous_stall_torque") / i0, value("peak_torque") / imax], "o", "datasheet")
graph("task04.png", ("kT / (N*m/A)", (current, torque_constant(current), "-", "kT(Iq)"), points), x="current Iq / A")
