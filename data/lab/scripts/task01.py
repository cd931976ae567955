"""Task 1: the path z = a*y**2 + b*y + c of all flights in the least-squares sense."""

import numpy as np
from course import HERE, graph, show

flight, y, z = np.loadtxt(HERE / "recordings" / "flights.csv", delimiter=",", skiprows=1, unpack=True)

A = np.column_stack([y**2, y, np.ones_like(y)])
theta = np.linalg.lstsq(A, z, rcond=None)[0]
E = np.sum((z - A @ theta) ** 2)

for name, number, unit in zip("abc", theta, ("1/m", "1", "m"), strict=True):
    show(name, number, unit)
show("E", E, "m^2")

along = np.linspace(y.min(), y.max(), 300)
dots = [(y[flight == k], z[flight == k], ".", f"experiment {k:.0f}") for k in np.unique(flight)]
graph("task01.png", ("z / m", *dots, (along, np.polyval(theta, along), "-", "least squares")), x="y / m")
