"""Every command in a real terminal of 60, 80 and 120 columns: no number, name or word is cut, and nothing is lost."""

import json
import os
import pty
import re
import subprocess
import sys

import numpy as np
import pytest

from bench.assets import asset
from bench.cli import COMMANDS, GROUPS
from bench.report.document import table
from bench.report.terminal import rendered, wrapped
from bench.trace.write import write
from tests.export.two_links import MJCF, log, write_log
from tests.fit.motions import recording

NARROW, WIDE = (60, 80, 120), 4000
RIG = 'name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\nrotor_inertia = "2 kg*cm**2"\n'
#: In an order in which each finds what those before it have written.
LINES = (
    "demo --out demo",
    "list",
    "list rigs emps",
    "list effects stribeck_friction",
    "simulate lab.toml --out run1.csv.gz --profile fast_reversals",
    "inspect run1.csv.gz",
    "inspect foreign.csv",
    "identify run1.csv.gz own.csv.gz --rig rig.toml",
    "diagnose own.csv.gz --rig rig.toml --out found",
    "diagnose own.csv.gz --rig nowhere/a_rig_of_a_long_name.toml",
    "replay found/model.toml own.csv.gz --rig rig.toml --out replayed.csv",
    "replay found/model.toml own.csv.gz --rig rig.toml --page view.html",
    "export found/model.toml --snippet --out joint.xml",
    "check own.csv.gz --rig rig.toml --baseline axis.toml --update --without-names",
    "check other.csv.gz --rig rig.toml --baseline axis.toml",
    "friction run1.csv.gz --rig rig.toml",
    "validate --rigs 1 --workers 1 --seed 4",
    "fleet fleet.csv --out fleet --workers 1",
    "export found/model.toml --to drive --rig lab.toml --out tables --profile fast_reversals",
    "plan --rig lab.toml --out motion.csv",
    "lab --notebooks notebooks",
    "limits run1.csv.gz --rig lab.toml",
    "report found",
    "robot log.csv --mjcf robot.xml --joint elbow --out robot",
    "servo servo.csv",
)
#: Runs the lines, each once; whatever one prints is printed at each width, which the terminal is given before.
DRIVER = """
import fcntl, json, struct, sys, termios
from bench.cli import common, lab, main
import bench.cli

printing = False

def at_each_width(verb):
    def printed(*args, **named):
        global printing
        if printing:
            return verb(*args, **named)
        printing = True
        for width in WIDTHS:
            fcntl.ioctl(1, termios.TIOCSWINSZ, struct.pack("HHHH", 50, width, 0, 0))
            sys.stdout.write(f"\\x1bP{width}\\x1b\\\\")
            sys.stdout.flush()
            verb(*args, **named)
            sys.stdout.flush()
        sys.stdout.write("\\x1bP0\\x1b\\\\")
        printing = False
    return printed

WIDTHS, LINES = json.loads(sys.argv[1])
for name in ("tell", "printed", "say", "list_files"):
    verb = at_each_width(getattr(common, name))
    for module in (bench.cli, common, lab):
        if hasattr(module, name):
            setattr(module, name, verb)
for line in LINES:
    sys.stdout.write(f"\\x1b_{line}\\x1b\\\\")
    sys.argv = ["bench", *line.split()]
    try:
        main()
    except SystemExit as stop:
        assert stop.code in (0, 1, 2, 3), (line, stop.code)
    sys.stdout.flush()
"""
STYLE, PROGRESS = re.compile(r"\x1b\[[\d;?]*[A-Za-z]"), re.compile(r"\x1b\[\?25l.*?\x1b\[\?25h", re.DOTALL)


def in_a_terminal(command, folder, columns=None):
    """What a command writes to a terminal of its own."""
    parent, child = pty.openpty()
    environment = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "NO_COLOR", "GITHUB_ACTIONS", "CI")}
    environment |= {"TERM": "xterm-256color", "LINES": "50"} | ({} if columns is None else {"COLUMNS": str(columns)})
    with subprocess.Popen(command, stdin=child, stdout=child, stderr=child, cwd=folder, env=environment) as running:
        os.close(child)
        shown = b""
        while True:
            try:
                more = os.read(parent, 65536)
            except OSError:  # its end, as Linux has it
                break
            if not more:
                break
            shown += more
    os.close(parent)
    assert running.returncode == 0, shown.decode()[-3000:]
    return shown.decode().replace("\r\n", "\n")


def folder_of_files(folder):
    rng = np.random.default_rng(0)
    (folder / "rig.toml").write_text(RIG)
    (folder / "lab.toml").write_text(asset("data", "rigs", "sh30701p.toml").read_text())
    own = recording(rng, duration=3.0, position=True)
    write(own, folder / "own.csv.gz")
    write(recording(rng, duration=3.0, position=True), folder / "other.csv.gz")
    rows = [f"{k},{v:.4f},{i:.4f}" for k, (v, i) in enumerate(zip(own["velocity"], own["current"], strict=True))]
    head = "no,Application.GVL.Axis1.fActualVelocity,Application.GVL.Axis1.fActualCurrent"
    (folder / "foreign.csv").write_text("\n".join([head, *rows]) + "\n")
    (folder / "robot.xml").write_text(MJCF)
    write_log(folder / "log.csv", log())
    time = np.arange(0.0, 4.0, 0.02)
    goal = 0.5 * np.sign(np.sin(2.0 * time)) + 0.1 * np.sin(5.0 * time)
    late = np.convolve(goal, np.exp(-time / 0.08))[: time.size] / np.exp(-time / 0.08).sum()
    table = np.column_stack([time, goal, np.round(late, 3)])
    np.savetxt(folder / "servo.csv", table, delimiter=",", header="time [s],goal [rad],position [rad]", comments="")
    (folder / "fleet.csv").write_text("file,rig,axis\nown.csv.gz,rig.toml,press 1\nmissing.csv,rig.toml,press 2\n")


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """What each line prints at each width."""
    folder = tmp_path_factory.mktemp("terminal")
    folder_of_files(folder)
    out = in_a_terminal([sys.executable, "-c", DRIVER, json.dumps([(*NARROW, WIDE), LINES])], folder)
    found = {}
    for part in out.split("\x1b_")[1:]:
        line, _, printed = part.partition("\x1b\\")
        widths = found.setdefault(line, {})
        for piece in printed.split("\x1bP")[1:]:
            width, _, text = piece.partition("\x1b\\")
            widths[int(width)] = widths.get(int(width), "") + STYLE.sub("", PROGRESS.sub("", text))
    return found


def words_of(text):
    """Words, numbers with their units and names, less tables' headings, of which a stacked one leaves out the first."""
    cells = re.sub(r".*\n─+\n", "", text)
    return {word.rstrip(":") for word in re.split(r"[ \n]+", cells) if word.rstrip(":")}


def test_all_commands_are_among_them():
    assert {line.split()[0] for line in LINES} == {*COMMANDS, "report"}


@pytest.mark.parametrize("line", LINES)
@pytest.mark.parametrize("width", NARROW)
def test_nothing_is_cut_or_lost(shown, line, width):
    narrow, wide = shown[line][width], shown[line][WIDE]
    assert "…" not in narrow
    for one in narrow.splitlines():
        assert len(one) <= width or " " not in one.strip(), f"the terminal breaks this line itself: {one}"
    assert words_of(wide), "nothing was printed"
    assert words_of(wide) <= words_of(narrow.replace("─", "")), (
        "a word, number or name that a wide terminal shows is not there"
    )


def test_the_verdict_comes_first_in_its_colour(tmp_path):
    folder_of_files(tmp_path)
    line = [sys.executable, "-m", "bench", "identify", "own.csv.gz", "--rig", "rig.toml"]
    out = PROGRESS.sub("", in_a_terminal(line, tmp_path, 80))
    assert re.match(r"\r?(\x1b\[1A\x1b\[2K)?\x1b\[1;32mThe moment of inertia is ", out), out[:200]


@pytest.mark.parametrize("width", NARROW)
def test_help_tells_every_command_whole(width, tmp_path):
    out = in_a_terminal([sys.executable, "-m", "bench", "--help"], tmp_path, width)
    assert "..." not in out.replace("[ARGS]...", "")
    printed = re.sub(r"\s+", "", out)
    for name, command in COMMANDS.items():
        assert f"{name}{command.__doc__}".replace(" ", "") in printed
    assert all(f"{heading}:".replace(" ", "") in printed for heading in GROUPS)
    assert max(map(len, out.splitlines())) <= width


def test_a_table_that_has_no_room_is_stacked_row_by_row():
    wide = table("t", ("of", "first quantity>", "second>"), [("x", "123456.789", "(1.3100 ± 0.0012)·10⁻³")])
    assert rendered(wide, 30).plain.splitlines() == [
        *(
            "t",
            "x",
            "  first quantity: 123456.789",
            "  second:",
            "  (1.3100\N{NO-BREAK SPACE}±\N{NO-BREAK SPACE}0.0012)·10⁻³",
        )
    ]
    assert "of   first quantity" in rendered(wide, 80).plain


def test_a_line_is_broken_between_words_alone():
    kept = [line.replace("\N{NO-BREAK SPACE}", " ") for line in wrapped("gains 12 % of 3.5 ± 0.1 N", 8)]
    assert kept == ["gains", "12 % of", "3.5 ± 0.1", "N"]
    assert wrapped("  - a word_that_is_long b", 6) == ["  - a", "    word_that_is_long", "    b"]
