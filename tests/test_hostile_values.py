"""Values and tables that nothing physical has are refused in one line, and no nan is ever written."""

import json
import re
from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.assets import asset
from bench.errors import InputError, UndeterminedError
from bench.fit.identify import identify
from bench.plant.model_file import load_model, read_table
from bench.plant.profiles import s_curve
from bench.rig.rig import Rig, load_rig
from bench.structured import json_text, parse_json, read_toml
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording, to_json
from bench.trace.read import read_recording
from bench.trace.stream import stream
from tests.command import bench
from tests.hostile import columns, cpu_seconds, csv_of


def one_sample(values, value):
    changed = values.copy()
    changed[1000] = value
    return changed


TIME, VELOCITY, CURRENT = columns()
IMPOSSIBLE = {
    "1e200 rad/s": (TIME, one_sample(VELOCITY, 1e200), CURRENT),
    "1e308 A": (TIME, VELOCITY, one_sample(CURRENT, 1e308)),
    "-1e155 A": (TIME, VELOCITY, one_sample(CURRENT, -1e155)),
    "time 1e300": (TIME * 1e300, VELOCITY, CURRENT),
    "time 1e-300": (TIME * 1e-300, VELOCITY, CURRENT),
    "time 1e-320": (np.arange(3000) * 1e-320, VELOCITY, CURRENT),
    "current 1e-200": (TIME, VELOCITY, CURRENT * 1e-200),
    "velocity 1e200": (TIME, VELOCITY * 1e200, CURRENT),
}


@pytest.mark.parametrize("case", IMPOSSIBLE)
def test_magnitudes_that_no_axis_has_are_refused_and_never_nan_in_json(tmp_path, case):
    (tmp_path / "run.csv").write_text(csv_of(*IMPOSSIBLE[case]))
    rig = Rig.of({"name": "x", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A"}})
    with pytest.raises(InputError, match=r"is the unit right|increase|different times"):
        identify(stream(tmp_path / "run.csv"), rig)
    status = bench("inspect", tmp_path / "run.csv", "--json", tmp_path / "x").status
    assert status in (0, 1, 2)
    assert (tmp_path / "x").exists() is (status == 0)
    if status == 0:
        assert json.loads((tmp_path / "x").read_text(), parse_constant=pytest.fail)["schema"]


@pytest.mark.parametrize("changed", ["time", "position", "velocity", "current"])
@pytest.mark.parametrize("samples", [1, 2, 33])
def test_inspect_takes_numbers_at_the_end_of_what_there_is(tmp_path, changed, samples):
    """Before, it warned of overflows of its own."""
    table = {name: 0.1 * np.arange(40) for name in ("time", "position", "velocity", "current")}
    table[changed][7 : 7 + samples] = 1.7e308 if changed == "time" else 1.7e308 * (-1.0) ** np.arange(samples)
    rows = "\n".join(",".join(map(repr, map(float, row))) for row in zip(*table.values(), strict=True))
    (tmp_path / "run.csv").write_text(f"time [s],position [rad],velocity [rad/s],current [A]\n{rows}\n")
    try:
        to_json(inspect_recording(read_recording(tmp_path / "run.csv"), GivenOptions()))
    except InputError as error:
        assert changed == "time" and "\n" not in str(error)


@pytest.mark.parametrize("key", ["timestamp", "position", "speed", "load", "input_volts", "temp", "goal_position"])
@pytest.mark.parametrize("value", [10**400, -(10**400), "1", None, True, float("nan"), float("inf")])
def test_numbers_of_a_json_recording_that_are_none(tmp_path, key, value):
    """An integer may have 4300 digits, of which a float holds 308."""
    good = dict.fromkeys(("position", "speed", "load", "input_volts", "temp", "goal_position"), 1)
    entries = [{"timestamp": 0.1 * k, **good} for k in range(12)]
    entries[3][key] = value
    (tmp_path / "run.json").write_text(json.dumps({"mass": 1, "entries": entries}))
    not_a_number = not isinstance(value, float) or key == "load"
    with pytest.raises(InputError, match=rf"entries\[3\].{key}: found") if not_a_number else nullcontext():
        read_recording(tmp_path / "run.json")


def test_a_result_that_is_no_number_is_refused():
    for content, place in (({"a": {"b": [1.0, float("nan")]}}, r"a\.b\[1\]"), ({"c": (float("inf"),)}, r"c\[0\]")):
        with pytest.raises(UndeterminedError, match=place):
            json_text(content)


FINITE = st.floats(allow_nan=False, allow_infinity=False)


@settings(max_examples=40)
@given(
    st.recursive(
        st.none() | st.booleans() | st.integers() | FINITE | st.text(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    ),
    st.booleans(),
)
def test_any_result_comes_back_from_json(content, ascii_only):
    assert parse_json(json_text({"content": content}, ascii_only), "x.json") == {"content": content}


DEEP = "[" * 5000 + "]" * 5000
BAD_TOML = {
    "deep": f"x = {DEEP}",
    "deep tables": "x = " + "{a = " * 5000 + "1" + "}" * 5000,
    "digits": f"x = {'1' * 5000}",
    "null": "x = \0",
    "latin-1": "name = '\udce9'",
    "key": "'" * 5000,
    "dots": ".".join(["a"] * 32_000) + " = 1",
    "dots apart": " . ".join(['"a b"'] * 32_000) + " = 1",
    "dots of a table": "[" + ".".join(["a"] * 32_000) + "]",
    "dots in a table": "x = {" + ".".join(["'a'"] * 32_000) + " = 1}",
}


@pytest.mark.parametrize("case", BAD_TOML)
@pytest.mark.parametrize("load", [load_rig, load_model, read_table])
def test_toml_that_is_none(tmp_path, case, load):
    path = tmp_path / "x.toml"
    path.write_text(BAD_TOML[case], errors="surrogateescape")
    with cpu_seconds(4.0), pytest.raises(InputError) as error:
        load(path)
    assert str(path) in str(error.value) and "\n" not in str(error.value)
    for place in (tmp_path, tmp_path / "none", tmp_path / ("x" * 300), "/proc/self/mem"):
        with pytest.raises(InputError):
            load(place)


LEVELS = ["[" * 65 + "]" * 65, '{"a":' * 65 + "1" + "}" * 65, '[1, {"a": ' * 40 + "1" + "}]" * 40, "[" * 100_000]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        *((text, "too deep; allowed: 64 levels") for text in LEVELS),
        ("1" * 5000, "integer of thousands of digits"),
        ("{", "line 1"),
    ],
)
def test_json_that_is_none_or_too_deep(text, words):
    with pytest.raises(InputError, match=words):
        parse_json(text, "x.json")
    assert parse_json("[" * 64 + "]" * 64, "x.json")


@pytest.mark.parametrize("dots", [2, 40])
def test_a_text_with_dots_is_no_key(tmp_path, dots):
    path = tmp_path / "x.toml"
    path.write_text("a.b.c = '''" + "word." * dots + " " + "...." * 100 + "'''\n# " + "a, b. " * 200)
    assert read_toml(path, "a file")["a"]["b"]["c"].count(".") == dots + 400


RIG_TEXT = asset("data", "rigs", "sh30701p.toml").read_text()


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("control_period", "250 ns", "drive.control_period.*5 us to 10 s"),
        ("control_period", "1 ns", "drive.control_period"),
        ("control_period", "250 ms", "drive: inconsistent.*control_period must be below"),
        ("control_period", "250 s", "drive.control_period"),
        ("sample_period", "1 ns", "simulation.sample_period"),
        ("sample_period", "1e9 s", "simulation.sample_period"),
        ("position_gain", "1e300 1/s", "control_period must be below"),
    ],
)
def test_periods_in_the_wrong_unit_are_reported(tmp_path, key, value, words):
    path = tmp_path / "rig.toml"
    path.write_text(re.sub(rf"^{key} = .*", f'{key} = "{value}"', RIG_TEXT, flags=re.MULTILINE))
    with pytest.raises(InputError, match=words):
        load_rig(path)


def test_motions_that_take_for_ever_are_reported():
    with cpu_seconds(4.0), pytest.raises(InputError, match=r"takes 1e\+12 periods of the drive"):
        s_curve([(1e9, 1.0)], 1e-3)
