"""Task 2: the backward difference of sin(t) against cos(t), t = 0 : 0.001 : 2*pi."""

import numpy as np
from course import graph, show
from methods import num_derivative

T = 0.001
t = np.arange(0, 2 * np.pi, T)
derivative = num_derivative(np.sin(t), T)
error = derivative - np.cos(t)

show("largest error of the backward difference", np.abs(error[1:]).max(), "1/s")
graph(
    "task02.png",
    ("derivative / (1/s)", (t, np.cos(t), "-", "cos(t)"), (t, derivative, "--", "backward difference")),
    ("error / (1/s)", (t[1:], error[1:], "-", "")),
)
