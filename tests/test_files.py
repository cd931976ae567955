"""Outputs are whole, never an input, and go where they were sent; inputs are read whatever is wrong with them."""

import ast
import json
import os
import shutil
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from bench.assets import asset
from bench.cli import app
from bench.cli.common import REPLACED, WRITTEN
from bench.course.grade import SEALED, seal
from bench.course.submission import find_submissions, read_submission
from bench.errors import InputError
from bench.export.mjcf import link_inertia
from bench.files import held, keeping, read_bytes, sha256, whole, write_text
from bench.plant.mjcf_file import read_mjcf
from bench.plant.robot import Robot
from tests.calls import calls_of
from tests.command import bench
from tests.hostile import RIG, ROOT, assert_one_line, columns, csv_of
from tests.sources import SOURCES, nodes


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """One that commands run in."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.toml").write_text(RIG)
    (tmp_path / "run.csv").write_text(csv_of(*columns()))
    (tmp_path / "simulated.toml").write_bytes(asset("data", "rigs", "sh30701p.toml").read_bytes())
    (tmp_path / "model.toml").write_text('schema = "bench.model/1"\nkind = "rotary"\n')
    (tmp_path / "link.csv").symlink_to("run.csv")
    (tmp_path / "hard.csv").hardlink_to(tmp_path / "run.csv")
    (tmp_path / "inside").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    "line",
    [
        "replay model.toml run.csv --rig rig.toml --out run.csv",
        "replay model.toml run.csv --rig rig.toml --out model.toml",
        "replay model.toml run.csv --rig rig.toml --out inside/../rig.toml",
        "identify run.csv --rig rig.toml --json run.csv",
        "identify run.csv --rig rig.toml --json link.csv",
        "identify run.csv --rig rig.toml --json hard.csv",
        "identify link.csv --rig rig.toml --json run.csv",
        "identify run.csv --rig rig.toml --json rig.toml",
        "diagnose run.csv --rig rig.toml --json rig.toml",
        "diagnose run.csv --rig rig.toml --holdout hard.csv --json run.csv",
        "inspect run.csv --json run.csv",
        "friction run.csv --rig rig.toml --json run.csv",
        "simulate simulated.toml --out simulated.toml",
    ],
)
def test_an_output_is_never_an_input(folder, line):
    before = {path: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    assert_one_line(bench(*line.split()), line.split()[-1], "an input of this command")
    assert {path: path.read_bytes() for path in folder.iterdir() if path.is_file()} == before


def test_a_file_beside_an_output_is_no_input_either(folder):
    """The truth of `x.csv` is `x.csv.truth.json`: a rig of that name is seen when it would be replaced."""
    rig = (folder / "simulated.toml").rename(folder / "x.csv.truth.json")
    before = rig.read_bytes()
    assert_one_line(bench("simulate", rig.name, "--out", "x.csv"), "x.csv.truth.json", "an input")
    assert rig.read_bytes() == before


ARM = '<mujoco><worldbody><body><joint name="el" type="hinge"/><geom size="0.1" mass="1"/></body></worldbody></mujoco>'


def test_what_another_file_leads_to_is_an_input_too(folder):
    """An MJCF's include, a fleet's row, a class' form: nobody gave them, and each was overwritten."""
    (folder / "arm.xml").write_text(ARM)
    (folder / "robot.xml").write_text("<mujoco><include file='&#97;rm.xml'/></mujoco>")
    (folder / "so").mkdir()
    (folder / "so" / "summary.json").write_text(csv_of(*columns(400)))
    (folder / "fleet.csv").write_text(f"file,rig\nfile://{folder}/so/summary.json,rig.toml\n")
    (folder / "forms").mkdir()
    form = "quantity,value,unit\nstudent,07,\n"
    (folder / "forms" / "grades.csv").write_text(form)
    content = {"schema": SEALED, "students": {"07": {"expected": {}, "truth": {}, "tolerance": {}, "mistakes": {}}}}
    (folder / "class.json").write_text(json.dumps({**content, "seal": seal(content, "key")}))
    (folder / "class.key").write_text("key")
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    with keeping([]):
        robot = Robot.of(Path("robot.xml"), "el")
        with pytest.raises(InputError, match=r"arm\.xml: is an input of this command"):
            write_text("arm.xml", robot.joint)
    for line, place in {
        "fleet fleet.csv --out other --workers 1 --json so/summary.json": "summary.json",
        "lab --grade forms --truth class.json --out forms": "grades.csv",
    }.items():
        status, _, message = bench(*line.split())
        assert status == 2 and place in message and "is an input of this command" in message
    assert {path: path.read_bytes() for path in before} == before


def test_the_table_of_grades_of_an_earlier_run_is_no_form_and_what_cannot_be_read_is_reported(tmp_path):
    (tmp_path / "grades.csv").write_text("student,task,quantity,given\n07,1,J,2\n")
    (tmp_path / "x.csv").mkdir()
    (tmp_path / "y.csv").symlink_to("y.csv")
    os.mkfifo(tmp_path / "z.json")
    assert [path.name for path in find_submissions(tmp_path)] == ["x.csv", "y.csv", "z.json"]
    for path in find_submissions(tmp_path):
        with pytest.raises(InputError, match=r"found a folder|levels of symbolic links|a pipe or a device"):
            read_submission(path)


def test_what_mujoco_warns_of_leaves_no_log_behind(folder, capfd):
    """Two hinges about one axis: their inertia matrix is singular, in any pose."""
    two = '<joint name="el" type="hinge"/><joint name="again" type="hinge"/>'
    (folder / "arm.xml").write_text(ARM.replace('<joint name="el" type="hinge"/>', two))
    before = set(folder.iterdir())
    Robot.of(Path("arm.xml"), "el")
    assert link_inertia(read_mjcf(Path("arm.xml"))[0], "el") == pytest.approx(0.4 * 0.1**2)
    assert capfd.readouterr() == ("", "") and set(folder.iterdir()) == before


@pytest.mark.parametrize("script", ["page/report.json", "page/model.toml"])
def test_a_script_replaces_nothing_else(tmp_path, monkeypatch, script):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "page").mkdir()
    (tmp_path / script).write_text("mine")
    status, _, message = bench("report", "page", "--script", script)
    assert (status, (tmp_path / script).read_text()) == (2, "mine") and "allowed: .js" in message


#: Calls that open a file, and the modules that may, beside `files.py`: they open what is shipped with the bench, what
#: they write, bytes that were read, what `bench.files` has read before, and what was copied from a storage.
OPENING = {"open", "read_text", "read_bytes", "from_xml_path", "from_file", "ParquetFile", "read_schema", "ZipFile"}
MAY_OPEN = """
course/notebooks course/report course/pdf course/catapult plant/axis_model report/html
__main__ cli/__init__ cli/check jobs/process packed trace/write view/video
trace/readers/arrow trace/readers/measurement trace/readers/named_arrays
course/flights plant/mjcf_file trace/stream
fleet/evaluate
"""


def test_what_is_read_is_opened_in_one_place():
    """Anything else could be overwritten, or could be a pipe that never ends."""
    found = {
        path.relative_to(ROOT / "bench").with_suffix("").as_posix()
        for path in SOURCES
        for node in nodes(path)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in OPENING
    }
    assert found == {"files", *MAY_OPEN.split()}


def test_every_path_of_every_command_is_known_as_read_or_written():
    """An output of an unknown name would be taken for an input, and refused."""
    read = {"file", "trace", "traces", "rig", "holdout", "model", "mjcf", "simulated", "data", "key"}
    read |= {"logs", "manifest", "recordings", "submissions", "truth", "profile", "ranges", "folders", "into"}
    for command in app.registered_commands:
        assert command.callback is not None
        for name, hint in command.callback.__annotations__.items():
            if "Path" in str(hint):
                assert name in read | WRITTEN | REPLACED, f"bench {command.callback.__name__}: {name}"


def test_json_goes_to_a_folder_that_is_there_or_that_out_makes(folder):
    refused = bench("identify", "run.csv", "--rig", "rig.toml", "--json", "new/found.json")
    assert_one_line(refused, "new/found.json", "no folder 'new'")
    assert not (folder / "new").exists()
    line = ("identify", "run.csv", "--rig", "rig.toml", "--json", "new/found.json", "--out", "new")
    assert bench(*line).status == 0
    written = {"identify.json", "identification.png", "report.html", "report.json"}
    assert {path.name for path in (folder / "new").iterdir()} == {"found.json", *written}


def test_links_are_followed_and_loops_refused(tmp_path):
    (tmp_path / "real.json").write_text("old")
    (tmp_path / "link.json").symlink_to("real.json")
    (tmp_path / "new.json").symlink_to("made.json")
    (tmp_path / "loop.json").symlink_to("loop.json")
    write_text(tmp_path / "link.json", "new")
    write_text(tmp_path / "new.json", "new")
    assert (tmp_path / "link.json").is_symlink() and (tmp_path / "real.json").read_text() == "new"
    assert (tmp_path / "new.json").is_symlink() and (tmp_path / "made.json").read_text() == "new"
    for place in ("loop.json", ".", "a\0b", "x" * 300, "real.json/x"):
        with pytest.raises(InputError, match=r"cannot be written|found a folder"):
            write_text(f"{tmp_path}/{place}", "x")
    with pytest.raises(InputError, match="a pipe or a device"):
        write_text("/dev/null", "x")
    there = {"link.json", "loop.json", "made.json", "new.json", "real.json"}
    assert {path.name for path in tmp_path.iterdir()} == there


@pytest.mark.parametrize("mask", [0o022, 0o077, 0o002])
def test_the_umask_is_respected_and_permissions_are_kept(tmp_path, mask):
    before = os.umask(mask)
    try:
        write_text(tmp_path / "new", "x")
        (tmp_path / "shared").touch()
        (tmp_path / "shared").chmod(0o640)
        write_text(tmp_path / "shared", "x")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o666 & ~mask
    assert stat.S_IMODE((tmp_path / "shared").stat().st_mode) == 0o640


def test_a_file_is_on_the_disk_before_it_takes_its_name(tmp_path):
    with calls_of(os.fsync, os.replace) as done:
        write_text(tmp_path / "x", "x")
    assert done == [os.fsync, os.replace, os.fsync]


def test_a_failure_leaves_what_was_there_and_nothing_else(tmp_path):
    write_text(tmp_path / "x", "old")
    for failure in (ValueError, KeyboardInterrupt):
        with pytest.raises(failure), whole(tmp_path / "x") as temporary:
            temporary.write_text("half")
            raise failure
    with pytest.raises(InputError, match="No space left on device"), whole(tmp_path / "x") as temporary:
        temporary.write_text("half")
        with open("/dev/full", "w") as full:  # noqa: PTH123
            full.write("x" * 100)
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("x", "old")]


KILLED = """
import os, signal, sys
from bench.files import whole
with whole("x") as temporary:
    temporary.write_text("half")
    print(temporary, flush=True)
    sys.stdin.read()
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_what_a_killed_run_has_left_goes_with_the_next_output_and_what_is_being_written_stays(tmp_path):
    write_text(tmp_path / "x", "old")
    pipe = subprocess.PIPE
    with subprocess.Popen([sys.executable, "-c", KILLED], cwd=tmp_path, stdin=pipe, stdout=pipe, text=True) as writer:
        assert writer.stdout is not None
        temporary = tmp_path / Path(writer.stdout.readline().strip()).name
        write_text(tmp_path / "y", "beside it")
        assert temporary.read_text() == "half"
        writer.communicate()
    assert writer.returncode == -signal.SIGKILL
    assert {path.name for path in tmp_path.iterdir()} == {"x", "y", temporary.name, f"{temporary.name}.lock"}
    (tmp_path / ".bench-of-mine").touch()
    (tmp_path / ".bench-0123456789ab-link.lock").symlink_to("y")
    write_text(tmp_path / "y", "new")
    here = {path.name for path in tmp_path.iterdir()}
    assert here == {"x", "y", ".bench-of-mine", ".bench-0123456789ab-link.lock"}
    assert (tmp_path / "x").read_text() == "old"


def test_inputs_are_kept_only_while_their_command_runs(tmp_path):
    path = tmp_path / "x"
    path.write_text("in")
    with keeping([path, tmp_path / "none", tmp_path]), pytest.raises(InputError, match="an input"):
        write_text(path, "out")
    write_text(path, "out")
    assert path.read_text() == "out"


def test_places_that_cannot_be_read(tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    os.mkfifo(tmp_path / "pipe")
    for place, words in {
        "none": "no such file",
        ".": "found a folder",
        "loop": "cannot be read .*[Ll]evels of symbolic links",
        "pipe": "a pipe or a device",
        "x" * 300: "cannot be read .*[Nn]ame too long",
        "a\0b": "cannot be read .*null",
    }.items():
        with pytest.raises(InputError, match=words):
            read_bytes(f"{tmp_path}/{place}", "a trace")
    with pytest.raises(InputError, match="a pipe or a device"):
        read_bytes("/dev/zero", "a trace")
    for endless in filter(os.path.exists, ("/proc/self/mem", "/proc/kmsg")):  # one fails, the other waits for ever
        for read in (lambda path: read_bytes(path, "a trace"), sha256):
            with pytest.raises(InputError, match=r"while it is read|cannot be read \(Permission denied\)"):
                read(Path(endless))


WRITER = """
import sys, time
from pathlib import Path
from bench.files import held, write_text
with held(Path("out")), held(Path("out")):
    for name in "abc":
        write_text(f"out/{name}", sys.argv[1])
        time.sleep(0.2)
"""


def test_of_two_writers_to_one_folder_one_wins_whole(tmp_path):
    started = [subprocess.Popen([sys.executable, "-c", WRITER, who], cwd=tmp_path) for who in ("1", "2")]
    assert [process.wait(60) for process in started] == [0, 0]
    assert len({path.read_text() for path in (tmp_path / "out").iterdir()}) == 1


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").touch()
    for place in ("file", "file/x", "a\0b"):
        with pytest.raises(InputError, match="cannot be written to"), held(tmp_path / place):
            pass


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no device that is full")
@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("rigs > /dev/full", ("standard output", "No space left on device")),
        ("--version >&-", ("standard output", "is closed")),
        ("rigs none 2> /dev/full", None),
        ("rigs none 2>&-", None),
    ],
)
def test_output_that_is_not_taken_is_reported_and_where_nothing_can_be_the_status_stands(tmp_path, line, words):
    """It was 70, a fault of the bench: the line that says what is wrong could not be written."""
    whole = ["sh", "-c", f"{sys.executable} -m bench {line}"]
    done = subprocess.run(whole, cwd=tmp_path, capture_output=True, text=True, check=False)
    if words is None:
        assert done.returncode == 2
    else:
        assert_one_line(done, *words)


ENDED = """
import sys
from bench.__main__ import main
class Kept:
    def __del__(self): print("taken down")
kept, sys.argv = Kept(), ["bench", *sys.argv[1:]]
print("printed first")
main()
"""


@pytest.mark.parametrize(("line", "status"), [("rigs", 0), ("rigs none", 2), ("--help", 0)])
def test_a_command_ends_without_taking_python_down(tmp_path, line, status):
    """Of a hundred runs on a busy machine two ended by SIGABRT: a thread of Arrow had let go of a file's bytes then."""
    whole = [sys.executable, "-c", ENDED, *line.split()]
    done = subprocess.run(whole, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == status and done.stdout.startswith("printed first")
    assert "taken down" not in done.stdout and len(done.stdout + done.stderr) > 50


def limited(limit, line, folder, before=()):
    line = f"ulimit {limit}; exec {sys.executable} -m bench {line}"
    whole = [*before, "bash", "-c", line]
    return subprocess.run(whole, cwd=folder, capture_output=True, text=True, check=False, timeout=60)


def test_what_the_system_refuses_is_reported(folder):
    """Memory, for which OpenBLAS would wait for ever, at once; files and processes when they are needed."""
    assert_one_line(limited("-v 400000", "rigs", folder), "ulimit -v", "1 GB")
    (folder / "fleet.csv").write_text("file,rig\nrun.csv,rig.toml\n")
    assert_one_line(limited("-n 8", "fleet fleet.csv --out so", folder), "Too many open files", "ulimit -n")


@pytest.mark.skipif(shutil.which("setpriv") is None, reason="root may start as many threads as it likes")
def test_too_few_threads_are_reported_before_a_library_aborts_the_process(tmp_path):
    rights = ("--inh-caps", "+dac_override", "--ambient-caps", "+dac_override")
    other = ["setpriv", "--reuid", "54321", "--clear-groups", *rights] if os.geteuid() == 0 else []
    assert_one_line(limited("-u 4", "rigs", tmp_path, other), "ulimit -u", "allow more")
