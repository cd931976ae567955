"""Task 11: the run-up through the winding, U = R*Iq + L*dIq/dt + Ke*omega, hot, cold, and cold with inductance."""

import numpy as np
from course import graph, show, torque_constant, value
from methods import RPM

U = np.sqrt(3) * 230
Ke = U / value("no_load_speed")
imax = value("peak_current")
R_hot = (U - Ke * value("corner_speed")) / imax
HOT, COLD = 120, 20
per_kelvin = (1 - value("cold_resistance_share")) / (HOT - COLD)
R_th = (HOT - COLD) / (R_hot * value("continuous_stall_current") ** 2)
capacity = value("thermal_time_constant") / R_th
STEP = 25e-6


def run_up(start, tau):
    """omega, Iq, corner: peak current as long as the voltage drives it, then what is left, late by tau = L/R.

    The winding starts at a temperature - degC - and warms.
    """
    omega, current, corner, T = [0.0], [imax], None, start
    while current[-1] > 0.3 * imax:
        R = R_hot * (1 + per_kelvin * (T - HOT))
        if corner is None and U - Ke * omega[-1] < R * imax:
            corner = (U - R * imax) / Ke
        T += STEP / capacity * (R * current[-1] ** 2 - (T - start) / R_th)
        left = min(imax, (U - Ke * omega[-1]) / R)
        late = left if tau == 0 else current[-1] + STEP / tau * (left - current[-1])
        friction = value("K_fric_w") * omega[-1] + value("K_fric_0")
        omega.append(omega[-1] + STEP / value("J") * (torque_constant(current[-1]) * current[-1] - friction))
        current.append(late)
    return np.array(omega), np.array(current), corner


runs = {
    "hot, quasi-static": run_up(HOT, 0),
    "cold, quasi-static": run_up(COLD, 0),
    "cold, with inductance": run_up(COLD, value("electrical_time_constant")),
}
for name, (_, _, corner) in runs.items():
    show(f"corner, {name}", corner * RPM, "rpm")
curves = [(omega * RPM, torque_constant(current) * current, "-", name) for name, (omega, current, _) in runs.items()]
graph("task11.png", ("torque / (N*m)", *curves), x="speed n / rpm")
