"""A fleet in closed form: axes recorded again and again, some of which change, and recordings that are damaged."""

import gzip
import os
from dataclasses import dataclass, field

import numpy as np

from bench.trace.trace import Trace
from bench.trace.write import write
from tests.diagnosis.command import RIG
from tests.fit.motions import UNITS, Truth, recording

#: By how much recordings of one axis differ anyway, as share.
BETWEEN = 0.01


@dataclass
class Made:
    """Rows of a manifest, and where each recording lies."""

    folder: object
    rows: list = field(default_factory=list)

    def add(self, file, axis, place, rig="rig.toml"):
        """One row; recordings of an axis are a day apart."""
        day = np.datetime64("2026-01-01T06:00:00") + np.timedelta64(place, "D")
        self.rows.append(f"{file},{rig},{axis},{day},0{place:02d}")

    def write(self, name="fleet.csv"):
        path = self.folder / name
        path.write_text("\n".join(["file,rig,axis,time,shift", *self.rows]) + "\n")
        return path


def fleet_of(folder, axes, each, changed=(), duration=3.0, seed=0):
    """A folder with `each` recordings of every axis; Coulomb friction of some rises by 15 % from the middle on."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "rig.toml").write_text(RIG)
    made = Made(folder)
    for axis in range(axes):
        for place in range(each):
            rng = np.random.default_rng([seed, axis, place])
            rise = 1.15 if axis in changed and place >= each // 2 else 1.0
            truth = Truth(coulomb=0.06 * rise * (1.0 + BETWEEN * rng.normal()))
            file = f"press_{axis}_{place}.csv.gz"
            write(recording(rng, truth, duration=duration), folder / file)
            made.add(file, f"press {axis}", place)
    return made


def empty(path):
    path.write_bytes(b"")


def noise(path):
    path.write_bytes(np.random.default_rng(0).bytes(5000))


def cut_short(path):
    path.write_bytes(gzip.compress(b"time [s],velocity [rad/s],current [A]\n" + b"0,0,0\n" * 1000)[:-20])


def missing(path):
    path.unlink(missing_ok=True)


def pipe(path):
    """Whose writer never comes."""
    path.unlink(missing_ok=True)
    os.mkfifo(path)


def standing(path):
    time = np.arange(2000) * 1e-3
    silent = {"velocity": np.zeros(2000), "current": np.zeros(2000)}
    write(Trace(time, silent, UNITS, "standing"), path)


def without_current(path):
    whole = recording(np.random.default_rng(1), duration=1.0)
    write(Trace(whole.time, {"velocity": whole["velocity"]}, UNITS, "no current"), path)


DAMAGES = (empty, noise, cut_short, missing, pipe, standing, without_current)
