"""Several recordings of one axis, fitted together, and the interval in which the next one is expected."""

import bench
from bench.assets import asset

rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
runs = [bench.simulate(rig, "speed_staircase", seed=seed).trace for seed in range(3)]

together = bench.identify(runs, rig)
for name, found in together.parameters.items():
    alone = [f"{one.parameters[name].value:.5g}" for one in together.recordings if name in one.parameters]
    print(f"{name}: {found.value:.5g} {found.unit} together, by itself {', '.join(alone)}")
low, high = together.between["moment_of_inertia"].predictive95
print(f"the next recording's moment of inertia is expected from {low:.5g} to {high:.5g} kg*m**2")
