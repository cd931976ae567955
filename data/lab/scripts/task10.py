"""Task 10: torque over speed of the fastest run-up, against the datasheet's peak curve at 230 V."""

import numpy as np
from course import RPM, graph, recording, show, torque, value

t, omega, current, T = recording("MaxAcc")
M = torque(current)
top = value("peak_torque")
start = np.argmax(M / top > 3.0 / 3.5)
kept = (M >= 0.2) & (np.arange(M.size) >= start)

show("peak torque", M[kept].max(), "N*m")
up = slice(None, np.argmax(omega[kept]) + 1)
corner, no_load = value("corner_speed"), value("no_load_speed")
for rpm in (0, 1000, 2000, 2100, 3000, 4000, 5000):
    near = np.abs(omega[kept][up] - rpm / RPM) <= 5
    near &= omega[kept][up] < 0.97 * omega[kept].max()  # beyond, the drive's speed control takes the torque back
    if near.any():
        show(f"M_max at {rpm} rpm", np.median(M[kept][up][near]), "N*m")
    sheet = np.interp(rpm / RPM, [0, corner, no_load], [value("peak_torque")] * 2 + [0])
    show(f"M_max at {rpm} rpm, datasheet", sheet, "N*m")
curve = (np.array([0, corner, no_load]) * RPM, [value("peak_torque")] * 2 + [0], "--", "datasheet, 230 V")
graph("task10.png", ("torque / (N*m)", (omega[kept] * RPM, M[kept], ".", "measured"), curve), x="speed n / rpm")
