"""`bench compensate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from bench.cli.common import RigOption, list_files, printed, say
from bench.errors import InputError
from bench.files import held, write_text
from bench.plant.profile_names import DEFAULT, NAMES


def compensate(
    model: Annotated[Path, typer.Argument(help="model.toml that diagnose wrote.")],
    rig: RigOption,
    out: Annotated[Path, typer.Option("--out", help="Folder for the tables.")],
    profile: Annotated[str, typer.Option("--profile", help=f"Motion to track: {', '.join(NAMES)}.")] = DEFAULT,
) -> None:
    """Make of a diagnosed model what its drive feeds forward; say how much better it tracks with it, by simulation."""
    import numpy as np

    from bench.export.feedforward import DriveUnits, feedforward, tracking
    from bench.plant.drive import Cascade
    from bench.plant.model_file import load_model
    from bench.plant.profiles import MotionLimits, plan
    from bench.report.drive import tracking_table
    from bench.report.terminal import progress
    from bench.rig.rig import load_rig

    axis, stored = load_rig(rig), load_model(model).model
    kind = stored.parameters.kind
    if kind is not axis.axis_kind:
        raise InputError(f"{model}: kind", f"found '{kind.name}'", f"allowed: '{axis.kind}', as {axis.source} says")
    motion = plan(profile, MotionLimits.from_rig(axis, stored.parameters, Cascade.from_rig(axis).control_period))
    reach = float(motion.position.min()), float(motion.position.max())
    with progress(f"tracking {profile}") as done:
        found = feedforward(stored, float(np.abs(motion.velocity).max()), reach)
        done(0.4)
        before = tracking(stored, axis, motion)
        done(0.7)
        after = tracking(stored, axis, motion, found)
    files = DriveUnits.of(axis).files(found)
    with held(out):
        for name, text in files.items():
            write_text(out / name, text)
    printed(tracking_table(f"{axis.name}: {profile}", before, after, kind))
    if found.left:
        say(f"left to the drive's feedback: {', '.join(found.left)}")
    list_files(out / name for name in files)
