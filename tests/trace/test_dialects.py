"""Tables as recorders lay them out, written here: the numbers written are the numbers read."""

import itertools

import numpy as np
import pytest

from bench.errors import InputError
from bench.trace.choose import GivenOptions
from bench.trace.read import read, read_recording
from bench.trace.readers.table import find_layout, read_timed

SAMPLES = 600
TIME = np.arange(SAMPLES) * 1e-3
SPEED = np.round(1500.0 * np.sin(2 * np.pi * 1.7 * TIME), 3)
AMPS = np.round(2.0 * np.cos(2 * np.pi * 1.7 * TIME), 5)
NAMES = "time [ms]", "velocity [rpm]", "current [A]"
HEAD = ",".join(NAMES)


def lines(separator=",", mark=".", time=None, quoted=False):
    """A line of samples for each: times, speeds and currents."""
    times = [f"{1e3 * t:.3f}".replace(".", mark) for t in TIME] if time is None else time
    for when, speed, amps in zip(times, SPEED, AMPS, strict=True):
        cells = [when, f"{speed:.3f}".replace(".", mark), f"{amps:.5f}".replace(".", mark)]
        yield separator.join(f'"{cell}"' if quoted else cell for cell in cells)


def written(path, text, encoding="utf-8", newline="\n"):
    path.write_bytes(newline.join([*text, ""]).encode(encoding))
    return path


@pytest.fixture
def table(tmp_path):
    """Writes lines, of the usual header where they have none of their own."""
    return lambda rows, head=HEAD: written(tmp_path / "run.csv", [head, *rows])


def holds(trace):
    np.testing.assert_allclose(trace.time - trace.time[0], TIME, atol=2e-9)
    np.testing.assert_allclose(trace["velocity"], SPEED * np.pi / 30.0, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(trace["current"], AMPS, rtol=1e-12, atol=1e-12)


SEPARATORS = [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), (" ", "."), ("   ", ",")]
PREAMBLES = {
    "none": [],
    "comments": ["# Recorder 3", "# at 1,5 kHz", "#"],
    "vendor": ["Workbench 2.5", "Drive;S300;3", "Serial, 123, 456, 789", "Sample period: 1 ms", ""],
    "numbers": ["Version 1.2.3", "12;7", "1 2 3 4 5", ""],
}


@pytest.mark.parametrize(("separator", "mark"), SEPARATORS)
@pytest.mark.parametrize(
    ("preamble", "newline"), [("none", "\r\n"), ("comments", "\n"), ("vendor", "\r\n"), ("numbers", "\n")]
)
def test_every_separator_behind_every_preamble(tmp_path, separator, mark, preamble, newline):
    text = [*PREAMBLES[preamble], separator.join(NAMES), *lines(separator, mark)]
    holds(read(written(tmp_path / "run.txt", text, newline=newline)))


@pytest.mark.parametrize(("separator", "mark"), SEPARATORS)
@pytest.mark.parametrize("brackets", ["{}", "[{}]", "({})"])
def test_a_row_of_units_under_the_names(table, separator, mark, brackets):
    units = separator.join(brackets.format(unit) for unit in ("ms", "rpm", "A"))
    names = separator.join(("Time", "Velocity", "Current"))
    holds(read(table([units, *lines(separator, mark)], names)))


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "utf-16", "utf-32", "utf-8-sig"])
def test_encodings(tmp_path, encoding):
    text = ["Prüfstand für Größen", "time [ms];Drehzahl geglättet [1/min];current [A]", *lines(";", ",")]
    holds(read(written(tmp_path / "run.csv", text, encoding), {"velocity": "Drehzahl geglättet [1/min]"}))


def grouped(group, mark=","):
    """Speeds with a mark between thousands."""
    for t, speed, amps in zip(TIME, SPEED, AMPS, strict=True):
        row = f"{1e3 * t:.3f};{speed:,.3f};{amps:.5f}"
        yield row.replace(".", "#").replace(",", group).replace("#", mark)


def paired(shift):
    """Each signal behind times of its own."""
    return [f"{t:.6f},{speed:.3f},{t + shift:.6f},{amps:.5f}" for t, speed, amps in zip(TIME, SPEED, AMPS, strict=True)]


def labelled(form, at=str):
    """Labels in every line, the time as `at` has it."""
    return [form.format(at(ms), *others) for ms, *others in (row.split(",") for row in lines())]


ROWS = list(lines())
COMMAS = list(lines(";", ","))
#: Columns of a rig.
SECOND = {"velocity": "column 2 [rpm]", "current": "column 3 [A]"}
PAIRED = {"velocity": "column 2 [rpm]", "current": "column 4 [A]"}
#: Lines of a file, and the columns of its rig.
DIALECTS = {
    **{f"a header behind {marker}": ([marker + HEAD, *ROWS], {}) for marker in ("# ", "#", "% ", "// ")},
    **{f"thousands by {g!r}": ([";".join(NAMES), *grouped(g)], {}) for g in (".", "'", "\u202f", "\u00a0")},
    "thousands by a comma": ([";".join(NAMES), *grouped(",", ".")], {}),
    "no header": (list(lines("\t")), {"time": "column 1 [ms]", **SECOND}),
    "an index without a name": (
        [";" + ";".join(NAMES) + ";", *(f"{k};{row};" for k, row in enumerate(lines(";")))],
        {},
    ),
    "quoted decimal commas": (['"' + '","'.join(NAMES) + '"', *lines(",", ",", quoted=True)], {}),
    "elements of arrays": (
        ["t [ms],w[0],i[0],w[1]", *(f"{row},{k}" for k, row in enumerate(ROWS))],
        {"velocity": "w[0] [rpm]", "current": "i[0] [A]"},
    ),
    "blank lines, comments, an end": ([HEAD, *ROWS[:100], "# trigger", "", *ROWS[100:], "End of data", "   "], {}),
    "Keysight": (["x-axis,1,2", "msec,Volt,Volt", *ROWS], {"time": "x-axis", **SECOND}),
    "Tektronix": (["Model,TBS2000", "Waveform Type,ANALOG", "Label,,", "TIME (ms),CH1,CH2", *ROWS], SECOND),
    "Siglent": (["Record Length,7000", "Source,CH1,CH2", "Millisecond,Volt,Volt", *ROWS], {"time": "Source", **SECOND}),
    "PicoScope": (["Time,Channel A,Channel B", "(ms),(V),(mV)", "", *ROWS], SECOND),
    "separator at the end": (["Time(ms),CH1(V),CH2(V),", *(f"{row}," for row in ROWS)], SECOND),
    "DIN": (["t / ms;n / min^-1;i / A", *COMMAS], {"velocity": "n / min^-1", "current": "i / A"}),
    "in": (["Zeit in ms;Drehzahl in 1/min;Strom in A", *COMMAS], {"velocity": "Drehzahl in 1/min"}),
    "quoted names": (
        ['"time, t [ms]","velocity, filtered [rpm]","current [A]"', *ROWS],
        {"time": "column 1", **SECOND},
    ),
    "a summary": ([HEAD, *ROWS, "Mean,0.1,0.2", "Max,3,1", ""], {}),
    "a long header": ([*(f"# line {k}: gain = {k}" for k in range(9000)), *["meta" * 400] * 200, HEAD, *ROWS], {}),
    "started again": (["Recorder 7", HEAD, *ROWS[:300], "Recorder 7", HEAD, *ROWS[300:]], {}),
    "times of their own, equal": (["Time [s],CH1,Time [s],CH2", *paired(0.0)], PAIRED),
    "X,Y,X,Y": (["X,Y,X,Y", *paired(0.0)], {"time": "X [s]", **PAIRED}),
    "labels": (labelled("t[ms]:{} speed[rpm]:{}\tiq[A]:{}"), {"time": "t", "velocity": "speed"}),
    "pairs with units": (labelled("time={} ms, w={} rpm, i={}A"), {"velocity": "w", "current": "i"}),
    **{
        f"labels of a log, {front}": (labelled(front + " w: {} rpm i: {} A"), {"velocity": "w", "current": "i"})
        for front in ("[{} ms]", "{} ms INFO drive:", "I ({} ms) motor_1:", "INFO: {} ms |")
    },
    "labels after a clock": (
        labelled("2026-11-29 10:00:{:06.3f} [INFO] drive - w: {} rpm i: {} A", at=lambda ms: float(ms) / 1e3),
        {"velocity": "w", "current": "i"},
    ),
    "two columns of a name": (
        ["time [ms],velocity [rpm],velocity [rpm],current [A]", *(row.replace(",", ",7,", 1) for row in ROWS)],
        {"velocity": "column 3 [rpm]"},
    ),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_dialects_of_recorders(tmp_path, dialect):
    text, columns = DIALECTS[dialect]
    holds(read(written(tmp_path / "run.csv", text), columns))


@pytest.mark.parametrize("column", [1, 2])
@pytest.mark.parametrize("part", [slice(None), slice(300), slice(300, None)], ids=["all", "first half", "second half"])
def test_decimal_points_among_decimal_commas(table, column, part):
    """In a column of a file with decimal commas, or in half of it: three digits behind a mark are no thousands."""
    rows = [row.split(";") for row in COMMAS]
    for row in rows[part]:
        row[column] = row[column].replace(",", ".")
    holds(read(table(map(";".join, rows), ";".join(NAMES))))


EITHER = [f"{k};{12 + k / 1000:.3f};{k}" for k in range(SAMPLES)]
#: Header, lines, and the words of the refusal.
REFUSED = {
    "12,345 next to 12.345": (
        ";".join(NAMES),
        [*EITHER[:400], *(row.replace(".", ",") for row in EITHER[400:])],
        "found decimal commas and decimal points in the column 'velocity'",
    ),
    "decimal commas between commas": (
        HEAD,
        [f"{k},5,3,5,{k},25" for k in range(SAMPLES)],
        "line 2: found 6 cells under 3 names: numbers with decimal commas",
    ),
    "and whole numbers": (HEAD, [f"{k},5,3,{k},25" for k in range(SAMPLES)], "line 2: found 5 cells under 3 names"),
    "no columns": (
        "This is a log",
        ["of 12 things", "and nothing else 3"],
        "line 3: found no columns of numbers: 'and nothing else 3'",
    ),
}


@pytest.mark.parametrize("fault", REFUSED)
def test_what_is_refused_is_named_with_its_place(table, fault):
    head, rows, words = REFUSED[fault]
    with pytest.raises(InputError, match=words):
        read(table(rows, head))


@pytest.mark.parametrize("stamp", ["2024-02-28T23:59:{:06.3f}Z", "23:59:{:06.3f}", "11:59:{:06.3f} PM"])
def test_moments_need_no_unit_and_no_rig_gives_them_one(table, stamp):
    path = table(lines(";", time=[stamp.format(10.0 + t) for t in TIME]), "stamp;velocity [rpm];current [A]")
    for column in ("stamp", "stamp [ms]"):
        holds(read(path, {"time": column}))


def test_a_clock_of_whole_seconds_asks_for_the_sample_period_and_takes_it(table):
    path = table(lines(time=[f"12:34:{int(2.0 * t):02d}" for t in TIME]), "time,velocity [rpm],current [A]")
    with pytest.raises(InputError, match=r"the time of another one.*sample_period"):
        read(path)
    trace = read(path, GivenOptions(sample_period=2e-3))
    np.testing.assert_allclose(trace.time - trace.time[0], 2.0 * TIME, atol=1e-9)
    with pytest.raises(InputError, match=r"steps by 0\.00.* where the rig's \[trace\] has sample_period = 0\.02 s"):
        read(path, GivenOptions(sample_period=20e-3))


@pytest.mark.parametrize("unit", ["ns", "s"])
def test_epochs_keep_digits_that_no_float_holds(table, unit):
    stamps = [1_709_642_096_789_000_000 + 62_500 * k for k in range(SAMPLES)]
    time = [str(t) if unit == "ns" else f"{t // 10**9}.{t % 10**9:09d}" for t in stamps]
    trace = read(table(lines(time=time), f"stamp [{unit}],velocity [rpm],current [A]"), {"time": "stamp"})
    assert trace.time_base is not None and not trace.time_base.resampled
    np.testing.assert_allclose(np.diff(trace.time), 62.5e-6, rtol=1e-9)


@pytest.mark.parametrize(("name", "step"), [("Sample", 1), ("index", 10), ("time", 1)])
def test_a_sample_index_and_a_period(table, name, step):
    rows = list(lines(time=[str(7 + step * k) for k in range(SAMPLES)]))
    head = f"{name},velocity [rpm],current [A]"
    with pytest.raises(InputError, match="time"):
        read(table(rows, head))
    holds(read(table(rows, head), GivenOptions(sample_period=1e-3)))
    lost = table([*rows[:100], *rows[110:]], head)
    assert len(read(lost, GivenOptions(sample_period=1e-3)).segments) == 2


def test_no_time_at_all_and_a_period(table):
    path = table((row.split(",", 1)[1] for row in ROWS), "velocity [rpm],current [A]")
    with pytest.raises(InputError, match=r'`\[trace\] sample_period = "1 ms"`'):
        read(path)
    holds(read(path, GivenOptions(sample_period=1e-3)))


@pytest.mark.parametrize("nothing", ["", "NaN", "nan", "-", "NULL", "#N/A"])
def test_a_few_cells_without_a_number_are_a_hole_each(table, nothing):
    rows = [row.split(",") for row in ROWS]
    for k, cell in ((50, 1), (200, 2), (400, 1)):
        rows[k][cell] = nothing
    trace = read(table(map(",".join, rows)))
    assert len(trace) == SAMPLES - 3 and len(trace.segments) == 4
    assert trace.time_base is not None
    assert [hole[0] for hole in trace.time_base.holes] == pytest.approx([0.049, 0.199, 0.399])
    known = np.delete(np.arange(SAMPLES), [50, 200, 400])
    np.testing.assert_allclose(trace["velocity"], SPEED[known] * np.pi / 30.0, atol=1e-12)
    assert any("line 52, column 'velocity [rpm]': a hole each" in note for note in trace.notes)


def test_what_is_not_needed_stops_nothing_and_is_reported(table):
    head = f"{HEAD},position,voltage [bananas],state,acceleration,spare [V]"
    trace = read(table((f"{row},{k % 7},1,RUN,nan,1" for k, row in enumerate(ROWS)), head))
    holds(trace)
    assert set(trace.signals) == {"velocity", "current"}
    dropped = "position, voltage [bananas], state, acceleration, spare [V]"
    assert trace.metadata["dropped_columns"] == dropped
    for word in ("position left out", "has no unit", "bananas", "acceleration left out"):
        assert any(word in note for note in trace.notes), word


def test_comments_are_counted(table):
    assert any("1 comment left out" in note for note in read(table([*ROWS[:100], "# trigger", *ROWS[100:]])).notes)


@pytest.mark.parametrize(("other", "factor"), [("speed [rad/s]", np.pi / 30.0), ("ActVel [rpm]", 1.0)])
@pytest.mark.parametrize("first", [True, False])
def test_two_names_of_one_signal_are_asked_about_where_they_differ(table, other, factor, first):
    """Whichever comes first in the file."""
    for scale in (1.0, 1.5):
        pairs = [(row, repr(float(row.split(",")[1]) * factor * scale)) for row in ROWS]
        rows = [f"{more},{row}" if first else f"{row},{more}" for row, more in pairs]
        path = table(rows, f"{other},{HEAD}" if first else f"{HEAD},{other}")
        if scale == 1.0:
            np.testing.assert_allclose(read(path)["velocity"], SPEED * np.pi / 30.0, rtol=1e-9, atol=1e-12)
        else:
            with pytest.raises(InputError, match="velocity: found several columns"):
                read(path)


def wrapping(period, counts):
    """A position that goes there and back, and wrapped by a period, in counts."""
    true = 0.48 * np.cumsum(np.sin(2 * np.pi * TIME / TIME[-1]))
    return true, np.mod(np.rint(true / period * counts) + 100, counts) if counts else np.mod(true, period)


@pytest.mark.parametrize(
    ("period", "counts", "unit"),
    [(2 * np.pi, 0, "rad"), (2 * np.pi, 4096, "turn/4096"), (4 * np.pi, 65536, "turn/32768")],
)
def test_a_plain_wrap_is_found(table, period, counts, unit):
    true, wrapped = wrapping(period, counts)
    rows = (f"{row},{value!r}" for row, value in zip(ROWS, wrapped.tolist(), strict=True))
    trace = read(table(rows, f"{HEAD},position [{unit}]"))
    shift = trace["position"] - true
    np.testing.assert_allclose(shift, shift[0], atol=2.0 * period / (counts or 1e12))
    assert any("position wraps" in note for note in trace.notes)


def test_a_wrap_by_another_period_is_found_as_it_comes_and_exactly_where_it_is_reported(table):
    true, wrapped = wrapping(5.0, 0)
    rows = (f"{row},{value!r}" for row, value in zip(ROWS, wrapped.tolist(), strict=True))
    path = table(rows, f"{HEAD},position [rad]")
    found = read(path)
    assert found.wraps is not None
    assert found.wraps.period == pytest.approx(5.0, rel=1e-2)
    np.testing.assert_allclose(np.diff(found["position"]), np.diff(true), atol=0.05)
    trace = read(path, GivenOptions(position_period=5.0))
    np.testing.assert_allclose(np.diff(trace["position"]), np.diff(true), atol=1e-9)


def test_axes_by_the_first_part_of_their_names(table):
    names = [f"Axis{k}.{name}" for k, name in itertools.product((1, 2), ("ActVel [rpm]", "Iq [A]"))]
    path = table((f"{row},0.0,0.0" for row in ROWS), ",".join(("time [ms]", *names)))
    with pytest.raises(InputError, match=r"found 2 axes \(Axis1, Axis2\); pick one: `--axis Axis1`"):
        read(path)
    holds(read(path, GivenOptions(axis="Axis1")))


def test_signals_with_times_of_their_own(table):
    recording = read_recording(table(paired(0.5e-3), "X,Y,X,Y"))
    assert recording.notes == ("times taken as s, as the file has no unit",)
    for channel, values, shift in zip(recording.channels, (SPEED, AMPS), (0.0, 0.5e-3), strict=True):
        assert channel.time is not None and channel.time.unit == "s"
        np.testing.assert_allclose(channel.time.values, TIME + shift, atol=1e-9)
        np.testing.assert_array_equal(channel.values, values)


def test_timed_lines_need_a_column_of_time():
    with pytest.raises(InputError, match=r"x\.log: found columns speed \[rpm\]; allowed: one of them called time"):
        read_timed(["1", "2"], 1, ["speed [rpm]"], ";", "x.log")


def test_lines_whose_width_is_the_same_in_less_than_half_of_them_are_no_table():
    widths = [",".join("1" * count) for count in (2, 2, 3, 4, 5)]
    assert find_layout(widths) is None
    assert find_layout([*widths, "1,1"]) is not None
