"""Has an axis changed? A baseline, and a recording of today compared with it, as `bench check` does."""

import bench
from bench.assets import asset
from bench.baseline.observe import observe
from bench.baseline.state import read_baseline, write_baseline
from bench.effects.present import parse_effect

rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
was = [bench.simulate(rig, "speed_staircase", seed=seed).trace for seed in range(5)]
write_baseline("axis.toml", observe(was, rig).state)

worn = [parse_effect("cogging_torque:amplitude=0.03,harmonic=12")]
for what, effects in (("as it was", []), ("worn", worn)):
    now = bench.simulate(rig, "speed_staircase", seed=9, effects=effects).trace
    checked = bench.check(now, rig, read_baseline("axis.toml"))
    appeared = [named.name for named, _ in checked.appeared]
    print(f"{what}: {checked.result}, appeared: {appeared}")
