"""The whole chain on the embedded rig: simulate it, identify it, and set truth beside estimate."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from bench.assets import asset
from bench.files import held
from bench.fit.identify import identify
from bench.plant.simulate import simulate, write_truth
from bench.report.document import Document
from bench.report.identification import identification, moved
from bench.report.publish import write_document
from bench.rig.rig import load_rig
from bench.trace.read import read
from bench.trace.write import write


def demo(out: Path, progress: Callable[[float], None]) -> tuple[Document, list[Path]]:
    """Run the chain into a folder; the identification reads the trace file, like anybody's.

    Returns:
        The identification beside the truth, and the files that were written.

    Raises:
        InputError: the folder cannot be written to.
    """
    rig, trace = load_rig(asset("data", "rigs", "sh30701p.toml")), out / "trace.csv.gz"
    with held(out):
        simulated = simulate(rig, progress=lambda share: progress(0.6 * share))
        write(simulated.trace, trace)
        truth = write_truth(trace, simulated.truth)
        progress(0.8)
        estimate = identify(read(trace), rig)
        axis = simulated.truth.parameters
        known = {
            "moment_of_inertia": axis.inertia,
            "viscous_friction_coefficient": axis.viscous_friction_coefficient,
            "coulomb_friction_torque": axis.coulomb_friction,
            "load_moment_of_inertia": axis.inertia - axis.motor_inertia,
        }
        title, motions = f"{rig.name}, simulated in MuJoCo", moved([trace], rig, estimate)
        found = identification(title, rig.axis_kind, estimate, motions=motions, truth=known)
        files = write_document(out, found)
    progress(1.0)
    return found, [trace, truth, *files]
