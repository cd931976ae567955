"""Tables as recorders lay them out, written here: the numbers written are the numbers read."""

import itertools

import numpy as np
import pytest

from bench.errors import InputError
from bench.trace.choose import GivenOptions
from bench.trace.read import read, read_recording

SAMPLES = 600
TIME = np.arange(SAMPLES) * 1e-3
SPEED = np.round(1500.0 * np.sin(2 * np.pi * 1.7 * TIME), 3)
AMPS = np.round(2.0 * np.cos(2 * np.pi * 1.7 * TIME), 5)
NAMES = "time [ms]", "velocity [rpm]", "current [A]"


def lines(separator=",", mark=".", time=None, quoted=False):
    """A line of samples for each: times, speeds and currents."""
    times = [f"{1e3 * t:.3f}" for t in TIME] if time is None else time
    for when, speed, amps in zip(times, SPEED, AMPS, strict=True):
        cells = [when, f"{speed:.3f}", f"{amps:.5f}"]
        cells = [
            cells[0] if time is not None else cells[0].replace(".", mark),
            *(cell.replace(".", mark) for cell in cells[1:]),
        ]
        yield separator.join(f'"{cell}"' if quoted else cell for cell in cells)


def written(path, head, rows, encoding="utf-8", newline="\n"):
    path.write_bytes(newline.join([*head, *rows, ""]).encode(encoding))
    return path


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
@pytest.mark.parametrize("preamble", PREAMBLES)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_every_separator_behind_every_preamble(tmp_path, separator, mark, preamble, newline):
    head = [*PREAMBLES[preamble], separator.join(NAMES)]
    holds(read(written(tmp_path / "run.txt", head, lines(separator, mark), newline=newline)))


@pytest.mark.parametrize(("separator", "mark"), SEPARATORS)
@pytest.mark.parametrize("brackets", ["{}", "[{}]", "({})"])
def test_a_row_of_units_under_the_names(tmp_path, separator, mark, brackets):
    units = separator.join(brackets.format(unit) for unit in ("ms", "rpm", "A"))
    head = [separator.join(("Time", "Velocity", "Current")), units]
    holds(read(written(tmp_path / "run.csv", head, lines(separator, mark))))


@pytest.mark.parametrize("marker", ["# ", "#", "% ", "// "])
def test_a_header_in_a_comment(tmp_path, marker):
    holds(read(written(tmp_path / "run.csv", [marker + ",".join(NAMES)], lines())))


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252", "utf-16", "utf-8-sig"])
def test_encodings(tmp_path, encoding):
    head = ["Prüfstand für Größen", "time [ms];Drehzahl geglättet [1/min];current [A]"]
    path = written(tmp_path / "run.csv", head, lines(";", ","), encoding)
    holds(read(path, {"velocity": "Drehzahl geglättet [1/min]"}))


def test_no_header_names_columns_by_their_number(tmp_path):
    path = written(tmp_path / "run.txt", [], lines("\t"))
    holds(read(path, {"time": "column 1 [ms]", "velocity": "column 2 [rpm]", "current": "column 3 [A]"}))
    with pytest.raises(InputError, match="position or velocity: not in the file; found: column 1, column 2, column 3"):
        read(path)


def test_an_index_without_a_name_and_a_separator_at_the_end(tmp_path):
    rows = [f"{k};{row};" for k, row in enumerate(lines(";"))]
    holds(read(written(tmp_path / "run.csv", [";" + ";".join(NAMES) + ";"], rows)))


def test_quotes_around_decimal_commas_between_commas(tmp_path):
    head = ['"' + '","'.join(NAMES) + '"']
    holds(read(written(tmp_path / "run.csv", head, lines(",", ",", quoted=True))))


@pytest.mark.parametrize("group", [".", "'", "\u202f", "\u00a0"])
def test_marks_between_thousands(tmp_path, group):
    rows = [
        f"{1e3 * t:.3f};{speed:,.3f};{amps:.5f}".replace(".", "#").replace(",", group).replace("#", ",")
        for t, speed, amps in zip(TIME, SPEED, AMPS, strict=True)
    ]
    holds(read(written(tmp_path / "run.csv", [";".join(NAMES)], rows)))


def test_thousands_with_commas_and_decimal_points(tmp_path):
    rows = [f"{1e3 * t:.3f};{speed:,.3f};{amps:.5f}" for t, speed, amps in zip(TIME, SPEED, AMPS, strict=True)]
    holds(read(written(tmp_path / "run.csv", [";".join(NAMES)], rows)))


@pytest.mark.parametrize("column", [1, 2])
@pytest.mark.parametrize("part", [slice(None), slice(300), slice(300, None)], ids=["all", "first half", "second half"])
def test_decimal_points_among_decimal_commas(tmp_path, column, part):
    """In a column of a file with decimal commas, or in half of it: three digits behind a mark are no thousands."""
    rows = [row.split(";") for row in lines(";", ",")]
    for row in rows[part]:
        row[column] = row[column].replace(",", ".")
    holds(read(written(tmp_path / "run.csv", [";".join(NAMES)], map(";".join, rows))))


def test_marks_that_may_be_either_are_refused(tmp_path):
    """12,345 next to 12.345, without a number that tells whether 12,345 is twelve thousand."""
    rows = [f"{k};{12 + k / 1000:.3f};{k}" for k in range(SAMPLES)]
    rows[400:] = [row.replace(".", ",") for row in rows[400:]]
    with pytest.raises(InputError, match=r"found decimal commas and decimal points in the column 'velocity'"):
        read(written(tmp_path / "run.csv", [";".join(NAMES)], rows))


@pytest.mark.parametrize("whole", [False, True])
def test_decimal_commas_between_commas_are_refused(tmp_path, whole):
    rows = [f"{k},5,{'3' if whole else '3,5'},{k},25" for k in range(SAMPLES)]
    with pytest.raises(InputError, match=r"line 2: found [56] cells under 3 names: numbers with decimal commas"):
        read(written(tmp_path / "run.csv", [",".join(NAMES)], rows))


def clock(seconds, style):
    whole, milli = divmod(round(seconds * 1e3), 1000)
    hours, rest = divmod(whole, 3600)
    minutes, second = divmod(rest, 60)
    days, hour = divmod(hours, 24)
    twelve, half = (hour - 1) % 12 + 1, "AM" if hour < 12 else "PM"
    return style.format(
        d=28 + days, h=hour, m=minutes, s=second, f=f"{milli:03d}", mm=60 * hour + minutes, twelve=twelve, half=half
    )


CLOCKS = {
    "clock": "{h:02d}:{m:02d}:{s:02d}.{f}",
    "clock with comma": "{h:02d}:{m:02d}:{s:02d},{f}",
    "clock with colons": "{h:02d}:{m:02d}:{s:02d}:{f}",
    "twelve hours": "{twelve}:{m:02d}:{s:02d}.{f} {half}",
    "ISO": "2024-02-{d}T{h:02d}:{m:02d}:{s:02d}.{f}Z",
    "ISO with zone": "2024-02-{d} {h:02d}:{m:02d}:{s:02d}.{f}000+01:00",
    "German": "{d}.02.2024 {h:02d}:{m:02d}:{s:02d},{f}",
    "American": "2/{d}/2024 {twelve}:{m:02d}:{s:02d}.{f} {half}",
}


@pytest.mark.parametrize("style", CLOCKS)
@pytest.mark.parametrize("start", [45_296.0, 86_399.7])  # at noon, and over midnight
def test_clocks_and_calendars(tmp_path, style, start):
    rows = lines(";", time=[clock(start + t, CLOCKS[style]) for t in TIME])
    path = written(tmp_path / "run.csv", ["stamp;velocity [rpm];current [A]"], rows)
    holds(read(path, {"time": "stamp"}))
    holds(read(path, {"time": "stamp [ms]"}))  # moments tell their unit


def test_a_clock_of_whole_seconds_asks_for_the_sample_period_and_takes_it(tmp_path):
    rows = lines(",", time=[clock(45_296.0 + 2.0 * t, "{h:02d}:{m:02d}:{s:02d}") for t in TIME])
    path = written(tmp_path / "run.csv", ["time,velocity [rpm],current [A]"], rows)
    with pytest.raises(InputError, match=r"the time of another one.*sample_period"):
        read(path)
    trace = read(path, GivenOptions(sample_period=2e-3))
    np.testing.assert_allclose(trace.time - trace.time[0], 2.0 * TIME, atol=1e-9)
    with pytest.raises(InputError, match=r"steps by 0\.00.* where the rig's \[trace\] has sample_period = 0\.02 s"):
        read(path, GivenOptions(sample_period=20e-3))


def test_epochs_keep_digits_that_no_float_holds(tmp_path):
    for number, style in (("ns", "{:.0f}"), ("s", "{}")):
        stamps = [1_709_642_096_789_000_000 + 62_500 * k for k in range(SAMPLES)]
        time = [style.format(t) if number == "ns" else f"{t // 10**9}.{t % 10**9:09d}" for t in stamps]
        time = [str(t) for t in stamps] if number == "ns" else time
        path = written(tmp_path / "run.csv", [f"stamp [{number}],velocity [rpm],current [A]"], lines(time=time))
        trace = read(path, {"time": "stamp"})
        assert trace.time_base is not None and not trace.time_base.resampled
        np.testing.assert_allclose(np.diff(trace.time), 62.5e-6, rtol=1e-9)


@pytest.mark.parametrize("names", [("Sample", 1), ("index", 10), ("time", 1)])
def test_a_sample_index_and_a_period(tmp_path, names):
    name, step = names
    rows = lines(time=[str(7 + step * k) for k in range(SAMPLES)])
    path = written(tmp_path / "run.csv", [f"{name},velocity [rpm],current [A]"], rows)
    with pytest.raises(InputError, match="time"):
        read(path)
    holds(read(path, GivenOptions(sample_period=1e-3)))
    lost = [row for k, row in enumerate(path.read_text().splitlines()) if k not in range(100, 110)]
    path.write_text("\n".join(lost))
    assert len(read(path, GivenOptions(sample_period=1e-3)).segments) == 2


def test_no_time_at_all_and_a_period(tmp_path):
    rows = [row.split(",", 1)[1] for row in lines()]
    path = written(tmp_path / "run.csv", ["velocity [rpm],current [A]"], rows)
    with pytest.raises(InputError, match=r'`\[trace\] sample_period = "1 ms"`'):
        read(path)
    holds(read(path, GivenOptions(sample_period=1e-3)))


@pytest.mark.parametrize("nothing", ["", "NaN", "nan", "-", "NULL", "#N/A"])
def test_a_few_cells_without_a_number_are_a_hole_each(tmp_path, nothing):
    rows = list(lines())
    for k, cell in ((50, 1), (200, 2), (400, 1)):
        cells = rows[k].split(",")
        cells[cell] = nothing
        rows[k] = ",".join(cells)
    trace = read(written(tmp_path / "run.csv", [",".join(NAMES)], rows))
    assert len(trace) == SAMPLES - 3 and len(trace.segments) == 4
    assert trace.time_base is not None
    assert [hole[0] for hole in trace.time_base.holes] == pytest.approx([0.049, 0.199, 0.399])
    known = np.delete(np.arange(SAMPLES), [50, 200, 400])
    np.testing.assert_allclose(trace["velocity"], SPEED[known] * np.pi / 30.0, atol=1e-12)
    assert any("line 52, column 'velocity [rpm]': a hole each" in note for note in trace.notes)


def test_a_column_of_which_most_cells_are_empty_was_sampled_more_slowly(tmp_path):
    rows = [f"{row},{k / 10 if k % 10 == 0 else ''}" for k, row in enumerate(lines())]
    trace = read(written(tmp_path / "run.csv", [",".join((*NAMES, "position [rad]"))], rows))
    np.testing.assert_allclose(trace["position"], np.arange(trace.time.size) / 10, atol=1e-9)
    assert any("position is given in 60 of 600 rows" in note for note in trace.notes)


def test_what_is_not_needed_stops_nothing_and_is_reported(tmp_path):
    head = [",".join((*NAMES, "position", "voltage [bananas]", "state", "acceleration"))]
    rows = [f"{row},{k % 7},1,RUN,nan" for k, row in enumerate(lines())]
    trace = read(written(tmp_path / "run.csv", head, rows))
    holds(trace)
    assert set(trace.signals) == {"velocity", "current"}
    for word in ("position left out", "has no unit", "bananas", "acceleration left out"):
        assert any(word in note for note in trace.notes), word


def test_blank_lines_comments_and_what_stands_below_are_left_out(tmp_path):
    rows = list(lines())
    rows[100:100] = ["# trigger", ""]
    path = written(tmp_path / "run.csv", [",".join(NAMES)], [*rows, "End of data", "   "])
    trace = read(path)
    holds(trace)
    assert any("1 comment left out" in note for note in trace.notes)


@pytest.mark.parametrize("fault", ["12,3", "12,3,4,5", "12,abc,4"])
def test_a_line_that_is_no_sample_is_named(tmp_path, fault):
    rows = list(lines())
    rows[300] = fault
    with pytest.raises(InputError, match="line 302"):
        read(written(tmp_path / "run.csv", [",".join(NAMES)], rows))


def test_two_columns_of_one_name_are_asked_about(tmp_path):
    rows = [f"{row},1.0" for row in lines()]
    with pytest.raises(InputError, match="velocity: found several columns"):
        read(written(tmp_path / "run.csv", [",".join((*NAMES, "velocity [rpm]"))], rows))


@pytest.mark.parametrize("beside", ["speed [rad/s]", "ActVel [rpm]"])
def test_two_names_of_one_signal_are_asked_about_where_they_differ(tmp_path, beside):
    """Whichever comes first in the file."""
    factor = np.pi / 30.0 if "rad" in beside else 1.0
    for scale, expected in ((1.0, None), (1.5, "velocity: found several columns")):
        second = [repr(float(row.split(",")[1]) * factor * scale) for row in lines()]
        for names, rows in (
            ((*NAMES, beside), [f"{row},{more}" for row, more in zip(lines(), second, strict=True)]),
            ((beside, *NAMES), [f"{more},{row}" for row, more in zip(lines(), second, strict=True)]),
        ):
            path = written(tmp_path / "run.csv", [",".join(names)], rows)
            if expected is None:
                assert np.std(read(path)["velocity"]) > 0.0
            else:
                with pytest.raises(InputError, match=expected):
                    read(path)


def wrapping(period, counts, speed=40.0):
    """A position that goes there and back, wrapped by a period, in counts."""
    true = speed * np.cumsum(np.sin(2 * np.pi * TIME / TIME[-1])) * 1e-3 * 12.0
    steps = np.rint(true / period * counts) if counts else true
    return true, np.mod(steps + 100, counts) if counts else np.mod(true, period)


@pytest.mark.parametrize(
    ("period", "counts", "unit"),
    [(2 * np.pi, 0, "rad"), (2 * np.pi, 4096, "turn/4096"), (4 * np.pi, 65536, "turn/32768")],
)
def test_a_plain_wrap_is_found(tmp_path, period, counts, unit):
    true, wrapped = wrapping(period, counts)
    rows = [f"{row},{value!r}" for row, value in zip(lines(), wrapped.tolist(), strict=True)]
    trace = read(written(tmp_path / "run.csv", [",".join((*NAMES, f"position [{unit}]"))], rows))
    shift = trace["position"] - true
    np.testing.assert_allclose(shift, shift[0], atol=2.0 * period / (counts or 1e12))
    assert any("position wraps" in note for note in trace.notes)


def test_a_wrap_by_another_period_is_found_as_it_comes_and_exactly_where_it_is_reported(tmp_path):
    true, wrapped = wrapping(5.0, 0)
    rows = [f"{row},{value!r}" for row, value in zip(lines(), wrapped.tolist(), strict=True)]
    path = written(tmp_path / "run.csv", [",".join((*NAMES, "position [rad]"))], rows)
    found = read(path)
    assert found.wraps is not None
    assert found.wraps.period == pytest.approx(5.0, rel=1e-2)
    np.testing.assert_allclose(np.diff(found["position"]), np.diff(true), atol=0.05)
    trace = read(path, GivenOptions(position_period=5.0))
    np.testing.assert_allclose(np.diff(trace["position"]), np.diff(true), atol=1e-9)


def test_an_element_of_an_array_is_a_name(tmp_path):
    rows = [f"{row},{k}" for k, row in enumerate(lines())]
    path = written(tmp_path / "run.csv", ["t [ms],w[0],i[0],w[1]"], rows)
    assert [channel.name for channel in read_recording(path).channels] == ["t", "w[0]", "i[0]", "w[1]"]
    holds(read(path, {"velocity": "w[0] [rpm]", "current": "i[0] [A]"}))


def test_axes_by_the_first_part_of_their_names(tmp_path):
    names = [f"Axis{k}.{name}" for k, name in itertools.product((1, 2), ("ActVel [rpm]", "Iq [A]"))]
    rows = [f"{row},0.0,0.0" for row in lines()]
    path = written(tmp_path / "run.csv", [",".join(("time [ms]", *names))], rows)
    with pytest.raises(InputError, match=r"found 2 axes \(Axis1, Axis2\); pick one: `--axis Axis1`"):
        read(path)
    holds(read(path, GivenOptions(axis="Axis1")))


def three(mark=".", separator=","):
    return list(lines(separator, mark))


def paired(shift):
    """Each signal behind times of its own."""
    return [f"{t:.6f},{speed:.3f},{t + shift:.6f},{amps:.5f}" for t, speed, amps in zip(TIME, SPEED, AMPS, strict=True)]


#: Lines of a file, and the columns of its rig.
MAPPED = {"velocity": "column 2 [rpm]", "current": "column 3 [A]"}
PAIRED = {"velocity": "column 2 [rpm]", "current": "column 4 [A]"}
DIALECTS = {
    "Keysight": (["x-axis,1,2", "msec,Volt,Volt", *three()], {"time": "x-axis", **MAPPED}),
    "Tektronix": (["Model,TBS2000", "Waveform Type,ANALOG", "Label,,", "TIME (ms),CH1,CH2", *three()], MAPPED),
    "Siglent": (
        ["Record Length,7000", "Source,CH1,CH2", "Millisecond,Volt,Volt", *three()],
        {"time": "Source", **MAPPED},
    ),
    "PicoScope": (["Time,Channel A,Channel B", "(ms),(V),(mV)", "", *three()], MAPPED),
    "separator at the end": (["Time(ms),CH1(V),CH2(V),", *(f"{row}," for row in three())], MAPPED),
    "DIN": (["t / ms;n / min^-1;i / A", *three(",", ";")], {"velocity": "n / min^-1", "current": "i / A"}),
    "in": (["Zeit in ms;Drehzahl in 1/min;Strom in A", *three(",", ";")], {"velocity": "Drehzahl in 1/min"}),
    "quoted names": (
        ['"time, t [ms]","velocity, filtered [rpm]","current [A]"', *three()],
        {"time": "column 1", **MAPPED},
    ),
    "a summary": (["time [ms],velocity [rpm],current [A]", *three(), "Mean,0.1,0.2", "Max,3,1", ""], {}),
    "a long header": (
        [*(f"# line {k}: gain = {k}" for k in range(9000)), *["meta" * 400] * 200, ",".join(NAMES), *three()],
        {},
    ),
    "started again": (
        ["Recorder 7", ",".join(NAMES), *three()[:300], "Recorder 7", ",".join(NAMES), *three()[300:]],
        {},
    ),
    "times of their own, equal": (["Time [s],CH1,Time [s],CH2", *paired(0.0)], PAIRED),
    "X,Y,X,Y": (["X,Y,X,Y", *paired(0.0)], {"time": "X [s]", **PAIRED}),
    "labels": (
        [f"t[ms]:{a} speed[rpm]:{b}\tiq[A]:{c}" for a, b, c in (row.split(",") for row in three())],
        {"time": "t", "velocity": "speed"},
    ),
    "pairs with units": (
        [f"time={a} ms, w={b} rpm, i={c}A" for a, b, c in (row.split(",") for row in three())],
        {"velocity": "w", "current": "i"},
    ),
    "two columns of a name": (
        ["time [ms],velocity [rpm],velocity [rpm],current [A]", *(row.replace(",", ",7,", 1) for row in three())],
        {"velocity": "column 3 [rpm]"},
    ),
}


@pytest.mark.parametrize("dialect", DIALECTS)
def test_dialects_of_scopes_and_logs(tmp_path, dialect):
    text, columns = DIALECTS[dialect]
    holds(read(written(tmp_path / "run.csv", text, []), columns))


def test_signals_with_times_of_their_own(tmp_path):
    recording = read_recording(written(tmp_path / "run.csv", ["X,Y,X,Y", *paired(0.5e-3)], []))
    assert recording.notes == ("times taken as s, as the file has no unit",)
    for channel, values, shift in zip(recording.channels, (SPEED, AMPS), (0.0, 0.5e-3), strict=True):
        assert channel.time is not None and channel.time.unit == "s"
        np.testing.assert_allclose(channel.time.values, TIME + shift, atol=1e-9)
        np.testing.assert_array_equal(channel.values, values)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            ["This is a log", "of 12 things", "and nothing else 3"],
            "line 3: found no columns of numbers: 'and nothing else 3'",
        ),
        (["time [s],velocity [rad/s]"], "found a header and no samples"),
        (["velocity [rad/s]", "1", "2"], "found one column"),
    ],
)
def test_the_reason_why_a_text_is_no_table(tmp_path, text, words):
    with pytest.raises(InputError, match=words):
        read(written(tmp_path / "run.csv", text, []))
