"""What every script of the course needs: recordings in SI, values of motor and disk, kT(Iq), graphs, results."""

import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from methods import filtered_acceleration, num_derivative

HERE = Path(__file__).parent
VALUES = json.loads((HERE / "values.json").read_text(encoding="utf-8"))


def value(name):
    """A value of motor or disk in SI, as values.json has it with its source."""
    return VALUES[name]["value"]


def table(name):
    """Columns of a file in the folder of recordings."""
    return np.loadtxt(HERE / "recordings" / f"{name}.csv", delimiter=",", skiprows=1, unpack=True)


def torque_constant(current):
    """kT(Iq) = a*Iq**2 + b*Iq + c: flat at zero, through stall and peak."""
    i0, imax = value("continuous_stall_current"), value("peak_current")
    conditions = [[0, 1, 0], [i0**2, i0, 1], [imax**2, imax, 1]]
    a, b, c = np.linalg.solve(conditions, [0, value("continuous_stall_torque") / i0, value("peak_torque") / imax])
    return a * current**2 + b * current + c


def signals(name):
    """t, omega, alpha and M of a recording, alpha_filt, and the samples of the others that it belongs to."""
    t, omega, current = table(name)
    alpha = num_derivative(omega, value(f"T_{name}"))
    return t, omega, alpha, torque_constant(current) * current, *filtered_acceleration(alpha)


def four_signals(name):
    """Of each of the four graphs of a recording its label, times, values and samples."""
    t, omega, alpha, M, alpha_filt, sync = signals(name)
    every = slice(None)
    return [
        ("speed / (rad/s)", t, omega, every),
        ("acceleration / (rad/s^2)", t, alpha, every),
        ("alpha_filt / (rad/s^2)", t[sync], alpha_filt, sync),
        ("torque / (N*m)", t, M, every),
    ]


def four_graphs(task, name):
    """Tasks 5 and 7: speed, acceleration, alpha_filt and torque of a recording on one time axis, and their largest."""
    _, omega, alpha, M, *_ = signals(name)
    show("largest speed", np.abs(omega).max(), "rad/s")
    show("largest acceleration", np.abs(alpha).max(), "rad/s^2")
    show("largest torque", np.abs(M).max(), "N*m")
    graph(f"{task}.png", *((label, (t, values, "-", "")) for label, t, values, _ in four_signals(name)))


def show(name, number, unit):
    """Print a result."""
    print(f"{name} = {number:.9g} {unit}")


def graph(file, *panels, x="time / s"):
    """One graph above the other; a panel is its y label and curves (x, y, style, label)."""
    figure, axes = plt.subplots(len(panels), 1, sharex=True, squeeze=False, figsize=(8, 1.5 + 1.8 * len(panels)))
    for axis, (label, *curves) in zip(axes[:, 0], panels, strict=True):
        for along, up, style, name in curves:
            axis.plot(along, up, style, label=name, markersize=3)
        axis.set_ylabel(label)
        axis.grid(alpha=0.3)
        if any(curve[3] for curve in curves):
            axis.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4, frameon=False, fontsize="small")
    axes[-1, 0].set_xlabel(x)
    figure.tight_layout()
    figure.savefig(HERE / file, dpi=120)
    plt.close(figure)
