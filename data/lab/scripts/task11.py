"""Task 11: the run-up through the winding, U = R*Iq + L*dIq/dt + Ke*omega, hot, cold, and cold with inductance."""

import numpy as np
from course import RPM, graph, show, torque, value

U = np.sqrt(3) * 230
Ke = U / value("no_load_speed")
imax = value("peak_current")
R_hot = (U - Ke * value("corner_speed")) / imax
R_cold = value("cold_resistance_share") * R_hot
STEP = 25e-6


def run_up(R, tau):
    """omega, Iq: peak current as long as the voltage drives it; then it follows what is left, late by tau = L/R."""
    omega, current = [0.0], [imax]
    while current[-1] > 0.3 * imax:
        left = min(imax, (U - Ke * omega[-1]) / R)
        late = left if tau == 0 else current[-1] + STEP / tau * (left - current[-1])
        friction = value("K_fric_w") * omega[-1] + value("K_fric_0")
        omega.append(omega[-1] + STEP / value("J") * (float(torque(current[-1])) - friction))
        current.append(late)
    return np.array(omega), np.array(current)


runs = {
    "hot, quasi-static": run_up(R_hot, 0),
    "cold, quasi-static": run_up(R_cold, 0),
    "cold, with inductance": run_up(R_cold, value("electrical_time_constant")),
}
for name, (omega, current) in runs.items():
    show(f"corner, {name}", omega[np.argmax(current < imax * (1 - 1e-6))] * RPM, "rpm")
curves = [(omega * RPM, torque(current), "-", name) for name, (omega, current) in runs.items()]
graph("task11.png", ("torque / (N*m)", *curves), x="speed n / rpm")
