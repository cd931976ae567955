"""What every command does around its work: inputs are kept, files are bounded, results go where they are asked for.

And the options that several of them take.
"""

from __future__ import annotations

import functools
import inspect
import os
import shlex
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer
from typer import Argument, Option

import bench
from bench.bounds import bounded
from bench.errors import InputError, UndeterminedError
from bench.files import held, keeping, require_writable, write_text
from bench.names import plain, readable
from bench.plant.profile_names import NAMES

if TYPE_CHECKING:
    from bench.report.document import Document, Picture
    from bench.view.side_by_side import RobotAlong

#: Parameters of commands that name what is written, files or folders; every other path is read.
WRITTEN = frozenset({"out", "json", "junit", "draft", "synthetic", "notebooks", "report", "script", "page", "video"})
#: Those of them that name folders, which may be there.
FOLDERS = frozenset({"out", "synthetic", "notebooks"})
#: Parameters of commands that are the recordings which a result is of.
RECORDINGS = frozenset({"file", "trace", "traces", "logs"})
#: Notes on the recordings of this run, in order. Bad input is one line, without them.
NOTES: dict[str, None] = {}
#: Parameters of commands whose file is read, and replaced with `--update`.
REPLACED = frozenset({"baseline"})

TracesArgument = Annotated[list[Path], Argument(metavar="TRACE", help="Recordings of one axis, of any known format.")]


def _rig_file(given: str) -> Path:
    from bench.rig.rig import rig_file  # numpy and pydantic, which `--help` need not wait for

    return rig_file(given)


def _shipped_rigs() -> list[str]:
    from bench.rig.rig import shipped

    return [*shipped()]


def profile_option(about: str) -> Any:  # noqa: ANN401 - typer's
    """`--profile`, which a shell completes."""
    return Option("--profile", help=f"{about} {', '.join(NAMES)}.", autocompletion=lambda: [*NAMES])


def effect_option(about: str) -> Any:  # noqa: ANN401 - typer's
    """`--effect`, which a shell completes."""
    return Option("--effect", help=f"{about} Repeatable.", autocompletion=_effects)


def _effects() -> list[str]:
    from bench.effects.catalogue import catalogue

    return [*catalogue()]


#: How a command line names a rig file.
_RIG: dict[str, Any] = {"parser": _rig_file, "metavar": "RIG", "autocompletion": _shipped_rigs}
BesideRigOption = Annotated[
    Path | None,
    Option("--rig", help="Rig file (TOML), or a shipped rig's name; without, one is drafted.", **_RIG),
]
DraftOption = Annotated[
    Path | None, Option("--draft", help="Without --rig: file to write the rig to that was drafted.")
]
MjcfOption = Annotated[
    Path | None, Option("--mjcf", help="MJCF of the robot whose other dynamics are known, gravity among them.")
]
JointOption = Annotated[
    list[str] | None, Option("--joint", metavar="NAME", help="Joint of the MJCF that the log is of.")
]
AtOption = Annotated[
    list[str] | None,
    Option("--at", metavar="NAME=ANGLE", help="Of a joint that stands still and is not in the log. Repeatable."),
]
StandOption = Annotated[bool, Option("--stand", help="Fix a floating base: the robot was on a stand.")]
RIG_HELP = "Rig file (TOML), or a shipped rig's name: what is known about the axis."
RigOption = Annotated[Path, Option("--rig", help=RIG_HELP, **_RIG)]
OptionalRigOption = Annotated[Path | None, Option("--rig", help=RIG_HELP, **_RIG)]
RigArgument = Annotated[Path, Argument(help="Rig file with [drive] and [simulation], or a shipped rig.", **_RIG)]
AxisOption = Annotated[str | None, Option("--axis", help="Axis to read where a recording contains several.")]
FiguresOption = Annotated[
    Literal["png", "pdf", "svg"], Option("--figures", help="Format of the figures that --out writes.")
]
ReportOption = Annotated[Path | None, Option("--report", help="Page to write: .html, all in one file.")]
JsonOption = Annotated[Path | None, Option("--json", help="Write the result as JSON to this file; - is stdout.")]
#: Standard output, as `--json` names it.
STDOUT = Path("-")


def _everywhere(
    *,
    max_size: Annotated[str | None, Option(help="Bytes a file may have or expand to, e.g. 8GB (preset: 2 GB).")] = None,
    verbose: Annotated[bool, Option("--verbose", help="Print every section and every row.")] = False,
    debug: Annotated[bool, Option("--debug", help="Print the whole traceback of a failure.")] = False,
) -> None:
    """What every command takes."""


def _in_full() -> AbstractContextManager[None]:
    from bench.report.terminal import in_full  # rich: 0.1 s

    return in_full()


def guarded(verb: Callable[..., None]) -> Callable[..., None]:
    """A command that takes `--verbose`, `--debug` and `--max-size` too, and whose outputs replace none of its inputs.

    InputError: before any work, where an output is an input or `--json` names a folder that is not there.
    """
    signatures = (inspect.signature(each, eval_str=True) for each in (verb, _everywhere))
    taken = [one.replace(kind=one.KEYWORD_ONLY) for each in signatures for one in each.parameters.values()]

    @functools.wraps(verb)
    def command(
        max_size: str | None, verbose: bool, debug: bool, **given: object
    ) -> None:  # `debug` is `bench.cli.main`'s
        with (
            bounded(max_size),
            _in_full() if verbose else nullcontext(),
            keeping(path for _, path in _paths(given, read=True)),
        ):
            for name, path in _paths(given, read=False):
                if path != STDOUT and not (name in FOLDERS and path.is_dir()):
                    require_writable(path)
            json, out = given.get("json"), given.get("out")
            if isinstance(json, Path) and json != STDOUT and not json.parent.is_dir() and json.parent != out:
                raise InputError(json, f"found no folder '{json.parent}'", "allowed: a file in a folder that is there")
            with _of_recordings([path for name, path in _paths(given, read=True) if name in RECORDINGS]):
                verb(**given)

    vars(command)["__signature__"] = inspect.Signature(taken)
    command.__annotations__ = {one.name: one.annotation for one in taken}
    return command


@contextmanager
def _of_recordings(paths: Sequence[Path]) -> Iterator[None]:
    """Name the recordings in a refusal that names none of them."""
    try:
        yield
    except UndeterminedError as error:
        names = [readable(path) for path in paths]
        if names and not any(name in str(error) for name in names):
            more = f" and {len(names) - 1} more" if names[1:] else ""
            error.args = (f"{names[0]}{more}: {error}",)
        raise


def _paths(given: Mapping[str, object], read: bool) -> Iterator[tuple[str, Path]]:
    """Paths among a command's arguments that are read, or written, each with its name."""
    written = WRITTEN | REPLACED if given.get("update") else WRITTEN
    for name, value in given.items():
        if (name in written) is not read:
            paths = value if isinstance(value, list) else [value]
            yield from ((name, path) for path in paths if isinstance(path, Path))


def write_json(path: Path | None, text: Callable[[], str]) -> None:
    """Write JSON to a file, or to standard output, where it is asked for: only then it is made."""
    if path == STDOUT:
        typer.echo(text())
    elif path is not None:
        write_text(path, text() + "\n")


def write_page(path: Path | None, document: Document) -> None:
    """Write the page of a result to a file, where one is asked for; InputError for another ending than .html."""
    if path is not None:
        from bench.report.publish import write_html

        write_html(path, document)


def file_in(out: Path, name: str) -> Path:
    """The file to write for `--out`: `out`, or the file `name` in it if it is a folder, or has no ending."""
    return out / name if _is_folder(out) else out


def _is_folder(out: Path) -> bool:
    return out.is_dir() or not (out.suffix or out.exists())


def write_figure(out: Path | None, document: Document, picture: Callable[[], Picture]) -> list[Path]:
    """Write a picture to a file, or page and picture into a folder, and return the paths.

    InputError: an ending that is no picture's.
    """
    if out is None:
        return []
    if _is_folder(out):
        from bench.report.publish import write_document

        return write_document(out, document.model_copy(update={"pictures": (picture(),)}))
    from bench.report.figures import drawn, save  # matplotlib: 0.35 s

    save(drawn(picture()), out)
    return [out]


@contextmanager
def refusal_as_json(path: Path | None, schema: str, names: Sequence[str] = ()) -> Iterator[None]:
    """Write why a recording is refused as JSON; the error is passed on.

    Without names that is a refusal by the gate, with its checks; with names any, as the reason for each of these.
    """
    from bench.gate.gate import UnanswerableError

    try:
        yield
    except (InputError, UndeterminedError) as error:
        gated = isinstance(error, UnanswerableError)
        if gated or names:
            from bench.report.serial import serialised

            refused = dict.fromkeys(names, str(error)) if names else str(error)
            checks = error.checks if gated else ()
            write_json(path, lambda: serialised({"schema": schema, "refused": refused, "checks": checks}))
        raise


def deliver(
    document: Document,
    text: Callable[[], str],
    json: Path | None,
    out: Path | None,
    ending: str = ".png",
    whole: bench.Diagnosis | None = None,
) -> None:
    """Write a result into a folder and as JSON, where they are asked for, in one; show it, and list its files.

    `whole`: a diagnosis that can be loaded from the folder.
    """
    files: list[Path] = []
    with nullcontext() if out is None else held(out):
        if out is not None:
            from bench.report.publish import write_document  # jinja2 and matplotlib: 0.5 s

            files = write_document(out, document, ending)
            if whole is not None:
                from bench.diagnosis.diagnosis import PACKED
                from bench.packed import pack

                files.append(pack(out / PACKED, whole))
        write_json(json, text)
    tell(document, files, json)


def tell(document: Document, files: Iterable[Path | None] = (), json: Path | None = None) -> None:
    """Show a result and list the files that were written of it, unless standard output is its `json`; then warn."""
    if json != STDOUT:
        from bench.report.terminal import show

        show(document)
        list_files(files)
    warn(document.warnings)


def printed(part: object) -> None:
    """Print a part of a document."""
    from bench.report.terminal import console, rendered
    from bench.report.terminal import printed as print_text

    text = rendered(part, console().width)
    assert text is not None
    print_text(text)


def say(text: str, err: bool = False, tone: str = "") -> None:
    """A line on standard output, or standard error; on a terminal as many as it takes, and no word is cut.

    tone: colour in which a terminal shows what comes before the first colon.
    """
    text, stream = plain(text), sys.stderr if err else sys.stdout
    if stream is not None and stream.isatty():
        from bench.report.terminal import wrapped

        text = "\n".join(wrapped(text, shutil.get_terminal_size().columns))
        if tone and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb":
            head, colon, rest = text.partition(":")
            text = typer.style(f"{head}{colon}", tone, bold=True) + rest
    with suppress(*[OSError] if err else []):  # where standard error is full or closed, the status has to do
        print(text, file=stream, flush=True)  # by the stream's own encoding, which `typer.echo` replaces


def list_files(files: Iterable[Path | None]) -> None:
    """A line for each file written."""
    for path in files:
        if path is not None:
            say(f"wrote {readable(path)}")


def warn(warnings: Iterable[str]) -> None:
    """A line on standard error for each warning."""
    for warning in warnings:
        say(f"warning: {readable(warning)}", err=True, tone="yellow")


@dataclass(frozen=True)
class Subject:
    """What a recording is of: an axis, or a robot's joint, which alone has the last three.

    Attributes:
        files: of the rig and of the robot, where they are given.
        read: how its recordings are read whole.
        reported: a recording, whose notes are printed with the result, or with why there is none.
        along: the robot along a log.
        options: of the command that select the joint.
        selected: options that select the axis or joint, as a command has them.
    """

    rig: bench.Rig
    files: tuple[Path | None, Path | None]
    read: Callable[[Path], bench.Trace]
    reported: Callable[[bench.Trace], bench.Trace]
    joint: str | None = None
    along: Callable[[Path], RobotAlong] | None = None
    options: dict[str, object] = field(default_factory=dict)
    selected: tuple[str, ...] = ()

    def command(self, verb: str, *words: object) -> str:
        """A command for the same axis or joint, as it is typed."""
        return typed(verb, *words, *self.selected)

    def provenance(
        self, traces: Sequence[Path], options: Mapping[str, object], holdout: Path | None = None
    ) -> dict[str, Any]:
        """What a result of recordings is based on, with the options that change it."""
        from bench.report.parts import provenance

        rig, mjcf = self.files
        return provenance(rig, traces, {**options, **self.options}, holdout, mjcf)


def typed(*words: object) -> str:
    """A command of the bench as it is typed."""
    return readable(shlex.join(["bench", *map(str, words)]))


def selecting(**options: object) -> tuple[str, ...]:
    """Options that are given, as a command has them, those of several values once for each."""
    values = {name: value if isinstance(value, list) else [value] for name, value in options.items()}
    return tuple(str(word) for name in values for one in values[name] if one is not None for word in (f"--{name}", one))


def subject(
    rig: Path | None,
    axis: str | None,
    mjcf: Path | None,
    joints: Sequence[str] | None,
    at: Sequence[str] | None,
    trace: Path | None,
    draft: Path | None = None,
) -> Subject:
    """The axis of a rig file, or of one drafted from the first recording, or the joint of an MJCF; by these options.

    InputError: neither is given, options that do not go together, or a file that cannot be read.
    """
    named = [*dict.fromkeys(joints or [])]
    if len(named) > 1:
        every = shlex.join(word for name in named for word in ("--joint", name))
        allowed = f"allowed: one; for several: `bench robot {trace} --mjcf {mjcf} {every} --out robot_id`"
        raise InputError("--joint", f"found {', '.join(named)}", allowed)

    def reported(trace: bench.Trace) -> bench.Trace:
        of_gate = trace.metadata.get("assumed_units")
        NOTES.update(dict.fromkeys(note for note in trace.notes if note != of_gate))
        return trace

    joint = next(iter(named), None)
    selected = selecting(rig=rig, axis=axis, mjcf=mjcf, joint=joint, at=at)
    if mjcf is None:
        if joint is not None or at:
            raise InputError("--joint" if joint is not None else "--at", "found without --mjcf", "allowed: with --mjcf")
        if rig is not None and draft is not None:
            raise InputError("--draft", "found with --rig", "allowed: without, for the rig that is drafted then")
        known = _drafted(trace, axis, draft) if rig is None else bench.load_rig(rig).on_axis(axis)
        return Subject(
            known, (rig, None), lambda path: reported(bench.read(path, known.trace)), reported, selected=selected
        )
    from bench.plant.robot import Robot, joint_rig, poses_along, read_log

    robot = Robot.of(mjcf, joint)
    within = joint_rig(None if rig is None else bench.load_rig(rig).on_axis(axis), robot)
    stands = positions(at or (), robot.units)

    def read(path: Path) -> bench.Trace:
        return reported(read_log(path, within, robot, stands))

    def along(path: Path) -> RobotAlong:
        from bench.view.side_by_side import RobotAlong

        return RobotAlong(mjcf, robot.joint, within.gear_ratio, *poses_along(path, within, robot, stands))

    return Subject(within, (rig, mjcf), read, reported, joint, along, {"joint": joint, "at": at or []}, selected)


def _drafted(trace: Path | None, axis: str | None, draft: Path | None) -> bench.Rig:
    """The rig that a recording drafts, with a warning of what it assumes."""
    if trace is None:
        raise InputError("--rig", "missing", "allowed: a rig file, or --mjcf and --joint")
    from bench.rig.given import drafted
    from bench.trace.read import read_recording

    rig, text, assumed = drafted(read_recording(trace), axis)
    if draft is not None:
        write_text(draft, text)
    warn([f"{assumed}. {f'It is {draft} now' if draft is not None else '`--draft rig.toml` keeps it'}"])
    return rig


def positions(texts: Sequence[str], units: dict[str, str]) -> dict[str, float]:
    """Positions - rad (m) - of joints from `NAME=0.3 rad`; a number without unit is SI."""
    from bench.effects.present import parse_value

    found = {}
    for text in texts:
        name, sign, value = (part.strip() for part in text.partition("="))
        if not sign or name not in units:
            allowed = f"allowed: NAME=ANGLE, NAME one of {', '.join(units) or 'none, as the robot has one joint'}"
            raise InputError(f"--at {text}", "names no other joint" if sign else "has no =", allowed)
        found[name] = parse_value(value, units[name], f"--at {text}")
    return found
