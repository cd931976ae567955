"""Many recordings of several axes, each evaluated on its own; `scheduler=` takes a Dask cluster."""

import shutil
from pathlib import Path

import pyarrow.parquet

import bench
from bench.assets import asset
from bench.effects.present import parse_effect
from bench.fleet.fleet import fleet
from bench.trace.write import write

if __name__ == "__main__":  # the recordings are evaluated in processes of their own
    shutil.copy(asset("data", "rigs", "sh30701p.toml"), "rig.toml")
    rig, rows = bench.load_rig("rig.toml"), ["file,rig,axis,time"]
    for axis in ("press", "saw"):
        for day in range(1, 5):
            worn = [parse_effect("unbalance:amplitude=0.2")] if (axis, day) == ("saw", 4) else []
            name = f"{axis}{day}.csv.gz"
            write(bench.simulate(rig, "speed_staircase", seed=day, effects=worn).trace, Path(name))
            rows.append(f"{name},rig.toml,{axis},2026-01-{day:02d}")
    Path("manifest.csv").write_text("\n".join(rows), encoding="utf-8")

    found = fleet(Path("manifest.csv"), Path("fleet"))
    print(found.summary.counts)
    table = pyarrow.parquet.read_table("fleet/fleet.parquet")
    for axis, day, explained in zip(*(table[name].to_pylist() for name in ("axis", "time", "explained")), strict=True):
        print(f"{axis} {day}: {explained:.6f} of the torque's variance explained")
