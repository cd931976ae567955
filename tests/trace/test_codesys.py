"""Traces of Machine Expert: XML of the trace editor, its CSV and its text."""

import re

import numpy as np
import pytest

from bench.errors import InputError
from bench.trace.read import read, read_recording
from tests.trace.recordings import current, machine_expert_xml, shared, velocity, write_utf16

PERIOD = 10e-3  # task cycle
PHASE = 2.4e-3


@pytest.fixture
def saved(tmp_path):
    """Writes variables as the trace editor saves them."""

    def write(variables, **more):
        text = variables if isinstance(variables, str) else machine_expert_xml(variables, **more)
        return write_utf16(tmp_path / "run.trace", text)

    return write


def instants(count=600, hole_after=250, hole=0.12):
    times = PHASE + PERIOD * np.arange(count)
    times[hole_after:] += hole
    return times


def test_stamps_rounded_to_ms_are_a_regular_base_with_a_hole(saved):
    true = instants()
    stamps = np.floor(true * 1e3 + 0.5)
    late = np.floor(true * 1e3 + 0.9)  # read later in the cycle: some stamps are one ms behind
    trace = read(saved({"PLC_PRG.Velocity": (stamps, velocity(true)), "PLC_PRG.Current": (late, current(true))}))
    assert trace.sample_period == pytest.approx(PERIOD, rel=1e-5)
    assert [segment.stop for segment in trace.segments] == [250, 600]
    assert trace.time_base is not None and not trace.time_base.resampled
    ((_, duration),) = trace.time_base.holes
    assert duration == pytest.approx(PERIOD + 0.12, abs=1e-3)
    # the samples are those of the file, not interpolated ones
    np.testing.assert_allclose(trace["velocity"], np.deg2rad(velocity(true)), rtol=1e-15)
    np.testing.assert_allclose(trace["current"], current(true) / 1e3, rtol=1e-15)
    (assumed,) = [note for note in trace.notes if "has no unit" in note]
    assert assumed.startswith("velocity taken as deg/s, current taken as mA, as the file has no unit")


@pytest.mark.parametrize("hole", [0.08, 0.18])
def test_jittering_stamps_are_interpolated_but_not_across_the_hole(saved, hole):
    rng, nominal, variables = np.random.default_rng(3), instants(hole=hole), {}
    for name, signal in (("Velocity", velocity), ("Current", current)):
        stamps = np.rint((nominal + rng.uniform(-3e-3, 3e-3, nominal.size)) * 1e6)
        variables[f"PLC_PRG.{name}"] = (stamps, signal(stamps * 1e-6))
    trace = read(saved(variables, microseconds=True))
    assert trace.time_base is not None and trace.time_base.resampled
    assert len(trace.segments) == 2 and len(trace.time_base.holes) == 1
    assert not ((trace.time > 2.5 + PHASE) & (trace.time < 2.49 + PHASE + hole)).any()
    for segment in trace.segments:
        np.testing.assert_allclose(np.diff(trace.time[segment]), trace.sample_period, rtol=1e-9)
    # 12 Hz at 10 ms leaves 8 samples a period: cubic interpolation is good to a few percent of that part
    np.testing.assert_allclose(trace["velocity"], np.deg2rad(velocity(trace.time)), atol=np.deg2rad(0.2 * 120))
    np.testing.assert_allclose(trace["current"], current(trace.time) / 1e3, atol=0.2 * 0.2)


def test_variables_at_different_rates_go_to_the_rate_of_the_velocity(saved):
    fast, slow = np.arange(0, 3000, 2), np.arange(0, 3000, 30)
    path = saved({"A.Temperature": (slow, 20.0 + slow / 1e3), "A.Velocity": (fast, velocity(fast / 1e3))})
    trace = read(path, {"temperature": "A.Temperature [degC]"})
    assert trace.sample_period == pytest.approx(2e-3)
    np.testing.assert_allclose(trace["temperature"], 273.15 + 20.0 + trace.time, atol=1e-9)
    assert trace.time[-1] <= slow[-1] / 1e3 + 1e-3
    assert any("temperature sampled every 0.03 s by a clock of its own" in note for note in trace.notes)


def test_a_hole_in_a_slower_variable_is_a_hole_of_the_trace(saved):
    stamps = np.arange(0, 2000, 2)
    kept = stamps[(stamps < 800) | (stamps > 950)]
    trace = read(saved({"A.Velocity": (stamps, velocity(stamps / 1e3)), "A.Current": (kept, current(kept / 1e3))}))
    assert len(trace.segments) == 2
    assert not ((trace.time > 0.7985) & (trace.time < 0.9515)).any()
    assert any("left out where not every signal is known" in note for note in trace.notes)
    np.testing.assert_allclose(trace["current"], current(trace.time) / 1e3, rtol=1e-12)


STAMPS = np.arange(200)
ONE = {"A.Velocity": (STAMPS, velocity(STAMPS / 1e3))}


def test_rig_columns_override_the_lab_units(saved):
    trace = read(saved(ONE), {"velocity": "-A.Velocity [rad/s]"})
    np.testing.assert_allclose(trace["velocity"], -velocity(STAMPS / 1e3))
    assert not any("taken as" in note for note in trace.notes)


def test_plain_utf8_and_utf16_without_a_mark_are_the_same(saved, tmp_path):
    xml, utf16 = machine_expert_xml(ONE), read(saved(ONE))
    for content in (xml.replace("utf-16", "utf-8").encode(), xml.encode("utf-16-le")):
        (tmp_path / "run.xml").write_bytes(content)
        assert np.array_equal(read(tmp_path / "run.xml")["velocity"], utf16["velocity"])


def test_two_variables_of_one_name_must_be_distinguished(saved):
    path = saved({**ONE, "B.Velocity": (STAMPS, current(STAMPS / 1e3))})
    with pytest.raises(InputError, match=r"found 2 axes \(A, B\); pick one: `--axis A`"):
        read(path)
    other = read(path, {"velocity": "B.Velocity [deg/s]"})
    np.testing.assert_allclose(other["velocity"], np.deg2rad(current(STAMPS / 1e3)))


def test_values_and_stamps_must_pair(saved):
    with pytest.raises(InputError, match=r"variable 'A.Velocity': found 2 values and 5 time stamps"):
        read(saved({"A.Velocity": (range(5), [1.0, 2.0])}))


@pytest.mark.parametrize("separator", [",", ";"])
def test_decimal_commas_are_read(saved, separator):
    """Between commas too, where each number has one, so that there are twice as many parts as time stamps."""
    xml = machine_expert_xml({**ONE, "A.Current": (STAMPS, STAMPS - 9.5)})
    point = read(saved(xml))
    comma = read(
        saved(re.sub("(?<=<Values>)[^<]*", lambda found: found[0].replace(",", separator).replace(".", ","), xml))
    )
    for name in ("velocity", "current"):
        assert np.array_equal(comma[name], point[name])


def test_decimal_commas_that_cannot_be_told_from_separators_are_refused(saved):
    """`1,5,2,3,25`: some numbers are whole. With ; between them, as advised, they are read."""
    xml = machine_expert_xml({"A.Velocity": (range(150), [])})
    values = ["1,5", "2", "3,25"] * 50
    with pytest.raises(InputError, match=r"found 250 values and 150 time stamps.*with ; between numbers"):
        read(saved(xml.replace("<Values></Values>", f"<Values>{','.join(values)}</Values>")))
    trace = read(saved(xml.replace("<Values></Values>", f"<Values>{';'.join(values)}</Values>")))
    np.testing.assert_allclose(np.rad2deg(trace["velocity"])[:3], [1.5, 2.0, 3.25])


def test_sample_of_the_csv_export():
    path = shared("formats", "codesys_head.trace.csv")
    (channel,) = read_recording(path).channels
    assert channel.name == "PLC_PRG.air_flow" and channel.time is not None
    assert channel.time.values.tolist() == [2, 12, 22, 33, 42, 911, 921] and channel.time.unit == "ms"
    assert channel.values[-1] == 30.040000915527344
    assert [segment.stop for segment in read(path, {"voltage": "air_flow [V]"}).segments] == [5, 7]


def test_csv_export_in_microseconds(tmp_path):
    lines = ["[key]; [value]", "Flags; 32", "0.Variable; A.Velocity", "0.Data; ", "; 0; 1", "; 250; 2", "; 500; 3"]
    lines += ["1.Variable; A.Current", "1.Data; ", "; 0; 4", "; 250; 5", "; 500; 6"]
    (tmp_path / "run.csv").write_text("\n".join(lines))
    trace = read(tmp_path / "run.csv")
    assert trace.sample_period == pytest.approx(250e-6)
    np.testing.assert_allclose(trace["current"], [4e-3, 5e-3, 6e-3])


@pytest.mark.parametrize("head", ["Timestamp(ms)", "Zeitstempel(ms)", "Zeitstempel (ms)"])
def test_text_export(tmp_path, head):
    path = tmp_path / "run.txt"
    lines = ["Trace", "C:\\lab\\axis.project", "", f"{head} PLC_PRG.Velocity PLC_PRG.Current", "0 1.5 10", "2 2,5 20"]
    path.write_text("\n".join([*lines, "4 3.5 30"]))
    trace = read(path)
    assert trace.metadata["title"] == "Trace" and trace.metadata["project"] == "C:\\lab\\axis.project"
    assert trace.sample_period == pytest.approx(2e-3)
    np.testing.assert_allclose(trace["velocity"], np.deg2rad([1.5, 2.5, 3.5]))
    path.write_text("\n".join([*lines, "4 x 30"]))
    with pytest.raises(InputError, match=r"line 7, column 'PLC_PRG.Velocity': found 'x'"):
        read(path)
