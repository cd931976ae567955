"""Inertia and friction of an axis, with intervals, from a CSV file whose columns have a controller's own names."""

from pathlib import Path

import bench
from bench.assets import asset

RIG = """
name = "my axis"
kind = "rotary"
[motor]
model = "SH30701P"
[trace.columns]
velocity = "Axis1.ActVel [deg/s]"
current = "Axis1.ActCurrent [mA]"
"""

Path("rig.toml").write_text(RIG, encoding="utf-8")
rig = bench.load_rig("rig.toml")

# a recording to try it on: the shipped rig's axis, as a controller would export it
recorded = bench.simulate(bench.load_rig(asset("data", "rigs", "sh30701p.toml")), "speed_staircase").trace
rows = zip(recorded.time, 57.29578 * recorded["velocity"], 1e3 * recorded["current"], strict=True)
lines = ["time [s],Axis1.ActVel [deg/s],Axis1.ActCurrent [mA]", *(f"{t:.6f},{v:.4f},{i:.3f}" for t, v, i in rows)]
Path("recording.csv").write_text("\n".join(lines), encoding="utf-8")

estimate = bench.identify(bench.read("recording.csv", rig.trace.columns), rig)
for name, found in estimate.parameters.items():
    low, high = found.ci95
    print(f"{name}: {found.value:.4g} ({low:.4g} to {high:.4g}) {found.unit}")
print(f"left: {estimate.residual.rms:.2g}, of noise {estimate.residual.noise_floor:.2g} {estimate.residual.unit}")
