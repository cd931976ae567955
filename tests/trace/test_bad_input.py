"""Whatever a file holds, reading it gives a trace or one line naming the place, what was found and what is allowed."""

import gzip

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from bench.errors import InputError
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording
from bench.trace.read import read, read_recording
from bench.trace.write import write
from tests.trace import formats
from tests.trace.formats import COLUMNS, WRITERS
from tests.trace.recordings import csv_text, current, velocity

TIME = np.arange(60) * 1e-3
HEAD = "time [ms],velocity [deg/s],current [mA]\n"
ROWS = [f"{k},{10 * k},{k}\n" for k in range(60)]
GOOD = csv_text(TIME, velocity__deg_s=velocity(TIME), current__mA=current(TIME))


def _rows(**changed):
    """The good rows with `l7="..."` in place of line 7 of the file."""
    return "".join([HEAD, *(changed.get(f"l{line}", row) for line, row in enumerate(ROWS, 2))])


NO_TRACE = r"not a trace in any format the bench reads; allowed: LeRobot dataset, Parquet"
NO_UNIT = r"column 'velocity': has no unit, where other columns have theirs; allowed: .*\[tr"
BACKWARDS = r"line 30, column 'time \[ms\]': time runs backwards \(0.027 s, then 0.003 s\)"
REPEATED = r"line 3, column 'time \[ms\]': 30 of 60 samples repeat the time of another one"
TWO_ROWS = "\n0,1,1\n1,2,2\n"
#: Content of a file, and words of its refusal.
FILES = {
    "missing time": ("velocity [deg/s],current [mA]\n1,2\n2,3\n", r"column 'time': not in the file; found: velocity"),
    "no known signal": (f"time [ms],a [V],b [V]{TWO_ROWS}", r"position or velocity: not in the file; found: time"),
    "unit missing": (f"time [ms],velocity,current [mA]{TWO_ROWS}", NO_UNIT),
    "time without unit": ("time,velocity [deg/s]\n0,1\n1,2\n", r"column 'time': has no unit"),
    "empty unit": (f"time [ms],velocity [],current [A]{TWO_ROWS}", r"column 'velocity': has no unit"),
    "wrong dimension": ("time [ms],velocity [V]\n0,1\n1,2\n", r"\[V\]': found unit 'V'; allowed: .* rad/s or m/s"),
    "time in metres": ("time [m],velocity [deg/s]\n0,1\n1,2\n", r"column 'time \[m\]': found unit 'm'; allowed: .* s"),
    "no unit at all": ("time [ms],velocity [furlong/x]\n0,1\n1,2\n", r"found 'furlong/x', which is not a unit"),
    "two kinds of axis": (f"time [ms],position [m],velocity [deg/s]{TWO_ROWS}", r"position in m, velocity in rad/s"),
    "twice the same column": (f"time [ms],velocity [V],velocity [V]{TWO_ROWS}", r"several columns"),
    "header only": (HEAD, r"found a header and no samples; allowed: at least two samples"),
    "header without newline": (HEAD.strip(), r"found a header and no samples"),
    "no header": ("0,1,2\n1,2,3\n", r"position or velocity: not in the file; found: column 1, column 2, column 3"),
    "one column": ("velocity [deg/s]\n1\n2\n", r"line 1: found one column"),
    "one sample": (HEAD + ROWS[0], r"found 1 sample; allowed: at least two"),
    "text in a number": (_rows(l8="6,6O,6\n"), r"run.csv: line 8, .*deg/s\]': found '6O'; allowed: a number"),
    "infinite, and empty rows": (_rows(l8="6,6,-inf\n") + ",,\n,,\n", r"line 8, column 'current \[mA\]': found -inf"),
    "a number of Python's alone": (_rows(l8="6,6,1_0\n"), r"line 8, column 'current \[mA\]': found '1_0'"),
    "infinite": (_rows(l8="6,6,-inf\n"), r"line 8, column 'current \[mA\]': found -inf"),
    "hardly a number": (HEAD + "".join(f"{k},nan,{k}\n" for k in range(60)), r"'velocity \[deg/s\]': found 0 numbers"),
    "hardly a time": (
        HEAD + "".join(f"{k if k % 3 else ''},1,{k}\n" for k in range(60)),
        r"line 2, .*found 20 of 60 times empty",
    ),
    "short line": (_rows(l8="6,6\n"), r"line 8: found 2 cells; allowed: 3, as the header has"),
    "long line": (_rows(l8="6,6,6,6\n"), r"line 8: found 4 cells"),
    "time backwards": (_rows(l30="3,6,6\n"), BACKWARDS),
    "duplicate times": (HEAD + "".join(f"{k // 2},{10 * k},{k}\n" for k in range(60)), REPEATED),
    "all at one time": (HEAD + "5,1,1\n" * 50, r"found 1 different times"),
    "cut in the last line": (_rows().rstrip().rpartition(",")[0], r"line 61: found 2 cells"),
    "empty": (b"", r"the file is empty"),
    "blank": (b"\n  \n", r"the file is empty"),
    "latin-1 in the data": (_rows(l8="6,6µ,6\n").encode("latin-1"), r"line 8, .*found '6µ'; allowed: a number"),
    "utf-16 without mark": (GOOD.encode("utf-16-le"), NO_TRACE),
    "half a utf-16 character": (GOOD.encode("utf-16")[:-1], r"UTF-16-LE text is truncated"),
    "truncated gz": (gzip.compress(GOOD.encode())[:-40], r"gzip is truncated or damaged"),
    "damaged gz": (gzip.compress(GOOD.encode())[:30] + b"spam" * 30, r"gzip is truncated or damaged"),
    "empty gz": (gzip.compress(b""), r"the file is empty"),
    "picture in gz": (gzip.compress(b"\x89PNG" + bytes(2000)), NO_TRACE),
    "binary": (bytes(range(256)) * 30, NO_TRACE),
    "jpeg-like": (b"\xff\xd8\xff\xe0" + bytes(1000), NO_TRACE),
    "parquet magic alone": (b"PAR1", r"Parquet file is truncated or damaged"),
    "html": (b"<!DOCTYPE html><html><body>time,velocity</body></html>", NO_TRACE),
    "json": (b'{"entries": 3}', NO_TRACE),
}


@pytest.mark.parametrize("case", FILES)
def test_bad_files(tmp_path, case):
    content, message = FILES[case]
    path = tmp_path / "run.csv"
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    with pytest.raises(InputError, match=message) as error:
        read(path)
    assert "\n" not in str(error.value) and str(error.value).startswith(str(path))
    assert error.value.exit_status == 2


def test_places_that_are_no_file(tmp_path):
    with pytest.raises(InputError, match="found a folder"):
        read(tmp_path)
    with pytest.raises(InputError, match="no such file"):
        read(tmp_path / "no.csv")
    with pytest.raises(InputError):
        read("a\0b.csv")
    with pytest.raises(InputError):
        read("/dev/null")


def test_blank_lines_do_not_shift_the_lines_of_messages(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("\n\n" + _rows(l8="6,-inf,6\n") + "\n\n")
    with pytest.raises(InputError, match="line 10, column"):
        read(path)
    path.write_text(_rows(l5="\n", l8="6,-inf,6\n"))
    with pytest.raises(InputError, match="sample 5, column"):  # a blank line among the samples: lines are unsure
        read(path)


@pytest.mark.parametrize(
    ("rows", "segments", "note"),
    [
        (ROWS[:2], 1, "only 2 samples"),
        (ROWS[:20] + ROWS[30:], 2, "1 hole, the longest 0.011 s; nothing is placed inside"),
    ],
)
def test_few_samples_and_a_hole_are_read_and_reported(tmp_path, rows, segments, note):
    path = tmp_path / "run.csv"
    path.write_text(HEAD + "".join(rows))
    trace = read(path)
    assert (len(trace), len(trace.segments), trace.notes) == (len(rows), segments, (note,))
    assert inspect_recording(read_recording(path), GivenOptions()).notes == trace.notes


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"velocity": "Axis9.Speed [deg/s]", "torque": "T [N*m]"}, r"'T \[N\*m\]': not in the file; found: time"),
        ({"speed": "velocity [deg/s]"}, r"columns: speed: not a signal.*; allowed: time, position"),
        ({"velocity": "velocity [N]"}, r"found unit 'N'"),
        ({"time": "time [kg]"}, r"found unit 'kg'"),
        ({"torque": "-spam"}, r"column 'spam': not in the file"),
    ],
)
def test_bad_columns(tmp_path, columns, message):
    path = tmp_path / "run.csv"
    path.write_text(GOOD)
    with pytest.raises(InputError, match=message):
        read(path, columns)


@pytest.mark.parametrize(
    ("time", "speed", "message"),
    [
        (pa.array([], pa.float64()), pa.array([], pa.float64()), "found columns and no rows"),
        (
            [0.0, 1.0, 2.0, 3.0],
            [1.0, None, None, None],
            r"'velocity \[rad/s\]': found 1 numbers; allowed: at least two",
        ),
        ([0.0, 1.0, 2.0], ["a", "b", "c"], r"'velocity \[rad/s\]': found string; allowed: numbers"),
    ],
)
def test_parquet_without_rows_or_numbers(tmp_path, time, speed, message):
    pq.write_table(pa.table({"time [s]": time, "velocity [rad/s]": speed}), tmp_path / "run.parquet")
    with pytest.raises(InputError, match=message):
        read(tmp_path / "run.parquet")


def test_damaged_mat_of_version_7_3_is_reported(tmp_path):
    path = tmp_path / "run.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512) + b"\x89HDF\r\n\x1a\n" + bytes(600))
    with pytest.raises(InputError, match=r"the HDF5 file is truncated or damaged"):
        read(path)


class Files(dict):
    """Files by format; hypothesis prints it with every failure, so it prints short."""

    def __repr__(self):
        return f"Files({', '.join(self)})"


@pytest.fixture(scope="module")
def files():
    """A good one of each format."""
    numbers = np.arange(60), np.arange(60.0) ** 2, np.arange(60.0)
    return Files({name: formats.content(name, *numbers) for name in WRITERS})


@pytest.mark.parametrize("name", WRITERS)
def test_the_files_are_good(files, tmp_path, name):
    path = tmp_path / "run"
    path.write_bytes(files[name])
    assert len(read(path, COLUMNS.get(name))) == 60


@pytest.mark.parametrize("name", ["gzip", "Parquet", "CODESYS trace", "CODESYS XML", "MAT", "BAM"])
@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
def test_truncated_files_are_reported_as_such(files, tmp_path, name, share):
    path = tmp_path / "run"
    path.write_bytes(files[name][: int(share * len(files[name]))])
    with pytest.raises(InputError, match=r"truncated"):
        read(path, COLUMNS.get(name))


def test_wrong_type_codes_in_a_mat_do_not_crash(files, tmp_path):
    """Read by scipy alone, several of these end the process."""
    good, path, refused = files["MAT"], tmp_path / "bad.mat", 0
    for at in [*range(128, 192, 2), *range(672, 736, 2)]:
        for code in (0, 1, 8, 19, 200):
            path.write_bytes(good[:at] + bytes([code]) + good[at + 1 :])
            try:
                read(path, COLUMNS["MAT"])
            except InputError:
                refused += 1
    assert refused > 50


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    name=st.sampled_from([name for name in WRITERS if name != "MDF4"]),  # which ends the process that reads it
    cut=st.floats(0.0, 1.0),
    edits=st.lists(st.tuples(st.floats(0.0, 1.0), st.binary(max_size=4)), max_size=4),
)
@example(name="CSV", cut=1.0, edits=[(0.5, b"1e400")])
@example(name="CSV", cut=1.0, edits=[(0.02, b'"')])
def test_damage_anywhere_gives_a_trace_or_an_input_error(files, tmp_path, name, cut, edits):
    damaged = bytearray(files[name][: int(cut * len(files[name]))])
    for place, new in edits:
        at = int(place * len(damaged))
        damaged[at : at + len(new)] = new
    path = tmp_path / "run"
    path.write_bytes(damaged)
    try:
        trace = read(path, COLUMNS.get(name))
    except InputError as error:
        assert "\n" not in str(error)
    else:
        write(trace, tmp_path / "again.parquet")


@pytest.mark.parametrize(
    "content",
    [
        "[]",
        "[3, 4]",
        '[{"timestamp": 0, "speed": 1}, 3]',
        '{"entries": [3, 4]}',
        '{"entries": [], "input_volts": 12}',
        '{"charts": [{"name": "gap", "panels": [{"x": 1.0}]}]}',
    ],
)
def test_a_log_whose_samples_are_no_records_is_refused_in_one_line(tmp_path, content):
    path = tmp_path / "log.json"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(InputError) as refused:
        read(path)
    assert str(path) in str(refused.value) and "\n" not in str(refused.value)
