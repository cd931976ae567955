"""`bench inspect`, `identify`, `diagnose`, `robot`, `friction`, `limits` and `fleet`: results of recordings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from typer import Argument, Option

import bench
from bench.cli import common
from bench.errors import InputError, UndeterminedError
from bench.files import sha256, write_text
from bench.names import in_a_row, readable

if TYPE_CHECKING:
    from bench.cli.common import Subject
    from bench.fit.refine import Refinement
    from bench.plant.robot import AddedBody
    from bench.report.document import Section

Estimator = Literal["regression", "lab"]


def inspect(
    file: Annotated[Path, Argument(metavar="TRACE", help="Recording of any known format.")],
    rig: common.OptionalRigOption = None,
    json: common.JsonOption = None,
    out: Annotated[
        Path | None, Option(help="Picture of every signal: .png, .pdf or .svg; or a folder for page and picture.")
    ] = None,
    draft: Annotated[Path | None, Option(help="Rig file to write, as far as the recording determines it.")] = None,
    motor: Annotated[str | None, Option(help="For --draft: a motor of the catalogue.")] = None,
    axis_name: common.AxisOption = None,
    report: common.ReportOption = None,
) -> None:
    """List every column of a recording with its likely signal, and the sampling rate, holes and ranges."""
    from bench.gate.gate import gate
    from bench.report.inspection import inspection, signals_picture
    from bench.report.serial import as_json
    from bench.trace.choose import GivenOptions
    from bench.trace.inspect import inspect_recording, to_json
    from bench.trace.read import read_recording
    from bench.trace.trace import assemble

    axis = bench.load_rig(rig).on_axis(axis_name) if rig else None
    how = axis.trace if axis is not None else GivenOptions(axis=axis_name)
    recording = read_recording(file)
    found = inspect_recording(recording, how)
    trace = None if found.asks is not None else assemble(recording, how)
    checks = () if trace is None else gate(trace, axis).checks
    command = common.typed("identify", file, *common.selecting(rig=rig, axis=axis_name))
    document = inspection(found, checks, trace, command)
    if draft is not None:
        from bench.rig.given import draft as drafted

        write_text(draft, drafted(found, motor, axis_name))
    written = common.write_figure(out, document, lambda: signals_picture(recording, how))
    common.write_page(report, document)
    common.write_json(json, lambda: to_json(found, {"checks": as_json(checks)}))
    common.tell(document, [*written, draft, report], json)


def identify(
    traces: common.TracesArgument,
    rig: common.BesideRigOption = None,
    json: common.JsonOption = None,
    out: Annotated[Path | None, Option(help="Folder for figures and JSON.")] = None,
    estimator: Annotated[Estimator, Option(help="lab: as in courses.")] = "regression",
    refine: Annotated[bool, Option("--refine", help="Polish by simulation error in MuJoCo.")] = False,
    offset: Annotated[bool, Option("--offset", help="Fit a constant torque (force) too.")] = False,
    cutoff: Annotated[str | None, Option(help="Filter's half-power frequency: 30, or 30 Hz.")] = None,
    axis_name: common.AxisOption = None,
    mjcf: common.MjcfOption = None,
    joint: common.JointOption = None,
    at: common.AtOption = None,
    figures: common.FiguresOption = "png",
    draft: common.DraftOption = None,
) -> None:
    """Identify inertia, viscous and Coulomb friction of a recording, or of several together, with 95 % intervals."""
    from bench.effects.present import parse_value
    from bench.fit.estimate import RefusedEstimateError
    from bench.report.identification import SCHEMA, identification, identification_json, moved

    of = common.subject(rig, axis_name, mjcf, joint, at, traces[0], draft)
    axis = of.rig.model_copy(update={"offset": of.rig.offset or offset})
    _require_consistent(traces, estimator, refine, bool(offset or cutoff))
    hertz = None if cutoff is None else parse_value(cutoff, "Hz", "--cutoff")
    options = {"estimator": estimator, "refine": refine, "offset": axis.offset, "cutoff": hertz}
    try:
        with common.refusal_as_json(json, SCHEMA):
            estimate, refinement = _estimate(traces, replace(of, rig=axis), estimator, refine, hertz)
    except RefusedEstimateError as error:
        known, why, basis = error.estimate, str(error), of.provenance(traces, options)
        common.write_json(json, lambda: identification_json(known, None, why, basis))
        common.warn(known.warnings)
        raise
    basis = of.provenance(traces, options)
    motions = [] if out is None else moved(traces, axis, estimate, None if of.joint is None else of.read)
    found = identification(f"{axis.name}: {in_a_row(traces)}", axis.axis_kind, estimate, refinement, motions, basis)
    common.deliver(found, lambda: identification_json(estimate, refinement, None, basis), json, out, f".{figures}")


def _require_consistent(traces: list[Path], estimator: Estimator, refine: bool, tuned: bool) -> None:
    """InputError where options contradict each other, or the number of recordings."""
    lab = estimator == "lab"
    if lab and (refine or tuned):
        raise InputError("--estimator lab", "found with --refine, --offset or --cutoff", "allowed: without them")
    if len(traces) > 1 and (refine or lab):
        found = f"found with {len(traces)} recordings"
        raise InputError("--refine" if refine else "--estimator lab", found, "allowed: with one recording")


def _estimate(
    traces: list[Path], of: Subject, estimator: Estimator, refine: bool, cutoff: float | None
) -> tuple[bench.Estimate, Refinement | None]:
    """Estimate by the method asked for, and what polishing did to it."""
    from bench.gate.gate import passed

    rig, trace = of.rig, traces[0]
    if estimator == "lab":
        from bench.fit.lab import identify_as_in_the_lab

        gated = passed(of.read(trace), rig)
        return replace(identify_as_in_the_lab(gated.trace, rig), checks=gated.checks), None
    from bench.report.terminal import progress
    from bench.trace.stream import stream

    with progress(f"identifying {', '.join(each.name for each in traces)}") as done:
        if not refine:
            parts = [
                map(of.reported, stream(each, rig.trace)) if of.joint is None else of.read(each) for each in traces
            ]
            return bench.identify(parts, rig, cutoff), None
        from bench.fit.refine import refine as polish  # MuJoCo: 0.1 s

        recording = passed(of.read(trace), rig).trace
        return polish(recording, rig, bench.identify(recording, rig, cutoff), done)


def diagnose(
    traces: common.TracesArgument,
    rig: common.BesideRigOption = None,
    holdout: Annotated[Path | None, Option(help="Another recording of the axis, not fitted.")] = None,
    json: common.JsonOption = None,
    out: Annotated[Path | None, Option(help="Folder for model, figures and JSON.")] = None,
    without: Annotated[list[str] | None, Option(metavar="EFFECT", help="Effect not to try. Repeatable.")] = None,
    axis_name: common.AxisOption = None,
    mjcf: common.MjcfOption = None,
    joint: common.JointOption = None,
    at: common.AtOption = None,
    figures: common.FiguresOption = "png",
    draft: common.DraftOption = None,
) -> None:
    """Find the effects that the model is missing, add them, and compare the gap before and after."""
    from bench.effects.present import named
    from bench.report.diagnosis import SCHEMA, diagnosis, diagnosis_json
    from bench.report.terminal import progress

    of = common.subject(rig, axis_name, mjcf, joint, at, traces[0], draft)
    axis, read = of.rig, of.read
    excluded = frozenset(named(name, "--without").name for name in without or [])
    other = read(holdout) if holdout else None
    names = in_a_row(traces)
    with common.refusal_as_json(json, SCHEMA), progress(f"diagnosing {names}") as done:
        recordings = [read(trace) for trace in traces]
        found = bench.diagnose(recordings, axis, other, excluded, done)
    basis = of.provenance(traces, {"without": sorted(excluded)}, holdout)
    moving = (
        [] if out is None else [*_frequency(found, recordings[0], axis), *_moving(found, of, traces[0], recordings[0])]
    )
    document = diagnosis(found, f"{axis.name}: {names}", basis, moving)
    common.deliver(document, lambda: diagnosis_json(found, basis), json, out, f".{figures}", found)


def robot(
    logs: Annotated[list[Path], Argument(metavar="LOG", help="Logs of the robot, of any known format.")],
    mjcf: Annotated[list[Path], Option(help="MJCF of the robot; one for each log where its payload differs.")],
    out: Annotated[Path, Option(help="Folder for MJCF, models, page and JSON.")],
    holdout: Annotated[Path | None, Option(help="Another log of it, not fitted.")] = None,
    rig: common.OptionalRigOption = None,
    joint: Annotated[list[str] | None, Option(metavar="NAME", help="Only this joint. Repeatable.")] = None,
    at: common.AtOption = None,
    payload: Annotated[
        str | None,
        Option(help="What a body carried: BODY=2.8kg@x,y,z in its frame, in m; BODY to seek it."),
    ] = None,
    without: Annotated[list[str] | None, Option(metavar="EFFECT", help="Effect not to try. Repeatable.")] = None,
    stand: common.StandOption = False,
    kp: Annotated[list[str] | None, Option(help="Gain of position controllers: 40, or NAME=40. Repeatable.")] = None,
    kd: Annotated[list[str] | None, Option(help="Their damping: 1, or NAME=1. Repeatable.")] = None,
    compare: Annotated[bool, Option("--compare", help="Compare friction models M1 to M6 by held-out torque.")] = False,
    grade: Annotated[bool, Option("--grade", help="Compare the MJCF's own values with the logs.")] = False,
    json: common.JsonOption = None,
) -> None:
    """Identify every joint of a robot from its logs, find missing effects, and write its MJCF with all of them."""
    from bench.effects.present import named
    from bench.plant.robot import joint_units
    from bench.report.parts import provenance
    from bench.report.robot import robot as document_of
    from bench.report.robot import robot_json
    from bench.report.terminal import progress

    excluded = frozenset(named(name, "--without").name for name in without or [])
    units = joint_units(mjcf[0])
    stated = common.positions(at or (), units)
    known = None if rig is None else bench.load_rig(rig)
    gains = _gains(kp or (), units, "--kp", ""), _gains(kd or (), units, "--kd", "*s")
    with progress(f"identifying the joints of {mjcf[0].name}") as done:
        found = bench.robot(
            logs, mjcf, holdout, known, joint or (), stated, excluded, _carried(payload), done, stand, *gains, compare
        )
    options = {"joint": joint or [], "payload": payload, "at": at or [], "without": sorted(excluded), "stand": stand}
    options |= {"kp": kp or [], "kd": kd or []} | ({"compare": True} if compare else {})
    basis = provenance(rig, logs, options, holdout, mjcf)
    folder = out if found.answered else None
    compared = found.grade if grade else None
    document = document_of(found, f"{in_a_row(mjcf)}: {in_a_row(logs)}", basis, folder, compared)
    common.deliver(document, lambda: robot_json(found, basis, compared), json, folder)
    if not found.answered:  # the first reason
        first = next(iter(found.joints.values()))
        if first.failed:
            raise InputError("none of the joints could be answered", f"{first.name}: {first.failed}", "see the table")
        reason = f"{first.name}: {next(iter(first.refused.values()))}"
        raise UndeterminedError("any joint", reason, first.record or "what the table advises for each joint")


def _gains(texts: Sequence[str], units: Mapping[str, str], option: str, per: str) -> dict[str, float] | None:
    """Gains of joints from `40`, of all that no other text names, and `NAME=40`; a number without unit is SI."""
    from bench.effects.present import parse_value

    found, efforts = dict[str, float](), {"rad": "N*m", "m": "N"}
    for text in sorted(texts, key=lambda one: "=" in one):
        name, equals, value = text.rpartition("=")
        if equals and name not in units:
            raise InputError(f"{option} {text}", "names no joint", f"allowed: NAME=40, NAME one of {', '.join(units)}")
        for joint in [name] if equals else units:
            unit = f"{efforts[units[joint]]}{per}/{units[joint]}"
            found[joint] = parse_value(value, unit, f"{option} {text}")
    return found or None


def _carried(text: str | None) -> AddedBody | str | None:
    """A payload of `BODY=2.8kg@x,y,z`, or the body alone."""
    from bench.effects.present import parse_value
    from bench.plant.robot import AddedBody

    body, equals, rest = (text or "").partition("=")
    if not equals:
        return text
    mass, at, places = rest.partition("@")
    where = f"--payload {text}"
    centre = [parse_value(place, "m", where) for place in places.split(",")] if at else [0.0, 0.0, 0.0]
    if len(centre) != 3:
        raise InputError(where, f"found {len(centre)} coordinates", "allowed: BODY=2.8kg@x,y,z, in m")
    return AddedBody(body, parse_value(mass, "kg", where), (centre[0], centre[1], centre[2]))


def _frequency(found: bench.Diagnosis, trace: bench.Trace, rig: bench.Rig) -> list[Section]:
    """The frequency response of the first recording; none where it excites too few frequencies."""
    from bench.fit.frequency_response import frequency_response
    from bench.report.frequency_response import frequency_section

    response = frequency_response(trace, rig)
    model = None if found.model is None else found.model.model
    return [] if response is None else [frequency_section(response, model, rig.axis_kind)]


def _moving(found: bench.Diagnosis, of: Subject, log: Path, trace: bench.Trace) -> list[Section]:
    """The robot whose joint was diagnosed, along the first log; none of an axis, nor of a model that does not move."""
    if of.along is None:
        return []
    from bench.report.simulation import moving_section
    from bench.view.joint_motion import joint_motion

    robot = of.along(log)
    motion = joint_motion(found, trace, of.rig, (robot.times, robot.poses))
    return [] if motion is None else [moving_section(robot.mjcf, {robot.joint: motion})]


def friction(
    traces: Annotated[
        list[Path], Argument(metavar="TRACE", help="Recordings of steady speeds, one or several in each.")
    ],
    rig: common.BesideRigOption = None,
    json: common.JsonOption = None,
    out: Annotated[
        Path | None, Option(help="Figure to write: .png, .pdf or .svg; or a folder for page and figure.")
    ] = None,
    axis_name: common.AxisOption = None,
    report: common.ReportOption = None,
    draft: common.DraftOption = None,
) -> None:
    """Measure friction over speed from recordings of steady speeds, and find the effect that curves it."""
    from bench.friction_map import friction_map
    from bench.report.friction import SCHEMA, friction_json
    from bench.report.friction import friction as document_of
    from bench.rig.rig import lacking

    of = common.subject(rig, axis_name, None, None, None, traces[0], draft)
    axis = of.rig
    with common.refusal_as_json(json, SCHEMA):
        found = friction_map([of.read(trace) for trace in traces], axis)
    following = f"Record a motion that reverses: `{of.command('identify', 'motion.csv')}` determines its inertia too."
    if rig is not None and not lacking(axis)["plan"]:
        plan = common.typed("plan", "--rig", rig, "--out", "motion.csv")
        following = f"`{plan}` writes a motion whose recording determines the inertia too."
    document = document_of(found, axis.name, following)
    written = common.write_figure(out, document, lambda: document.pictures[0])
    common.write_page(report, document)
    common.write_json(json, lambda: friction_json(found))
    common.tell(document, [*written, report, draft], json)


def limits(
    trace: Annotated[Path, Argument(metavar="TRACE", help="Recording of any known format.")],
    rig: common.BesideRigOption = None,
    out: Annotated[Path, Option(help="Diagram to write: .png, .pdf or .svg; or a folder for page and diagram.")] = Path(
        "limits.png"
    ),
    axis_name: common.AxisOption = None,
    json: common.JsonOption = None,
    report: common.ReportOption = None,
    draft: common.DraftOption = None,
) -> None:
    """Draw torque over speed: the reserve to the datasheet, or without one the limits that the log reaches."""
    from bench.report.drive import limits as against_datasheet
    from bench.report.envelope import envelope_document, envelope_json
    from bench.rig.envelope import envelope_of

    of = common.subject(rig, axis_name, None, None, None, trace, draft)
    axis, recording = of.rig, of.read(trace)
    envelope = cache(partial(envelope_of, recording, axis))
    if axis.motor.peak_curves:
        document = against_datasheet(recording, axis)
    else:
        document = envelope_document(envelope(), readable(trace.name), axis.axis_kind, axis.gear_ratio)
    written = common.write_figure(out, document, lambda: document.pictures[0])
    common.write_page(report, document)
    common.write_json(json, lambda: envelope_json(envelope(), axis.axis_kind))
    common.tell(document, [*written, report, draft], json)


def fleet(
    manifest: Annotated[Path, Argument(metavar="MANIFEST", help="CSV or Parquet: file, rig, axis, time and others")],
    out: Annotated[Path, Option(help="Folder for results, table, summary and page.")],
    diagnose: Annotated[bool, Option("--diagnose", help="Name missing effects too.")] = False,
    retry: Annotated[bool, Option("--retry", help="Do again what failed or timed out.")] = False,
    deadline: Annotated[float, Option(help="Of one recording, in s.", min=0.1)] = 120.0,
    memory: Annotated[float, Option(help="Of one recording, in GB.", min=0.25)] = 4.0,
    workers: Annotated[int | None, Option(help="Processes (preset: one a core).", min=1)] = None,
    scheduler: Annotated[str | None, Option(help="Dask's, e.g. tcp://host:8786.")] = None,
    storage: Annotated[
        list[str] | None, Option(help="fsspec's name of one that the manifest may name. Repeatable.")
    ] = None,
    json: common.JsonOption = None,
) -> None:
    """Evaluate many recordings of many axes: one row each, which axes changed since when, and which need attention."""
    from bench.fleet.fleet import TABLE
    from bench.fleet.fleet import fleet as run_fleet
    from bench.jobs.process import Limits
    from bench.report.fleet import FLEET, SUMMARY, fleet_document, fleet_json, write_fleet
    from bench.report.terminal import progress

    limits = Limits(deadline, memory * 1024**3)
    basis = {"version": bench.__version__, "manifest_sha256": sha256(manifest), "options": {"diagnose": diagnose}}
    publish = partial(write_fleet, out, provenance=basis)
    with progress(f"evaluating {manifest.name}") as done:
        found = run_fleet(manifest, out, diagnose, retry, limits, workers, scheduler, done, publish, storage or ())
    common.write_json(json, lambda: fleet_json(found, basis))
    common.tell(fleet_document(found, basis), (out / TABLE, out / SUMMARY, out / FLEET), json)
    if json != common.STDOUT:
        common.say(f"{found.evaluated} evaluated now")
    if not found.summary.counts["done"]:
        reason = f"none of {len(found.manifest)} recordings gave a result"
        raise UndeterminedError("the fleet", reason, f"what the column `reason` of {out / TABLE} recommends")
