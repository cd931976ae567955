"""Every rig that `inspect --draft` writes is a rig, and with it a recording is read further than without."""

import importlib
import re
import tomllib
from pathlib import Path

import pytest

from bench.errors import InputError
from bench.rig.given import draft
from bench.rig.rig import Rig
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording
from bench.trace.read import read_recording
from bench.trace.trace import assemble
from tests.shared import SHARED

UNITS = {"time": "ms", "position": "rad", "velocity": "rad/s", "torque": "N*m", "current": "A", "temperature": "degC"}
FAULTS = ("two_axes", "temp_as_velocity", "derivative_sign", "setpoint_columns", "no_units", "unit_suffix")
OTHER = (".toml", ".json", ".md", ".mcap", ".tdms")
EXPORTS = sorted(path for path in (SHARED / "data" / "exports").glob("*/*") if path.suffix not in OTHER)


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


@pytest.mark.parametrize("path", EXPORTS, ids=lambda path: path.parent.name)
def test_an_export_is_read_further_with_its_draft(path):
    assert_further(path)


@pytest.mark.parametrize("name", FAULTS)
def test_a_log_is_read_further_with_its_draft(name, tmp_path):
    importlib.import_module(f"tests.faults.{name}.twin").write(tmp_path)
    logs = [path for path in Path(tmp_path).iterdir() if path.suffix in (".csv", ".txt")]
    assert logs
    for path in logs:
        assert_further(path)
