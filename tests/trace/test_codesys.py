import re

import numpy as np
import pytest

from bench.errors import InputError
from bench.trace.read import read, read_recording
from tests.trace.recordings import current, machine_expert_xml, shared, velocity, write_utf16

PERIOD = 10e-3  # task cycle
PHASE = 2.4e-3


def _instants(count=600, hole_after=250, hole=0.12):
    times = PHASE + PERIOD * np.arange(count)
    times[hole_after:] += hole
    return times


def test_stamps_rounded_to_ms_are_a_regular_base_with_a_hole(tmp_path):
    true = _instants()
    stamps = np.floor(true * 1e3 + 0.5)
    late = np.floor(true * 1e3 + 0.9)  # read later in the cycle: some stamps are one ms behind
    xml = machine_expert_xml({"PLC_PRG.Velocity": (stamps, velocity(true)), "PLC_PRG.Current": (late, current(true))})
    trace = read(write_utf16(tmp_path / "run.trace", xml))
    assert trace.sample_period == pytest.approx(PERIOD, rel=1e-5)
    assert [segment.stop for segment in trace.segments] == [250, 600]
    assert trace.time_base is not None and not trace.time_base.resampled
    ((_, duration),) = trace.time_base.holes
    assert duration == pytest.approx(PERIOD + 0.12, abs=1e-3)
    # the samples are those of the file, not interpolated ones
    np.testing.assert_allclose(trace["velocity"], np.deg2rad(velocity(true)), rtol=1e-15)
    np.testing.assert_allclose(trace["current"], current(true) / 1e3, rtol=1e-15)
    assumed = [note for note in trace.notes if "has no unit" in note]
    assert len(assumed) == 1 and assumed[0].startswith(
        "velocity taken as deg/s, current taken as mA, as the file has no unit"
    )


@pytest.mark.parametrize("hole", [0.08, 0.18])
def test_jittering_stamps_are_interpolated_but_not_across_the_hole(tmp_path, hole):
    rng = np.random.default_rng(3)
    nominal = _instants(hole=hole)
    variables, true = {}, {}
    for name, signal in (("Velocity", velocity), ("Current", current)):
        true[name] = np.rint((nominal + rng.uniform(-3e-3, 3e-3, nominal.size)) * 1e6)
        variables[f"PLC_PRG.{name}"] = (true[name], signal(true[name] * 1e-6))
    trace = read(write_utf16(tmp_path / "run.trace", machine_expert_xml(variables, microseconds=True)))
    assert trace.time_base is not None and trace.time_base.resampled
    assert len(trace.segments) == 2 and len(trace.time_base.holes) == 1
    assert not ((trace.time > 2.5 + PHASE) & (trace.time < 2.49 + PHASE + hole)).any()
    for segment in trace.segments:
        np.testing.assert_allclose(np.diff(trace.time[segment]), trace.sample_period, rtol=1e-9)
    # 12 Hz at 10 ms leaves 8 samples a period: cubic interpolation is good to a few percent of that part
    np.testing.assert_allclose(trace["velocity"], np.deg2rad(velocity(trace.time)), atol=np.deg2rad(0.2 * 120))
    np.testing.assert_allclose(trace["current"], current(trace.time) / 1e3, atol=0.2 * 0.2)


def test_variables_at_different_rates_go_to_the_rate_of_the_velocity(tmp_path):
    fast, slow = np.arange(0, 3000, 2), np.arange(0, 3000, 30)
    temperature = 20.0 + slow / 1e3
    xml = machine_expert_xml({"A.Temperature": (slow, temperature), "A.Velocity": (fast, velocity(fast / 1e3))})
    trace = read(write_utf16(tmp_path / "run.trace", xml), {"temperature": "A.Temperature [degC]"})
    assert trace.sample_period == pytest.approx(2e-3)
    np.testing.assert_allclose(trace["temperature"], 273.15 + 20.0 + trace.time, atol=1e-9)
    assert trace.time[-1] <= slow[-1] / 1e3 + 1e-3
    assert any("temperature sampled every 0.03 s by a clock of its own" in note for note in trace.notes)


def test_a_hole_in_a_slower_variable_is_a_hole_of_the_trace(tmp_path):
    stamps = np.arange(0, 2000, 2)
    kept = stamps[(stamps < 800) | (stamps > 950)]
    xml = machine_expert_xml({"A.Velocity": (stamps, velocity(stamps / 1e3)), "A.Current": (kept, current(kept / 1e3))})
    trace = read(write_utf16(tmp_path / "run.trace", xml))
    assert len(trace.segments) == 2
    assert not ((trace.time > 0.7985) & (trace.time < 0.9515)).any()
    assert any("left out where not every signal is known" in note for note in trace.notes)
    np.testing.assert_allclose(trace["current"], current(trace.time) / 1e3, rtol=1e-12)


def test_rig_columns_override_the_lab_units(tmp_path):
    stamps = np.arange(0, 100, 1)
    xml = machine_expert_xml({"A.Velocity": (stamps, velocity(stamps / 1e3))})
    trace = read(write_utf16(tmp_path / "run.trace", xml), {"velocity": "-A.Velocity [rad/s]"})
    np.testing.assert_allclose(trace["velocity"], -velocity(stamps / 1e3))
    assert not any("taken as" in note for note in trace.notes)


def test_plain_utf8_xml_is_the_same(tmp_path):
    stamps = np.arange(0, 100, 1)
    xml = machine_expert_xml({"A.Velocity": (stamps, velocity(stamps / 1e3))})
    utf16 = read(write_utf16(tmp_path / "run.trace", xml))
    (tmp_path / "run.xml").write_text(xml.replace("utf-16", "utf-8"), encoding="utf-8")
    (tmp_path / "unmarked.xml").write_bytes(xml.encode("utf-16-le"))
    for name in ("run.xml", "unmarked.xml"):
        assert np.array_equal(read(tmp_path / name)["velocity"], utf16["velocity"])


def test_two_variables_of_one_name_must_be_distinguished(tmp_path):
    stamps = np.arange(0, 100, 1)
    channels = {"A.Velocity": (stamps, velocity(stamps / 1e3)), "B.Velocity": (stamps, current(stamps / 1e3))}
    path = write_utf16(tmp_path / "run.trace", machine_expert_xml(channels))
    with pytest.raises(InputError, match=r"found 2 axes \(A, B\); pick one: `--axis A`"):
        read(path)
    np.testing.assert_allclose(
        read(path, {"velocity": "B.Velocity [deg/s]"})["velocity"], np.deg2rad(current(stamps / 1e3))
    )


def test_values_and_stamps_must_pair(tmp_path):
    path = write_utf16(tmp_path / "run.trace", machine_expert_xml({"A.Velocity": (range(5), [1.0, 2.0])}))
    with pytest.raises(InputError, match=r"variable 'A.Velocity': found 2 values and 5 time stamps"):
        read(path)


@pytest.mark.parametrize("separator", [",", ";"])
def test_decimal_commas_are_read(tmp_path, separator):
    """Between commas too, where each number has one, so that there are twice as many parts as time stamps."""
    stamps = np.arange(200)
    xml = machine_expert_xml({"A.Velocity": (stamps, velocity(stamps / 1e3)), "A.Current": (stamps, stamps - 9.5)})
    point = read(write_utf16(tmp_path / "point.trace", xml))
    changed = re.sub("(?<=<Values>)[^<]*", lambda found: found[0].replace(",", separator).replace(".", ","), xml)
    comma = read(write_utf16(tmp_path / "comma.trace", changed))
    for name in ("velocity", "current"):
        assert np.array_equal(comma[name], point[name])


def test_decimal_commas_that_cannot_be_told_from_separators_are_refused(tmp_path):
    """`1,5,2,3,25`: some numbers are whole. With ; between them, as advised, they are read."""
    values, stamps = ["1,5", "2", "3,25"] * 50, ",".join(map(str, range(150)))
    for separator in (",", ";"):
        xml = machine_expert_xml({"A.Velocity": ([], [])})
        xml = xml.replace("<Values></Values>", f"<Values>{separator.join(values)}</Values>")
        xml = xml.replace("<Timestamps></Timestamps>", f"<Timestamps>{stamps}</Timestamps>")
        path = write_utf16(tmp_path / "run.trace", xml)
        if separator == ",":
            with pytest.raises(InputError, match=r"found 250 values and 150 time stamps.*with ; between numbers"):
                read(path)
    np.testing.assert_allclose(np.rad2deg(read(path)["velocity"])[:3], [1.5, 2.0, 3.25])


def test_sample_of_the_csv_export():
    recording = read_recording(shared("formats", "codesys_head.trace.csv"))
    (channel,) = recording.channels
    assert channel.name == "PLC_PRG.air_flow" and channel.time is not None
    assert channel.time.values.tolist() == [2, 12, 22, 33, 42, 911, 921] and channel.time.unit == "ms"
    assert channel.values[-1] == 30.040000915527344
    trace = read(shared("formats", "codesys_head.trace.csv"), {"voltage": "air_flow [V]"})
    assert [segment.stop for segment in trace.segments] == [5, 7]


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
    path.write_text(
        f"Trace\nC:\\lab\\axis.project\n\n{head} PLC_PRG.Velocity PLC_PRG.Current\n0 1.5 10\n2 2,5 20\n4 3.5 30\n"
    )
    trace = read(path)
    assert trace.metadata["title"] == "Trace" and trace.metadata["project"] == "C:\\lab\\axis.project"
    assert trace.sample_period == pytest.approx(2e-3)
    np.testing.assert_allclose(trace["velocity"], np.deg2rad([1.5, 2.5, 3.5]))
    path.write_text(f"Trace\nproject\n{head} PLC_PRG.Velocity\n0 1.5\n2 x\n")
    with pytest.raises(InputError, match=r"line 5, column 'PLC_PRG.Velocity': found 'x'"):
        read(path)
