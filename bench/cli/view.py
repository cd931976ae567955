"""`bench view`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from bench.cli.common import AxisOption, list_files, warn, write_page
from bench.cli.robot import AtOption, BesideRigOption, JointOption, MjcfOption, subject
from bench.errors import InputError
from bench.names import readable
from bench.plant.profile_names import DEFAULT, NAMES

if TYPE_CHECKING:
    from bench.cli.robot import Subject
    from bench.view.side_by_side import SideBySide


def view(
    model: Annotated[Path, typer.Argument(help="model.toml that diagnose wrote.")],
    trace: Annotated[
        Path | None, typer.Argument(help="Recording to run it along; without, it follows a profile.")
    ] = None,
    out: Annotated[Path, typer.Option("--out", help="Page to write, for any browser: .html, all in one file.")] = Path(
        "view.html"
    ),
    rig: BesideRigOption = None,
    profile: Annotated[str, typer.Option("--profile", help=f"Without a recording: {', '.join(NAMES)}.")] = DEFAULT,
    start: Annotated[float | None, typer.Option("--from", help="Show it from this time on, in s.")] = None,
    stop: Annotated[float | None, typer.Option("--to", help="Show it up to this time, in s.")] = None,
    video: Annotated[Path | None, typer.Option("--video", help="Video to write: .mp4, rendered by MuJoCo.")] = None,
    slowed: Annotated[float, typer.Option("--slowed", help="How many times slower the video plays.", min=1.0)] = 1.0,
    axis_name: AxisOption = None,
    mjcf: MjcfOption = None,
    joint: JointOption = None,
    at: AtOption = None,
) -> None:
    """Show a diagnosed model moving, with the measured axis as a ghost: in a browser, or as a video."""
    if trace is None and rig is None:
        raise InputError(
            "TRACE", "missing", "allowed: a recording, or --rig with [drive], whose profile it then follows"
        )
    if video is not None:
        from bench.view.video import prepare  # before anything imports MuJoCo, which takes its renderer then

        prepare(video)
    of = subject(rig, axis_name, mjcf, joint, at)
    shown, warnings = _shown(model, trace, of, profile)
    shown = shown.between(start, stop)
    if video is not None:
        from bench.report.terminal import progress
        from bench.view.scene import Scene
        from bench.view.video import write_video

        with progress(f"rendering {video.name}") as done:
            write_video(video, shown, Scene.of(shown, of.rig.load), slowed, done)
    from bench.report.view import view as document_of

    write_page(out, document_of(shown, model, readable(profile if trace is None else trace.name), warnings))
    list_files([out, video])
    warn(warnings)


def _shown(model: Path, trace: Path | None, of: Subject, profile: str) -> tuple[SideBySide, list[str]]:
    """Model and ghost, and what the user should know before believing them."""
    from bench.view.side_by_side import along_profile, along_recording

    if trace is None:
        return along_profile(model, of.rig, profile), []
    from bench.diagnosis.replay import replay

    recording = of.read(trace)
    replayed = replay(model, recording, of.rig)
    no_position = f"{trace.name} holds no position: shown is the integral of its speed, from zero after each hole"
    return along_recording(model, replayed), [*replayed.warnings, *([] if "position" in recording else [no_position])]
