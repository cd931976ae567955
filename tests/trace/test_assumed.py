"""Units that a recording does not state: SI where physics agrees, others by motion, else a refusal."""

import numpy as np
import pytest

from bench.errors import InputError
from bench.trace.read import read

TIME = np.arange(2000) * 2e-3
ANGLE = 3.0 * np.sin(2.0 * np.pi * 0.8 * TIME) + 0.01 * np.sin(60.0 * TIME)
SPEED = np.gradient(ANGLE, TIME)
AMPS = 1.3 * np.cos(7.0 * TIME)
MS, US = 2.0 * np.arange(2000), 2000.0 * np.arange(2000)

#: Columns, and the units that are taken, by signal; or words of the refusal.
CASES = {
    "SI": ({"time": TIME, "position": ANGLE, "velocity": SPEED, "current": AMPS}, "s rad rad/s A"),
    "no position": ({"time": TIME, "velocity": SPEED, "current": AMPS}, "s rad/s A"),
    "no velocity": ({"time": TIME, "position": ANGLE, "torque": AMPS}, "s rad N*m"),
    "a force": ({"time": TIME, "position": ANGLE, "velocity": SPEED, "force": AMPS}, "s m m/s N"),
    "ms by motion": ({"time": MS + 0.5, "position": ANGLE, "velocity": SPEED, "current": AMPS}, "ms rad rad/s A"),
    "ms by its steps": ({"time": 7e6 + MS, "velocity": SPEED, "current": AMPS}, "ms rad/s A"),
    "us by its steps": ({"time": US, "velocity": SPEED, "current": AMPS}, "us rad/s A"),
    "s beside units": ({"time": TIME, "position [rad]": ANGLE, "velocity [rad/s]": SPEED, "current [A]": AMPS}, "s"),
    "rpm by motion": ({"time [s]": TIME, "position [rad]": ANGLE, "velocity": SPEED * 30 / np.pi}, "rpm"),
    "deg by motion": ({"time [s]": TIME, "position": np.degrees(ANGLE), "velocity [rad/s]": SPEED}, "deg"),
    "deg/s by motion": (
        {"time [s]": TIME, "position [deg]": np.degrees(ANGLE), "velocity": np.degrees(SPEED)},
        "deg/s",
    ),
    "a temperature": ({"time": TIME, "velocity": SPEED, "current": AMPS, "temperature": 40 + AMPS}, "s rad/s A"),
    "an index": ({"time": np.arange(2000), "velocity": SPEED, "current": AMPS}, "steps of 1 may be samples"),
    "too slow": ({"time": TIME * 150.0, "velocity": SPEED, "current": AMPS}, "steps of 0.3 are unusual in s"),
    "fast": ({"time": TIME, "velocity": 100 * SPEED, "current": AMPS}, r"1.5.e\+03 rad/s is hardly reached"),
    "counts": (
        {"time": TIME, "position": np.rint(652 * ANGLE), "torque": AMPS},
        "whole numbers up to .* may be counts",
    ),
    "mixed pair": ({"time": TIME, "position": np.degrees(ANGLE), "velocity": SPEED}, "changes by 57.3 times"),
    "forgotten": ({"time [s]": TIME, "velocity": SPEED, "current [A]": AMPS}, "where other columns have theirs"),
}


def write(path, columns):
    np.savetxt(
        path, np.column_stack(list(columns.values())), fmt="%.9g", delimiter=",", comments="", header=",".join(columns)
    )
    return path


@pytest.mark.parametrize("case", CASES)
def test_units_that_a_file_does_not_state(tmp_path, case):
    columns, expected = CASES[case]
    path = write(tmp_path / "run.csv", columns)
    names = [name for name in columns if "[" not in name and name != "temperature"]
    if len(expected.split()) != len(names) or expected[0].isupper():
        with pytest.raises(InputError, match=expected) as refused:
            read(path)
        assert "allowed: a unit in the file, or e.g." in str(refused.value)
        return
    trace = read(path)
    (note,) = [note for note in trace.notes if "has no unit; to state another" in note]
    for name, unit in zip(names, expected.split(), strict=True):
        assert f"{name} taken as {unit}" in note
    np.testing.assert_allclose(np.diff(trace.time), 2e-3, rtol=1e-6)
    if "velocity" in trace:
        np.testing.assert_allclose(trace["velocity"], SPEED, rtol=1e-6, atol=1e-6)


def test_what_the_refusal_and_the_note_advise_is_read(tmp_path):
    path = write(tmp_path / "run.csv", CASES["an index"][0])
    assert read(path, {"time": "time [ms]"}).sample_period == pytest.approx(1e-3)
    path = write(tmp_path / "run.csv", CASES["no position"][0])
    trace = read(path, {"velocity": "velocity [rpm]"})
    np.testing.assert_allclose(trace["velocity"], SPEED * np.pi / 30, rtol=1e-6, atol=1e-6)
