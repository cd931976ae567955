"""`bench robot`: every joint of a robot from its logs, and its MJCF with them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import bench
from bench.cli import common
from bench.cli.common import AtOption, JsonOption, OptionalRigOption
from bench.errors import InputError, UndeterminedError

if TYPE_CHECKING:
    from bench.plant.robot import AddedBody


def robot(
    logs: Annotated[list[Path], typer.Argument(metavar="LOG...", help="Logs of the robot, of any known format.")],
    mjcf: Annotated[Path, typer.Option("--mjcf", help="MJCF of the robot.")],
    out: Annotated[Path, typer.Option("--out", help="Folder for MJCF, models, page and JSON.")],
    holdout: Annotated[Path | None, typer.Option("--holdout", help="Another log of it, not fitted.")] = None,
    rig: OptionalRigOption = None,
    joint: Annotated[list[str] | None, typer.Option("--joint", help="Only this joint. Repeatable.")] = None,
    at: AtOption = None,
    payload: Annotated[
        str | None,
        typer.Option("--payload", help="What a body carried: BODY=2.8kg@x,y,z in its frame, in m; BODY to seek it."),
    ] = None,
    without: Annotated[list[str] | None, typer.Option("--without", help="Effect not to try. Repeatable.")] = None,
    json: JsonOption = None,
) -> None:
    """Identify every joint of a robot from its logs, find what each is missing, and write its MJCF with all of it."""
    from bench.effects.present import named
    from bench.files import held
    from bench.plant.robot import joint_units
    from bench.report.parts import provenance
    from bench.report.robot import robot as document_of
    from bench.report.robot import robot_json, title_of, write_robot
    from bench.report.terminal import progress

    excluded = frozenset(named(name, "--without").name for name in without or [])
    stated = common.positions(at or (), joint_units(mjcf))
    known = None if rig is None else bench.load_rig(rig)
    with progress(f"identifying the joints of {mjcf.name}") as done:
        found = bench.robot(logs, mjcf, holdout, known, joint or (), stated, excluded, _carried(payload), done)
    options = {"joint": joint or [], "payload": payload, "at": at or [], "without": sorted(excluded)}
    basis = provenance(rig, logs, options, holdout, mjcf)
    title, files = title_of(mjcf, logs), []
    if found.answered:
        with held(out):
            files = write_robot(out, found, title, basis)
    if json is not None:
        common.write_json(json, robot_json(found, basis))
    common.tell(document_of(found, title, basis), files, json)
    _require_answers(found)


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


def _require_answers(found: bench.IdentifiedRobot) -> None:
    """Raise why no joint could be answered, where none could: the first reason."""
    if found.answered:
        return
    first = next(iter(found.joints.values()))
    if first.failed:
        raise InputError("none of the joints could be answered", f"{first.name}: {first.failed}", "see the table")
    reason = f"{first.name}: {next(iter(first.refused.values()))}"
    raise UndeterminedError("any joint", reason, first.record)
