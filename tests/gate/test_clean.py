"""No check fails on a recording that is sound, whatever sensors and effects it holds; a wrong scale does."""

import pytest

from bench.gate.gate import gate
from tests.gate.clean import independent, public, real, shared_cases
from tests.shared import needs_shared


def failing(trace, rig):
    return {check.name for check in gate(trace, rig).checks if check.status == "fail"}


@pytest.mark.parametrize("recordings", [shared_cases, real, public])
@needs_shared
def test_nothing_fails_on_recordings_of_others(recordings):
    failed = {name: found for name, trace, rig in recordings() if (found := failing(trace, rig))}
    assert failed == {}


@pytest.mark.slow
def test_nothing_fails_on_axes_drawn_at_random(tmp_path):
    drawn = list(independent(6, tmp_path, duration=3.0))
    assert {name: found for name, trace, rig in drawn if (found := failing(trace, rig))} == {}


@needs_shared
def test_a_speed_of_another_scale_fails_on_real_recordings():
    found = [failing(trace, rig) for _, trace, rig in real(wrong=True)]
    assert found == [{"velocity_is_derivative_of_position"}] * 7
