"""The motion to record: of all that the rig can follow, the most informative one, with its expected errors."""

from pathlib import Path

import bench
from bench.assets import asset
from bench.export.plan import motions

rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
planned = motions(rig)
for each in planned:
    print(f"{each.profile}: {each.reason or f'largest relative standard error {each.worst:.2%}'}")

best = planned[0]
rows = zip(best.motion.time[::4], best.motion.position[::4], best.motion.velocity[::4], strict=True)
lines = ["time [s],position [rad],velocity [rad/s]", *(f"{t:.4f},{q:.6f},{w:.6f}" for t, q, w in rows)]
Path("motion.csv").write_text("\n".join(lines), encoding="utf-8")
print(f"wrote motion.csv: {best.profile}, {best.motion.time[-1]:.1f} s, {len(lines) - 1} rows")
