import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from bench.errors import InputError
from bench.trace.read import read
from bench.trace.trace import Trace
from bench.trace.write import write
from tests.trace.recordings import current, velocity

TIME = np.arange(800) * 1e-3


def _run(time=TIME):
    signals = {"velocity": np.deg2rad(velocity(time)), "current": current(time) / 1e3, "temperature": 300.0 + time}
    return Trace(time, signals, {"velocity": "rad/s", "current": "A", "temperature": "K"}, "test")


finite = st.floats(allow_nan=False, allow_infinity=False)


def comes_back(folder, time, values, ending):
    trace = Trace(time, {"velocity": values, "current": -values}, {"velocity": "rad/s", "current": "A"}, "test")
    write(trace, folder / f"run.{ending}")
    return trace, read(folder / f"run.{ending}")


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    values=st.integers(2, 40).flatmap(lambda n: arrays(np.float64, n, elements=finite)),
    period=st.floats(1e-6, 1e3),
    start=st.floats(-1e3, 1e3),
    ending=st.sampled_from(["csv", "csv.gz", "parquet"]),
)
def test_what_is_written_in_si_comes_back_bit_for_bit(tmp_path, values, period, start, ending):
    trace, again = comes_back(tmp_path, start + period * np.arange(values.size), values, ending)
    assert np.array_equal(again.time, trace.time)
    assert all(np.array_equal(again[name], trace[name]) for name in ("velocity", "current"))
    assert dict(again.units) == dict(trace.units)


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    values=st.integers(2, 60).flatmap(lambda n: arrays(np.float64, n, elements=st.floats(-1e6, 1e6))),
    microseconds=st.integers(50, 100_000),
)
def test_machine_expert_comes_back_to_the_rounding_of_its_units(tmp_path, values, microseconds):
    trace, again = comes_back(tmp_path, np.arange(values.size) * (microseconds * 1e-6), values, "trace")
    assert again.sample_period == pytest.approx(microseconds * 1e-6, rel=1e-9)
    for name in ("velocity", "current"):
        np.testing.assert_allclose(again[name], trace[name], rtol=1e-14, atol=1e-300)
    assert again.notes == (() if len(again) >= 10 else (f"only {len(again)} samples",))


@pytest.mark.parametrize("unit", ["rad/s", "deg/s", "rpm"])
def test_a_machine_expert_trace_takes_units_of_ones_own(tmp_path, unit):
    trace = _run()
    write(trace, tmp_path / "run.trace", {"velocity": unit})
    np.testing.assert_allclose(read(tmp_path / "run.trace")["velocity"], trace["velocity"], rtol=1e-12)


def test_machine_expert_is_utf16_xml_in_the_labs_units(tmp_path):
    write(_run(), tmp_path / "run.trace")
    content = (tmp_path / "run.trace").read_bytes()
    assert content.startswith(b"\xff\xfe")
    text = content[2:].decode("utf-16-le")
    assert "velocity [deg/s], current [mA], temperature [K]" in text
    first = text.split("<Values>", 1)[1].split(",", 1)[0]
    assert float(first) == pytest.approx(velocity(0.0))
    assert "<Timestamps>0,1,2,3," in text


def test_units_of_choice(tmp_path):
    write(_run(), tmp_path / "run.csv", {"time": "ms", "velocity": "deg/s", "temperature": "degC"})
    head, first = (tmp_path / "run.csv").read_text().splitlines()[:2]
    assert head == "time [ms],velocity [deg/s],current [A],temperature [degC]"
    assert [float(cell) for cell in first.split(",")] == pytest.approx([0.0, velocity(0.0), current(0.0) / 1e3, 26.85])
    again = read(tmp_path / "run.csv")
    np.testing.assert_allclose(again["velocity"], _run()["velocity"], rtol=1e-14)


@pytest.mark.parametrize("ending", ["csv", "parquet", "trace"])
def test_holes_survive(tmp_path, ending):
    write(_run(np.where(TIME < 0.3, TIME, TIME + 0.123)), tmp_path / f"run.{ending}")
    assert [segment.stop for segment in read(tmp_path / f"run.{ending}").segments] == [300, 800]


def test_the_same_trace_gives_the_same_bytes(tmp_path):
    for name in ("a.csv.gz", "b.csv.gz"):
        write(_run(), tmp_path / name)
    assert (tmp_path / "a.csv.gz").read_bytes() == (tmp_path / "b.csv.gz").read_bytes()


@pytest.mark.parametrize(
    ("name", "units", "message"),
    [
        ("run.xls", None, r"found the ending '.xls'; allowed: .csv, .csv.gz, .parquet, .trace"),
        ("run", None, r"found the ending ''"),
        ("run.csv", {"velocity": "V"}, r"unit of velocity: found"),
        ("run.csv", {"velocity": "spam"}, r"'spam', which is not a unit"),
        ("run.csv", {"velocity": ""}, r"unit of velocity: found"),
        ("run.csv", {"speed": "rad/s"}, r"unit of speed: the trace contains no such signal"),
        ("run.csv", {"velocity": "m/s"}, r"unit of velocity: found 'm/s'; allowed: a unit of rad/s"),
    ],
)
def test_what_cannot_be_written_leaves_nothing_behind_or_the_old_file(tmp_path, name, units, message):
    for old in ([], [tmp_path / name]):
        for path in old:
            path.write_text("old")
        with pytest.raises(InputError, match=message):
            write(_run(), tmp_path / name, units)
        assert list(tmp_path.iterdir()) == old
        assert all(path.read_text() == "old" for path in old)
