"""Hostile input ends in a result or in one line: no hang, no memory without bound, no traceback."""

import contextlib
import gzip
import io
import zipfile
import zlib

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.bounds import Bounds, bounded
from bench.cli import app
from bench.cli.common import guarded
from bench.course.flights import read_flights
from bench.errors import InputError
from bench.plant.mjcf_file import read_mjcf
from bench.trace.channel import split_label
from bench.trace.read import read, read_recording
from bench.trace.stream import stream
from bench.units import dimensionality, parse
from bench.units.grammar import LONGEST
from tests.command import bench
from tests.hostile import TABLE, columns, cpu_seconds

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


WIDE = "w" * 50_000
WORDY = {
    "unit": f"time [s],velocity [{WIDE}]\n0,1\n1,2\n",
    "label without a unit": f"time [s],{WIDE}\n0,1\n1,2\n",
    "labels": f"{WIDE},{WIDE}2\n0,1\n1,2\n",
    "label of a text": f"time [s],{WIDE} velocity [rad/s]\n0,{WIDE}\n1,2\n",
    "text": f"time [s],velocity [rad/s]\n0,{WIDE}\n1,2\n",
    "CODESYS": f"T\nP\nTimestamp(ms) {WIDE}\n0 {WIDE}\n1 2\n",
    "EPOS": f"EPOS Studio Version:;3\r\n;{WIDE}\r\nms;{WIDE}\r\n0;{WIDE}\r\n1;2\r\n",
    "TwinCAT": f"Name\tp\nStarttime of export\t132959733843760000\n\nName\t{WIDE}\nUnit\t{WIDE}\n\n0\t{WIDE}\n1\t2\n",
}


@pytest.mark.parametrize("case", WORDY)
def test_what_is_wrong_is_said_in_a_line_of_bounded_length(tmp_path, monkeypatch, case):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x").write_text(WORDY[case])
    with pytest.raises(InputError) as error:
        read("x")
    assert "\n" not in str(error.value) and len(str(error.value)) < 1200


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
        with pytest.raises(ValueError, match="is not a unit"):
            dimensionality(unit)
        with pytest.raises(InputError) as error:
            parse(f"1 {unit}", "m", "rig: x")
    assert len(str(error.value)) < 500


@pytest.mark.parametrize("unit", ["1e200**2*m", "m/1e-200**2", "m/sqrt(0)", "m/1e-320"])
def test_powers_that_no_number_holds_are_no_unit(unit):
    """Found by fuzzing: an OverflowError and a ZeroDivisionError; pint ends powers of nothing in a KeyError."""
    with pytest.raises(InputError, match="allowed: a number with a unit"):
        parse(f"1 {unit}", "m", "rig: x")
    for nothing in ("mW**0", "m**0", "s^0*m"):
        with contextlib.suppress(ValueError):
            dimensionality(nothing)


@pytest.mark.parametrize(
    ("unit", "dimension"),
    [
        ("m²", "[length] ** 2"),
        ("m·s⁻¹", "[length] / [time]"),
        ("kg*m**2/s**3/A**2", "[mass] * [length] ** 2 / [time] ** 3 / [current] ** 2"),
        ("m ** 2 / s", "[length] ** 2 / [time]"),
        ("m**(1/2)", "[length] ** 0.5"),
        ("m^-2", "1 / [length] ** 2"),
        ("s**-0.5", "1 / [time] ** 0.5"),
        ("N*m*(s/rad)**0.5", "[mass] * [length] ** 2 / [time] ** 1.5"),
        ("°C", "[temperature]"),
        ("%", "dimensionless"),
        ("mm/s^2", "[length] / [time] ** 2"),
        ("*".join(["m/m"] * (LONGEST // 4)), "dimensionless"),
    ],
)
def test_units_as_they_are_written_pass_however_long(unit, dimension):
    assert dimensionality(unit) == dimension


@pytest.mark.parametrize("text", ["1" * 200_000 + " m", "1 m" + " " * 200_000 + "\n.", "1e999999999 m", "1." * 100_000])
def test_values_that_are_too_much_are_refused_at_once(text):
    with cpu_seconds(2.0), pytest.raises(InputError) as error:
        parse(text, "m", "rig: x")
    assert len(str(error.value)) < 500


def test_what_expands_is_bounded(tmp_path):
    size = int(Bounds().small) * 2
    (tmp_path / "x.csv.gz").write_bytes(gzip.compress(b"time [s],velocity [rad/s]\n" + b"0" * size))
    packed = zlib.compress(b"\0" * size)
    element = (15).to_bytes(4, "little") + len(packed).to_bytes(4, "little") + packed
    (tmp_path / "x.mat").write_bytes(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM" + element)
    zeros = np.zeros(size // 8 // 2)
    table = pa.table(dict.fromkeys(("time [s]", "velocity [rad/s]", "current [A]"), zeros))
    pq.write_table(table, tmp_path / "x.parquet")
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
        assert len(read(path)) == TABLE.count("\n") - 1
    with bounded("100 kB"), pytest.raises(InputError, match=r"found 146 kB|at most 100 kB"):
        read(path)
    for text in ("much", "-1GB", "1e9", "nan", ""):
        with pytest.raises(InputError, match="--max-size"), bounded(text):
            pass


@contextlib.contextmanager
def failing(fault):
    """`bench` has a command that ends in a fault."""

    def fails() -> None:
        """Fail."""
        raise fault

    app.command("fails")(guarded(fails))
    try:
        yield
    finally:
        app.registered_commands.pop()


@pytest.mark.parametrize("more", [[], ["--debug"]])
def test_a_fault_of_the_bench_is_never_taken_for_bad_input(more):
    with failing(TypeError("nobody\nforesaw \x1b[31m this")):
        status, _, err = bench("fails", *more)
    lines = err.splitlines()
    assert (status, len(lines) == 1, "--debug" in lines[-1]) == (70, not more, not more)
    assert "a fault of the bench itself" in lines[-1] and "TypeError: nobody foresaw" in lines[-1]
    assert "\x1b" not in lines[-1]


def test_out_of_memory_is_one_line():
    with failing(MemoryError()):
        status, _, err = bench("fails")
    assert (status, err) == (70, "bench: out of memory; give less at a time, or a machine with more\n")


def test_a_zip_of_a_version_that_nobody_has_is_reported_in_one_line(tmp_path):
    """Found by fuzzing: the archive's directory asks for version 25.5."""
    file = io.BytesIO()
    np.savez(file, **dict(zip(("time_s", "velocity_rad_s", "current_A"), columns(20), strict=True)))
    content = bytearray(file.getvalue())
    content[content.index(b"PK\x01\x02") + 6] = 255
    (tmp_path / "x.npz").write_bytes(bytes(content))
    with pytest.raises(InputError, match="damaged"):
        read(tmp_path / "x.npz")


XML = (
    "<Trace><TraceVariable VarName='velocity'><Values>1,2</Values><Timestamps>1,2</Timestamps></TraceVariable></Trace>"
)
DOCTYPES = [
    "<!DOCTYPE Trace>",
    '<!DOCTYPE Trace [<!ENTITY a "x">]>',
    '<!DOCTYPE Trace [<!ENTITY a SYSTEM "rig.toml">]>',
    '<!DOCTYPE Trace SYSTEM "rig.dtd">',
]


@pytest.mark.parametrize("doctype", DOCTYPES)
def test_a_codesys_trace_with_a_doctype_is_refused(tmp_path, doctype):
    (tmp_path / "x.trace").write_text(XML)
    assert read_recording(tmp_path / "x.trace").channels[0].name == "velocity"
    for content in (doctype + XML, f"<?xml version='1.0'?>\n<!-- <Trace> -->{doctype}{XML}".replace("1,2", "&a;,2")):
        (tmp_path / "x.trace").write_text(content)
        with pytest.raises(InputError, match=r"found a DOCTYPE|not a trace in any format"):
            read_recording(tmp_path / "x.trace")


@pytest.mark.parametrize("entity", ['"hidden"', 'SYSTEM "secret.txt"'])
def test_an_mjcf_expands_no_entity(tmp_path, entity):
    (tmp_path / "secret.txt").write_text("hidden")
    xml = f'<!DOCTYPE mujoco [<!ENTITY a {entity}>]><mujoco model="&a;"><worldbody/></mujoco>'
    (tmp_path / "x.xml").write_text(xml)
    assert read_mjcf(tmp_path / "x.xml")[0].modelname == "&a;"
