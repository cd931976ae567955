"""Recordings as drives and loggers export them, beside the project: identified, and held to their truth.

Every rig that `inspect --draft` writes is a rig, and with it a recording is read further than without.
"""

import importlib
import json
import re
import tomllib

import pytest

from bench.errors import InputError
from bench.rig.given import draft
from bench.rig.rig import Rig
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording
from bench.trace.read import read_recording
from bench.trace.trace import assemble
from tests.command import bench
from tests.shared import SHARED, needs_shared

EXPORTS = SHARED / "data" / "exports"
TRUTHS = EXPORTS / "truth.json"
#: What is expected of each recording; empty where the recordings are absent.
EXPECTED = json.loads(TRUTHS.read_text(encoding="utf-8")) if TRUTHS.exists() else {}
#: Each parameter under its letter in the truth, and the relative error that an answer may have.
LIMITS = {
    "J": ("moment_of_inertia", "kg*m**2", 0.005),
    "b": ("viscous_friction_coefficient", "N*m*s/rad", 0.03),
    "c": ("coulomb_friction_torque", "N*m", 0.03),
}


@needs_shared
@pytest.mark.parametrize("name", EXPECTED)
def test_an_export_is_answered_or_refused_as_expected(name, tmp_path):
    """As the recordings' README says: a refusal asks with one of each choice of words."""
    truth, result = EXPECTED[name], tmp_path / "result.json"
    file, rig = EXPORTS / name / truth["file"], EXPORTS / name / "rig.toml"
    status, _, err = bench("identify", file, "--rig", rig, "--json", result)
    if truth["expect"] == "refuse":
        message = " ".join(err.split())
        assert status in (1, 2), message
        assert all(any(word in message for word in choice) for choice in truth["words"]), message
        return
    assert status == 0, err
    found = json.loads(result.read_text(encoding="utf-8"))["parameters"]
    for letter, (parameter, unit, limit) in LIMITS.items():
        assert found[parameter]["unit"] == unit
        assert found[parameter]["value"] == pytest.approx(truth[letter], rel=limit), letter


UNITS = {"time": "ms", "position": "rad", "velocity": "rad/s", "torque": "N*m", "current": "A", "temperature": "degC"}
FAULTS = ("two_axes", "temp_as_velocity", "derivative_sign", "setpoint_columns", "no_units", "unit_suffix")


def completed(text):
    """The draft as a user completes it: a unit for each `?` of a column, a sample period."""
    text = re.sub(r'^# sample_period = "\? ms"', 'sample_period = "2 ms"', text, flags=re.M)

    def line(match):
        return f'{match[1]} = "{match[2]} [{UNITS.get(match[1].removesuffix("_reference"), "N")}]"'

    return re.sub(r'^# (\w+) = "(.*) \[\?\]".*$', line, text, flags=re.M)


def asked(recording, trace):
    """What reading a recording asks for; None where it is read."""
    try:
        assemble(recording, trace)
    except InputError as error:
        return str(error)
    return None


def assert_further(path):
    recording = read_recording(path)
    found = inspect_recording(recording, GivenOptions())
    assert found.asks == asked(recording, None)
    axis = found.axes[0] if len(found.axes) > 1 else None
    drafted = Rig.of(tomllib.loads(draft(found)), "draft").on_axis(axis)
    before, after = asked(recording, GivenOptions()), asked(recording, drafted.trace)
    if before is None or axis is not None:
        assert after is None
        return
    full = draft(found)
    if "?" in re.sub(r"#.*what only you know.*", "", full):
        after = asked(recording, Rig.of(tomllib.loads(completed(full)), "draft").on_axis(axis).trace)
    assert after != before


@needs_shared
@pytest.mark.parametrize("name", EXPECTED)
def test_an_export_is_read_further_with_its_draft(name):
    assert_further(EXPORTS / name / EXPECTED[name]["file"])


@pytest.mark.parametrize("name", FAULTS)
def test_a_log_is_read_further_with_its_draft(name, tmp_path):
    importlib.import_module(f"tests.faults.{name}.twin").write(tmp_path)
    logs = [path for path in tmp_path.iterdir() if path.suffix in (".csv", ".txt")]
    assert logs
    for path in logs:
        assert_further(path)
