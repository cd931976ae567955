"""Whatever numbers a file of any format holds, they are read as they were written; tables of results to nine digits."""

import os
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from bench.diagnosis.replay import Replay
from bench.plant.drive import References
from bench.trace.read import read_recording
from tests.trace.formats import WRITERS, content

COUNT = 12
TIME = np.arange(COUNT)
FINITE = st.floats(allow_nan=False, allow_infinity=False)
NUMBERS = arrays(np.float64, (2, COUNT), elements=FINITE)
SEVERAL = settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)


@SEVERAL
@given(numbers=NUMBERS)
@example(numbers=np.full((2, COUNT), 100000000.5625))  # as long as an instant of an epoch, of which distances count
@pytest.mark.parametrize("name", WRITERS)
def test_numbers_are_read_as_they_were_written(tmp_path, name, numbers):
    (tmp_path / "run").write_bytes(content(name, TIME, *numbers))
    with patch.dict(os.environ, SERVOBENCH_WATCHED="1"):  # MDF4 in this process, not in one for each example
        recording = read_recording(tmp_path / "run")
    held = {channel.values.tobytes() for channel in recording.channels}
    for values in numbers:
        assert values.tobytes() in held


def assert_holds(path, text, *columns):
    path.write_text(text)
    for channel, values in zip(read_recording(path).channels, columns, strict=True):
        np.testing.assert_allclose(channel.values, values, rtol=1e-8, atol=0.0)


@SEVERAL
@given(numbers=NUMBERS, hole=st.integers(0, COUNT - 1))
def test_a_replay_comes_back(tmp_path, numbers, hole):
    """What the model says nothing of is an empty cell."""
    measured, simulated = numbers
    simulated[hole] = np.nan
    columns = (TIME, measured, simulated, measured, simulated)
    replay = Replay(TIME, measured, simulated, *columns[1:], speed_unit="rad/s", effort_unit="N*m")
    assert_holds(tmp_path / "replay.csv", replay.csv(), *columns)


@SEVERAL
@given(numbers=NUMBERS)
def test_a_motion_for_a_controller_comes_back(tmp_path, numbers):
    position, velocity = numbers
    motion = References(1e-3 * TIME, position, velocity, velocity)
    text = motion.csv(1e-3, ("rad", 1.0), ("rad/s", 1.0))
    assert_holds(tmp_path / "motion.csv", text, motion.time, position, velocity, velocity)
