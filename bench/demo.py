"""The whole chain on the embedded rig: simulate it, identify it, and set truth beside estimate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from bench.assets import asset
from bench.files import held
from bench.fit.estimate import Estimate
from bench.fit.regression import identify
from bench.plant.simulate import simulate
from bench.plant.truth import write_truth
from bench.report.identification import write_identification
from bench.rig.rig import load_rig
from bench.trace.read import read
from bench.trace.write import write


@dataclass(frozen=True)
class Demo:
    """What the demo found.

    Attributes:
        title: of the run.
        estimate: identified from the trace as it stands on disk.
        truth: the simulation's values by the parameters' names - SI.
        files: that were written.
    """

    title: str
    estimate: Estimate
    truth: Mapping[str, float]
    files: list[Path]


def demo(out: Path, progress: Callable[[float], None]) -> Demo:
    """Run the chain into a folder; the identification reads the trace file, like anybody's.

    Raises:
        InputError: the folder cannot be written to.
    """
    with held(out):
        return _demo(out, progress)


def _demo(out: Path, progress: Callable[[float], None]) -> Demo:
    rig = load_rig(asset("data", "rigs", "sh30701p.toml"))
    simulated = simulate(rig, progress=lambda share: progress(0.6 * share))
    trace = out / "trace.csv.gz"
    write(simulated.trace, trace)
    truth = write_truth(trace, simulated.truth)
    progress(0.8)
    estimate = identify(read(trace), rig)
    figures = write_identification(out, [trace], rig, estimate)
    progress(1.0)
    axis = simulated.truth.parameters
    known = {
        "moment_of_inertia": axis.inertia,
        "viscous_friction_coefficient": axis.viscous_friction_coefficient,
        "coulomb_friction_torque": axis.coulomb_friction,
        "load_moment_of_inertia": axis.inertia - axis.motor_inertia,
    }
    return Demo(f"{rig.name}, simulated in MuJoCo", estimate, known, [trace, truth, *figures])
