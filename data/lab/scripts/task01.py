"""Task 1: the path z = a*y**2 + b*y + c of all flights in the least-squares sense."""

import numpy as np
from course import graph, show, table
from methods import parabola

flight, y, z = table("flights")
theta, E = parabola(y, z)

for name, number, unit in zip("abc", theta, ("1/m", "1", "m"), strict=True):
    show(name, number, unit)
show("E", E, "m^2")

along = np.linspace(y.min(), y.max(), 300)
dots = [(y[flight == k], z[flight == k], ".", f"experiment {k:.0f}") for k in np.unique(flight)]
graph("task01.png", ("z / m", *dots, (along, np.polyval(theta, along), "-", "least squares")), x="y / m")
