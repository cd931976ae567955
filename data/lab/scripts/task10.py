"""Task 10: torque over speed of the fastest run-up, against the datasheet's peak curve at 230 V."""

import numpy as np
from course import graph, show, signals, value
from methods import RPM, SPEEDS, kept_samples, torque_at_speeds

_, omega, _, M, *_ = signals("MaxAcc")
top = value("peak_torque")
kept = kept_samples(M, top)
omega, M = omega[kept], M[kept]

show("peak torque", M.max(), "N*m")
corner, no_load = value("corner_speed"), value("no_load_speed")
for rpm, measured in zip(SPEEDS, torque_at_speeds(omega, M), strict=True):
    if np.isfinite(measured):
        show(f"M_max at {rpm:.0f} rpm", measured, "N*m")
    show(f"M_max at {rpm:.0f} rpm, datasheet", np.interp(rpm / RPM, [0, corner, no_load], [top, top, 0]), "N*m")
sheet = (np.array([0, corner, no_load]) * RPM, [top, top, 0], "--", "datasheet, 230 V")
graph("task10.png", ("torque / (N*m)", (omega * RPM, M, ".", "measured"), sheet), x="speed n / rpm")
