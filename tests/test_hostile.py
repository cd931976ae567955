"""Hostile input ends in a result or in one line: no hang, no memory without bound, no markup, no nan."""

import contextlib
import gzip
import json
import os
import re
import signal
import sys
import zipfile
import zlib
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.assets import asset
from bench.bounds import Bounds, bounded
from bench.cli import main
from bench.console import console
from bench.errors import InputError, UndeterminedError
from bench.files import write_text
from bench.identify.regression import identify
from bench.lab.flights import read_flights
from bench.names import cell
from bench.plant.model_file import StoredModel, load_model, model_toml, read_table
from bench.plant.plant import Plant
from bench.plant.s_curve import s_curve
from bench.report.estimate import estimate_table
from bench.report.figures import save
from bench.report.identification_figure import identification_figure
from bench.report.lab import lab_html
from bench.rig.rig import Rig, load_rig
from bench.structured import json_text, parse_json
from bench.trace.channel import split_label
from bench.trace.conditioning import condition
from bench.trace.motion import motion
from bench.trace.read import read, read_recording
from bench.trace.stream import stream
from bench.trace.trace import Trace
from bench.trace.write import write
from bench.unit_grammar import LONGEST, require_unit
from bench.units import dimensionality, parse
from bench.usual_units import USUAL_UNITS
from tests.hostile import RIG, assert_one_line, columns, csv_of, run


@contextmanager
def cpu_seconds(most):
    """At most so much of this process' time; what would hang is stopped."""

    def stop(*_):
        raise TimeoutError(f"more than {most} s of CPU")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, most)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


TABLE = csv_of(*columns())
ROWS = TABLE.split("\n", 1)[1]
SLOW = {
    "UTF-8 mark alone": b"\xef\xbb\xbf",
    "UTF-16 mark alone": b"\xff\xfe",
    "mark and newlines": b"\xef\xbb\xbf\n\n",
    "trailing newlines": (TABLE + "\n" * 200_000).encode(),
    "trailing blanks": (TABLE + " " * 200_000).encode(),
    "label of blanks": f"time [s],velocity{' ' * 200_000}[rad/s],current [A]\n{ROWS}".encode(),
    "label of blanks in words": f"time [s],velocity [rad/s],a{' ' * 100_000}b{' ' * 100_000}c\n{ROWS}".encode(),
    "label of brackets": f"time [s],velocity [rad/s],{'[' * 200_000}\n{ROWS}".encode(),
    "label of digits": f"{'1' * 200_000}x,{'1' * 200_000}x\n1,2\n2,3\n".encode(),
    "label of signs": f"time [s],velocity [{'(' * 100_000}],current [A]\n{ROWS}".encode(),
    "cell of digits": f"time [s],velocity [rad/s]\n{'1' * 200_000}x,2\n2,3\n".encode(),
    "columns": (",".join(f"a{k}" for k in range(200_000)) + "\n1\n").encode(),
    "comments not closed": b"<!--" * 50_000,
    "comments after a declaration": b'<?xml version="1.0"?>' + b"<!--x" * 50_000,
    "comment of labels": b'<Trace><Single Name="Comment">units: ' + b"a" * 200_000 + b"</Single></Trace>",
    "elements in one another": b"<a>" * 200_000,
    "JSON in one another": b'{"entries": [{"input_volts":' + b"[" * 200_000 + b"}",
    "number of digits": b'{"entries": [{"input_volts":' + b"1" * 200_000 + b"}]}",
}


@pytest.mark.parametrize("case", SLOW)
def test_reading_takes_time_in_proportion(tmp_path, case):
    """The first three never ended; the others took seconds to minutes for a tenth of this."""
    (tmp_path / "x").write_bytes(SLOW[case])
    with cpu_seconds(4.0):
        try:
            read(tmp_path / "x")
        except InputError as error:
            assert "\n" not in str(error)


TWINCAT = "Name\tp\nStarttime of export\t{}\n\nName\tvelocity\nUnit\trad/s\n\n0\t1\n1\t2\n"


@pytest.mark.parametrize("ticks", ["132959733843³760000", "1" * 5000])
def test_digits_that_are_no_number_tell_no_time(tmp_path, ticks):
    """Found by fuzzing: a raised digit is a digit to Python, but no number; nor are more than 4300 of them."""
    (tmp_path / "x").write_text(TWINCAT.format(ticks))
    assert "starttime of export" not in read_recording(tmp_path / "x").metadata
    codesys = f"[key]; [value]\nFlags; {ticks}\n0.Variable; A.Velocity\n0.Data; \n; 0; 1\n; 1; 2\n"
    (tmp_path / "y").write_text(codesys)
    time = read_recording(tmp_path / "y").channels[0].time
    assert time is not None and time.unit == "ms"


@pytest.mark.parametrize(
    ("label", "expected"),
    [
        ("velocity [deg/s]", ("velocity", "deg/s")),
        (" velocity  [ deg/s ] ", ("velocity", "deg/s")),
        ("velocity[deg/s]", ("velocity", "deg/s")),
        ("a [b] [c]", ("a [b]", "c")),
        ("a [b", ("a [b", None)),
        ("a []", ("a", None)),
        ("a [b]]", ("a [b]]", None)),
        ("[V]", ("", "V")),
        ("a\n[V]", ("a", "V")),
        ("", ("", None)),
    ],
)
def test_labels(label, expected):
    assert split_label(label) == expected


HUGE_UNITS = [
    "m**9**9**9",
    "kg**9**9**9**9",
    "kg**(9**9)",
    "m^99",
    "m⁹⁹⁹",
    "m²²²²",
    "m**2**2",
    "m²**2",
    "((((m**12)**12)**12)**12)",
    "10**-10**10 m",
    "m**(2*2)",
    "m**x",
    "m" * 50_000,
    "m*" * 50_000 + "m",
    "(" * 3000 + "m" + ")" * 3000,
    "(" * 50 + "m" + ")" * 50,
    "m\x00",
    "m\nm",
]


@pytest.mark.parametrize("unit", HUGE_UNITS, ids=lambda unit: repr(unit[:24]))
def test_units_that_are_too_much_are_refused_at_once(unit):
    with cpu_seconds(2.0):
        with pytest.raises(ValueError):
            require_unit(unit)
        with pytest.raises(ValueError, match="is not a unit"):
            dimensionality(unit)
        with pytest.raises(InputError) as error:
            parse(f"1 {unit}", "m", "rig: x")
    assert len(str(error.value)) < 500


@pytest.mark.parametrize("unit", ["mW**0", "m**0", "s^0*m"])
def test_powers_of_nothing_are_no_fault_of_the_bench(unit):
    """Found by fuzzing: pint ends the first two in a KeyError."""
    with contextlib.suppress(ValueError):
        dimensionality(unit)


def test_units_as_they_are_written_pass():
    for unit in (
        *USUAL_UNITS,
        "m²",
        "m·s⁻¹",
        "kg*m**2/s**3/A**2",
        "m ** 2 / s",
        "m**(1/2)",
        "m^-2",
        "s**-0.5",
        "°C",
        "%",
    ):
        require_unit(unit)
    require_unit("m" * LONGEST)
    assert dimensionality("mm/s^2") == "[length] / [time] ** 2"


@pytest.mark.parametrize("text", ["1" * 200_000 + " m", "1 m" + " " * 200_000 + "\n.", "1e999999999 m", "1." * 100_000])
def test_values_that_are_too_much_are_refused_at_once(text):
    with cpu_seconds(2.0), pytest.raises(InputError) as error:
        parse(text, "m", "rig: x")
    assert len(str(error.value)) < 500


NAMES = [
    "axis [/b]",
    "[link=http://x]y[/link]",
    "[red]x",
    ":smile: axis",
    "a$x^$b",
    "$",
    r"\frac{",
    "<script>alert(1)</script>",
    "=1+1",
    "a\rb\x01c\x1b]0;title\x07\x1b[31m",
    "\u202etxt.exe",
    "half \udcff",
    "軸 🙂",
    "\"]]>'",
]


@pytest.fixture(scope="module")
def identified():
    trace = Trace.from_arrays(dict(zip(("time [s]", "velocity [rad/s]", "current [A]"), columns(), strict=True)))
    rig = Rig.of({"name": "x", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A"}})
    effort, _ = rig.net_effort(trace)
    return rig, identify(trace, rig), motion(trace, effort, condition(trace, effort, None))


@pytest.mark.parametrize("name", NAMES, ids=ascii)
def test_names_are_text_in_terminal_and_figures(identified, tmp_path, capsys, name):
    rig, estimate, moved = identified
    console().print(estimate_table(estimate, name))
    shown = capsys.readouterr().out
    for character in "\x1b\x07\x01\r\u202e":
        assert character not in shown
    for word in re.findall(r"[\[\]$:<>=/a-z]+", name.split("\x1b")[0]):
        assert word in shown
    figure = identification_figure(moved, estimate, rig.axis_kind, name)
    for ending in ("png", "svg", "pdf"):
        save(figure, tmp_path / f"x.{ending}")


@pytest.mark.parametrize("name", [name for name in NAMES if "\udcff" not in name], ids=ascii)
def test_names_are_text_in_a_model_and_come_back(tmp_path, name):
    stored = StoredModel(name, Plant.from_rig(load_rig(asset("data", "rigs", "sh30701p.toml"))).model)
    write_text(tmp_path / "model.toml", model_toml(stored))
    assert load_model(tmp_path / "model.toml").name == name


def test_file_names_that_are_not_utf_8(tmp_path):
    path = os.fsdecode(os.fsencode(tmp_path) + b"/half \xff.csv")
    Path(path).write_text(TABLE)
    assert read(path).origin == f"{tmp_path}/half \\xff.csv"
    write(read(path), Path(path).with_suffix(".parquet"))
    assert next(stream(Path(path).with_suffix(".parquet"))).origin == f"{tmp_path}/half \\xff.parquet"
    done = run("inspect", path, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "") and "half \\xff.csv" in done.stdout
    (tmp_path / "rig.toml").write_text(RIG)
    done = run("identify", path, "--rig", "rig.toml", "--out", "found", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    found = json.loads((tmp_path / "found" / "identify.json").read_text(encoding="utf-8"))
    assert found["provenance"]["traces"][0]["file"] == f"{tmp_path}/half \\xff.csv"
    assert "half \\xff.csv" in (tmp_path / "found" / "report.html").read_text(encoding="utf-8")


def test_names_are_no_formulas_in_a_spreadsheet():
    for text in ("=1+1", "+cmd|x", "-cmd", "@SUM(1)", "\t=1", "-1+1"):
        assert cell(text) == f"'{text}"
    for text in ("a=1", "-1.5e-3", "+2", "-0,5", ""):
        assert cell(text) == text


def test_names_are_text_in_html():
    page = lab_html([], [f"axis: {name}" for name in NAMES])
    assert "<script>" not in page and "&lt;script&gt;" in page


@pytest.mark.parametrize("name", ["axis [/b]", "a$x^$b\r\x01\x1b[31m"])
def test_a_run_with_such_names_ends_well(tmp_path, name):
    """Rig and recording both have it; before, the traceback came after all the work."""
    (tmp_path / "rig.toml").write_text(RIG.replace('"axis"', json.dumps(name)))
    file = name.replace("/", "")
    (tmp_path / f"{file}.csv").write_text(TABLE)
    done = run("identify", f"{file}.csv", "--rig", "rig.toml", "--out", "found", "--json", "-", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "\x1b" not in run("inspect", f"{file}.csv", cwd=tmp_path).stdout
    assert_one_line(run("identify", f"{file}.none", "--rig", "rig.toml", cwd=tmp_path), "no such file")


def one_sample(values, value):
    changed = values.copy()
    changed[1000] = value
    return changed


TIME, VELOCITY, CURRENT = columns()
IMPOSSIBLE = {
    "1e200 rad/s": (TIME, one_sample(VELOCITY, 1e200), CURRENT),
    "1e308 A": (TIME, VELOCITY, one_sample(CURRENT, 1e308)),
    "-1e155 A": (TIME, VELOCITY, one_sample(CURRENT, -1e155)),
    "time 1e300": (TIME * 1e300, VELOCITY, CURRENT),
    "time 1e-300": (TIME * 1e-300, VELOCITY, CURRENT),
    "time 1e-320": (np.arange(3000) * 1e-320, VELOCITY, CURRENT),
    "current 1e-200": (TIME, VELOCITY, CURRENT * 1e-200),
    "velocity 1e200": (TIME, VELOCITY * 1e200, CURRENT),
}


@pytest.mark.parametrize("case", IMPOSSIBLE)
def test_magnitudes_that_no_axis_has_are_refused(tmp_path, case):
    (tmp_path / "run.csv").write_text(csv_of(*IMPOSSIBLE[case]))
    rig = Rig.of({"name": "x", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A"}})
    with pytest.raises(InputError, match=r"is the unit right|increase|different times"):
        identify(stream(tmp_path / "run.csv"), rig)


@pytest.mark.parametrize("case", IMPOSSIBLE)
def test_json_never_holds_nan(tmp_path, monkeypatch, case):
    (tmp_path / "run.csv").write_text(csv_of(*IMPOSSIBLE[case]))
    monkeypatch.setattr(sys, "argv", ["bench", "inspect", str(tmp_path / "run.csv"), "--json", str(tmp_path / "x")])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code in (0, 1, 2)
    assert (tmp_path / "x").exists() is (stop.value.code == 0)
    if stop.value.code == 0:
        content = json.loads((tmp_path / "x").read_text(), parse_constant=pytest.fail)
        assert content["schema"]


def test_a_result_that_is_no_number_is_refused():
    for content, place in (({"a": {"b": [1.0, float("nan")]}}, r"a\.b\[1\]"), ({"c": (float("inf"),)}, r"c\[0\]")):
        with pytest.raises(UndeterminedError, match=place):
            json_text(content)


DEEP = "[" * 5000 + "]" * 5000
BAD_TOML = {
    "deep": f"x = {DEEP}",
    "deep tables": "x = " + "{a = " * 5000 + "1" + "}" * 5000,
    "digits": f"x = {'1' * 5000}",
    "null": "x = \0",
    "latin-1": "name = '\udce9'",
    "key": "'" * 5000,
}


@pytest.mark.parametrize("case", BAD_TOML)
@pytest.mark.parametrize("load", [load_rig, load_model, read_table])
def test_toml_that_is_none(tmp_path, case, load):
    path = tmp_path / "x.toml"
    path.write_text(BAD_TOML[case], errors="surrogateescape")
    with cpu_seconds(4.0), pytest.raises(InputError) as error:
        load(path)
    assert str(path) in str(error.value) and "\n" not in str(error.value)
    for place in (tmp_path, tmp_path / "none", tmp_path / ("x" * 300), "/proc/self/mem"):
        with pytest.raises(InputError):
            load(place)


def test_json_that_is_none():
    for text, words in ((DEEP * 40, "too deep"), ("1" * 5000, "number that is none"), ("{", "line 1")):
        with pytest.raises(InputError, match=words):
            parse_json("[" * 100_000 if words == "too deep" else text, "x.json")


RIG_TEXT = asset("data", "rigs", "sh30701p.toml").read_text()


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("control_period", "250 ns", "drive.control_period.*5 us to 10 s"),
        ("control_period", "1 ns", "drive.control_period"),
        ("control_period", "250 ms", "drive: inconsistent.*control_period must be below"),
        ("control_period", "250 s", "drive.control_period"),
        ("sample_period", "1 ns", "simulation.sample_period"),
        ("sample_period", "1e9 s", "simulation.sample_period"),
        ("position_gain", "1e300 1/s", "control_period must be below"),
    ],
)
def test_periods_in_the_wrong_unit_are_told(tmp_path, key, value, words):
    path = tmp_path / "rig.toml"
    path.write_text(re.sub(rf"^{key} = .*", f'{key} = "{value}"', RIG_TEXT, flags=re.MULTILINE))
    with pytest.raises(InputError, match=words):
        load_rig(path)


def test_motions_that_take_for_ever_are_told():
    with cpu_seconds(4.0), pytest.raises(InputError, match=r"takes 1e\+12 periods of the drive"):
        s_curve([1e9], [1.0], 1e-3)


def bomb(size):
    """Bytes that are mostly zeros, and their gzip of a thousandth."""
    return gzip.compress(b"time [s],velocity [rad/s]\n" + b"0" * size)


def test_what_expands_is_bounded(tmp_path):
    size = int(Bounds().small) * 2
    (tmp_path / "x.csv.gz").write_bytes(bomb(size))
    packed = zlib.compress(b"\0" * size)
    element = (15).to_bytes(4, "little") + len(packed).to_bytes(4, "little") + packed
    (tmp_path / "x.mat").write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + element)
    zeros = np.zeros(size // 8 // 2)
    pq.write_table(
        pa.table({"time [s]": zeros, "velocity [rad/s]": zeros, "current [A]": zeros}), tmp_path / "x.parquet"
    )
    for name in ("x.csv.gz", "x.mat", "x.parquet"):
        with pytest.raises(InputError, match=r"expands to .*allowed: .*--max-size"):
            read_recording(tmp_path / name)
    with pytest.raises(InputError, match=r"expands to .*allowed: 100 times"):
        list(stream(tmp_path / "x.parquet"))
    with zipfile.ZipFile(tmp_path / "x.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.csv", b"0" * size)
    with pytest.raises(InputError, match=r"x.zip: a.csv: expands to .*--max-size"):
        read_flights(tmp_path / "x.zip")


def test_texts_in_a_parquet_are_not_expanded(tmp_path):
    """A dictionary of one long text, twenty thousand times: 20 GB where they were read."""
    time = 1e-3 * np.arange(20_000)
    text = pa.DictionaryArray.from_arrays(pa.array(np.zeros(time.size, dtype=np.int32)), ["x" * 1_000_000])
    table = pa.table({"time [s]": time, "note": text, "velocity [rad/s]": np.sin(time)})
    pq.write_table(table, tmp_path / "x.parquet", store_schema=False)
    recording = read_recording(tmp_path / "x.parquet")
    assert [channel.name for channel in recording.channels] == ["time", "note", "velocity"]
    assert recording.channels[1].defect is not None
    assert np.array_equal(read(tmp_path / "x.parquet")["velocity"], np.sin(time))


def test_an_option_raises_the_bound_and_lowers_it(tmp_path):
    path = tmp_path / "x.csv.gz"
    path.write_bytes(gzip.compress(TABLE.encode() + b"\n" * (int(Bounds().small) * 2)))
    with pytest.raises(InputError, match="expands"):
        read(path)
    with bounded("1 GB"):
        assert len(read(path)) == TIME.size
    with bounded("100 kB"), pytest.raises(InputError, match=r"found 146 kB|at most 100 kB"):
        read(path)
    for text in ("much", "-1GB", "1e9", "nan", ""):
        with pytest.raises(InputError, match="--max-size"), bounded(text):
            pass


def test_a_fault_of_the_bench_is_never_taken_for_bad_input(tmp_path, monkeypatch, capsys):
    def fails(*_):
        raise TypeError("nobody\nforesaw \x1b[31m this")

    monkeypatch.setattr("bench.trace.read.read_recording", fails)
    for more in ([], ["--debug"]):
        monkeypatch.setattr(sys, "argv", ["bench", "inspect", "x.csv", *more])
        with pytest.raises(SystemExit) as stop:
            main()
        lines = capsys.readouterr().err.splitlines()
        assert stop.value.code == 70
        assert "a fault of the bench itself" in lines[-1] and "TypeError: nobody foresaw" in lines[-1]
        assert "\x1b" not in lines[-1]
        assert (len(lines) == 1) is (not more)
        assert ("--debug" in lines[-1]) is (not more)


def test_out_of_memory_is_one_line(monkeypatch, capsys):
    def fails(*_):
        raise MemoryError

    monkeypatch.setattr("bench.trace.read.read_recording", fails)
    monkeypatch.setattr(sys, "argv", ["bench", "inspect", "x.csv"])
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 70
    assert capsys.readouterr().err == "bench: out of memory; give less at a time, or a machine with more\n"
