"""`bench replay` and `export`: use of a model that `diagnose` wrote."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Argument, Option

import bench
from bench.cli import common
from bench.cli.common import (
    AtOption,
    AxisOption,
    BesideRigOption,
    JointOption,
    MjcfOption,
    OptionalRigOption,
    ReportOption,
)
from bench.errors import InputError, SimulationError
from bench.files import held, write_text
from bench.names import readable
from bench.plant.profile_names import DEFAULT

if TYPE_CHECKING:
    from bench.cli.common import Subject
    from bench.diagnosis.replay import Replay
    from bench.plant.model_file import StoredModel
    from bench.view.free_running import FreeRun
    from bench.view.side_by_side import SideBySide

ModelArgument = Annotated[Path, Argument(metavar="MODEL", help="model.toml that diagnose wrote.")]
#: Name of a joint that no other is given for, as `load_models` has it.
ALONE = "axis"
#: Format of a drive's feed-forward tables.
DRIVE = "drive"
#: Endings of the files of simulators that take no XML.
ENDINGS = {"bam": ".json", "isaaclab": ".py", "mjlab": ".py", "newton": ".py"}


def replay(
    model: ModelArgument,
    trace: Annotated[
        Path | None, Argument(metavar="TRACE", help="Recording to run it along; without, it follows --profile.")
    ] = None,
    out: Annotated[
        Path | None,
        Option(help="Signals: a folder, a CSV file, or .mcap with joint states for Foxglove and Rerun."),
    ] = None,
    page: Annotated[Path | None, Option(help="Page of the motion to write, for any browser: .html.")] = None,
    video: Annotated[Path | None, Option(help="Video of the motion to write: .mp4, rendered by MuJoCo.")] = None,
    rig: BesideRigOption = None,
    profile: Annotated[str, common.profile_option("Without a recording:")] = DEFAULT,
    start: Annotated[float | None, Option("--from", help="Of page and video: first instant, in s.")] = None,
    stop: Annotated[float | None, Option("--to", help="Of page and video: last instant, in s.")] = None,
    slowed: Annotated[float, Option(help="How many times slower the video plays.", min=1.0)] = 1.0,
    axis_name: AxisOption = None,
    report: ReportOption = None,
    mjcf: MjcfOption = None,
    joint: JointOption = None,
    at: AtOption = None,
) -> None:
    """Run a diagnosed model along a recording: signals as CSV, motion as a page (--page) or a video (--video)."""
    shown = page is not None or video is not None
    if not shown and out is None and report is None:
        raise InputError("bench replay", "found no output", "allowed: --out FILE, --page FILE.html, --video FILE.mp4")
    if trace is None and (rig is None or out is not None or report is not None):
        allowed = "allowed: a recording; or --rig with [drive] and --page, for a profile that the model then follows"
        raise InputError("TRACE", "missing", allowed)
    if video is not None:
        from bench.view.video import prepare  # before anything imports MuJoCo, which takes its renderer then

        prepare(video)
    of = common.subject(rig, axis_name, mjcf, joint, at, trace)
    replayed = None if trace is None else bench.replay(model, of.read(trace), of.rig)
    if replayed is not None and trace is not None:
        out = _written(replayed, model, trace, of, out, report)
    if shown:
        _show(model, trace, replayed, of, profile, (start, stop), slowed, page, video)
    if replayed is not None and not (shown and out is None and report is None):
        common.say(replayed.summary)
    common.list_files([out, report, page, video])
    if replayed is not None and not shown:
        common.warn(replayed.warnings)


def _written(
    replayed: Replay, model: Path, trace: Path, of: Subject, out: Path | None, report: Path | None
) -> Path | None:
    """Write signals and report of a replay; the file of signals."""
    if out is not None:
        out = common.file_in(out, "replay.csv")
        if out.suffix.lower() == ".mcap":
            _joint_states(replayed, out, of.joint or ALONE)
        else:
            write_text(out, replayed.csv())
    if report is not None:
        from bench.report.simulation import replay as document_of

        moving = f"`{of.command('replay', model, trace, '--page', 'moving.html')}` shows it in motion."
        document = document_of(replayed, model, readable(trace.name), _following(replayed, trace, of, moving))
        common.write_page(report, document)
    return out


def _following(replayed: Replay, trace: Path, of: Subject, good: str) -> str:
    """What to do after a replay, which is `good` where model and recording match."""
    from bench.report.simulation import matches

    if matches(replayed):
        return good
    return f"`{of.command('diagnose', trace, '--out', 'found')}` searches for what the model is missing."


def _joint_states(replayed: Replay, out: Path, joint: str) -> None:
    """Measured and simulated; without efforts that are none, as a drive's amperes."""
    from bench.axis_kind import KINDS
    from bench.trace.write import write_joint_states

    topics = {"/measured": replayed.measured, "/simulated": replayed.simulated}
    if replayed.effort_unit not in {kind.effort_unit for kind in KINDS}:
        common.warn([f"{out.name} has no effort: joint states hold no {replayed.effort_unit}"])
        for signals in topics.values():
            del signals["effort"]
    write_joint_states(out, joint, replayed.time, topics)


def _show(
    model: Path,
    trace: Path | None,
    replayed: Replay | None,
    of: Subject,
    profile: str,
    between: tuple[float | None, float | None],
    slowed: float,
    page: Path | None,
    video: Path | None,
) -> None:
    """Write a page and a video of a model in motion, with the measured axis as a ghost; then warn."""
    shown, free, warnings = _shown(model, trace, replayed, of, profile)
    shown = shown.between(*between)
    robot = None if of.along is None or trace is None else of.along(trace)
    if video is not None:
        from bench.report.terminal import progress
        from bench.view.scene import Scene
        from bench.view.video import write_video

        scene = Scene.of(shown, of.rig.load) if robot is None else Scene.of_robot(robot)
        with progress(f"rendering {video.name}") as done:
            write_video(video, shown, scene, slowed, done)
    if page is not None:
        from bench.report.parts import NO_FURTHER
        from bench.report.simulation import view as document_of

        along = readable(profile if trace is None else trace.name)
        following = (
            f"Record this motion; `{of.command('replay', model, 'motion.csv', '--page', 'moving.html')}` compares."
        )
        if replayed is not None and trace is not None:
            following = _following(replayed, trace, of, NO_FURTHER)
        common.write_page(page, document_of(shown, model, along, warnings, free, robot, following))
    common.warn(warnings)


def _shown(
    model: Path, trace: Path | None, replayed: Replay | None, of: Subject, profile: str
) -> tuple[SideBySide, FreeRun | None, list[str]]:
    """Model and ghost, how far off the model runs by itself, and what the user should know before believing them."""
    from bench.view.free_running import BARE, free_run, restarted, without_effects
    from bench.view.side_by_side import along_profile, along_recording

    if trace is None or replayed is None:
        return along_profile(model, of.rig, profile), None, []
    recording = of.read(trace)
    others, without = restarted(model, recording, of.rig), without_effects(model, recording, of.rig)
    others = others if without is None else {BARE: without, **others}
    shown, free, warnings = replace(along_recording(model, replayed), others=others), None, list(replayed.warnings)
    try:
        free = free_run(model, recording, of.rig)
    except SimulationError as error:
        warnings.append(f"free-running, the model is not shown: {error}")
    if "position" not in recording:
        warnings.append(
            f"{trace.name} contains no position; the page shows the integral of its speed, from zero after each hole"
        )
    return shown, free, warnings


def export(
    model: ModelArgument,
    out: Annotated[Path, Option(help="File to write, or a folder.")],
    mjcf: Annotated[Path | None, Option(help="MJCF or URDF of the robot that has the joint.")] = None,
    joint: Annotated[list[str] | None, Option(metavar="NAME", help="Joint that it goes onto. Repeatable.")] = None,
    to: Annotated[
        str | None, Option(help="Format: mjcf; or without --mjcf mjlab, bam, isaaclab, newton, or drive with --rig.")
    ] = None,
    actuator: Annotated[str | None, Option(help="With --to bam: BAM's name of the actuator.")] = None,
    snippet: Annotated[bool, Option("--snippet", help="A default class and a body with only this joint.")] = False,
    ranges: Annotated[
        Path | None, Option(help="JSON of identify or diagnose: ranges for domain randomisation.")
    ] = None,
    armature: Annotated[str | None, Option(help="Inertia that becomes the joint's armature: motor, or all.")] = None,
    with_assets: Annotated[
        bool, Option("--with-assets", help="Copy meshes and textures into assets, next to the file.")
    ] = False,
    rig: OptionalRigOption = None,
    profile: Annotated[str, common.profile_option("With --to drive, the motion that tests the tables:")] = DEFAULT,
) -> None:
    """Write a diagnosed model for a robot's MJCF, for another simulator or for a drive, or ranges of its values."""
    from bench.plant.model_file import load_models

    if to == DRIVE or rig is not None:
        _feedforward(model, rig if to == DRIVE else None, out, profile)
        return
    alone = snippet or (to == "mjcf" and mjcf is None)  # without a robot, MJCF is the joint alone
    if [alone, mjcf is not None, ranges is not None, to not in (None, "mjcf")].count(True) != 1:
        found = "found none or several of --mjcf, --snippet, --ranges, --to"
        raise InputError("bench export", found, "allowed: one of them, e.g. `--snippet`")
    out = common.file_in(out, _file_name(to, mjcf, ranges))
    if with_assets and mjcf is None:
        raise InputError("--with-assets", "found without --mjcf", "allowed: with a robot's MJCF, `--mjcf ROBOT.xml`")
    models, lines = load_models(model, joint or (), scaled=True), []
    if (alone or ranges is not None) and len(models) > 1:
        one = f"pick one: `--joint {next(iter(models))}`; the file has {', '.join(models)}"
        raise InputError(model, "found several joints", one)
    if ranges is not None:
        from bench.export.mjcf import ranges_json

        text = ranges_json(next(iter(models.values())), ranges)
    elif to not in (None, "mjcf"):
        from bench.export.simulators import simulator_file

        text, lines = simulator_file(to, models, actuator)
    else:
        text, lines = _robot(models, out, mjcf, joint, armature, with_assets)
    write_text(out, text)
    for line in (*lines, f"wrote {readable(out)}"):
        common.say(line)


def _file_name(to: str | None, mjcf: Path | None, ranges: Path | None) -> str:
    """Name of the exported file in a folder."""
    if mjcf is not None:
        return f"{mjcf.stem}_id{mjcf.suffix}"
    return f"joint{'.json' if ranges is not None else ENDINGS.get(to or '', '.xml')}"


def _robot(
    models: Mapping[str, StoredModel],
    out: Path,
    robot: Path | None,
    joint: list[str] | None,
    armature: str | None,
    with_assets: bool,
) -> tuple[str, list[str]]:
    """Text of an MJCF or URDF with models of joints, and what went onto them."""
    from bench.export.mjcf import ArmatureShare, armature_of, robot_with, single_joint
    from bench.export.urdf import is_urdf, urdf_with

    if robot is None:
        name, lone = next(iter(models.items()))
        text, carried = single_joint(lone, name)
        return text, list(carried.lines)
    if not joint and list(models) == [ALONE]:  # of a lone model, whose joint nobody has named
        models = {"": models[ALONE]}
    if out.suffix == ".urdf":
        if not is_urdf(robot):
            raise InputError(
                out, f"found a URDF to be written from {robot.name}, an MJCF", "allowed: `--out robot_id.xml`"
            )
        text, lines = urdf_with(robot, models)
        return text, list(lines)
    shares = {share.value: share for share in ArmatureShare}
    if armature is not None and armature not in shares:
        raise InputError("--armature", f"found '{armature}'", f"allowed: {', '.join(shares)}")
    share = shares.get(armature or "")
    placed = {name: (one, armature_of(one, share)) for name, one in models.items()}
    text, lines = robot_with(robot, placed, out, with_assets=with_assets)
    return text, list(lines)


def _feedforward(model: Path, rig: Path | None, out: Path, profile: str) -> None:
    """Write what a drive feeds forward, as tables in a folder, and show how much better it tracks with them."""
    if rig is None:
        allowed = "allowed: both, for feed-forward tables: `--to drive --rig RIG --out FOLDER`"
        raise InputError("--to drive and --rig", "found one of them", allowed)
    import numpy as np

    from bench.export.feedforward import DriveUnits, feedforward, tracking
    from bench.plant.drive import Cascade
    from bench.plant.model_file import load_model
    from bench.plant.profiles import MotionLimits, plan
    from bench.report.drive import tracking_table
    from bench.report.terminal import progress

    axis, stored = bench.load_rig(rig), load_model(model, scaled=True).model
    kind = stored.parameters.kind
    if kind is not axis.axis_kind:
        raise InputError(f"{model}: kind", f"found '{kind.name}'", f"allowed: '{axis.kind}', as in {axis.source}")
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
    common.printed(tracking_table(f"{axis.name}: {profile}", before, after, kind))
    if found.left:
        common.say(f"without feed-forward, for the drive's feedback: {', '.join(found.left)}")
    common.list_files(out / name for name in files)
