"""Hide an effect in a simulated axis, find it from the recording alone, and see the gap close on another one."""

import bench
from bench.assets import asset
from bench.effects.present import parse_effect

rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
hidden = [parse_effect("cogging_torque:amplitude=0.05,harmonic=6")]
run, holdout = (bench.simulate(rig, "identification", seed=seed, effects=hidden).trace for seed in (1, 2))

found = bench.diagnose(run, rig, holdout=holdout)
print(found.verdict)
for effect in found.effects:
    for name, quantity in effect.parameters.items():
        low, high = quantity.ci95
        print(f"{effect.name}, {name}: {quantity.value:.4g} ({low:.4g} to {high:.4g}) {quantity.unit}")
before, after = found.torque.holdout
floor = found.torque.noise_floor
print(f"torque gap on the other recording: {before:.4f} N*m before, {after:.4f} after, noise floor {floor:.4f}")
