"""A short push is found beside a misfit as large as the noise floor or five times it, and none where none was."""

import pytest

from tests.studies.pulses import reported_push


@pytest.mark.slow
def test_a_push_is_found_in_size_and_time_beside_another_misfit(tmp_path):
    assert reported_push(5, True, tmp_path, 5.0).right


@pytest.mark.slow
@pytest.mark.parametrize("floors", [1.0, 5.0])
def test_none_without_one(tmp_path, floors):
    assert reported_push(2, True, tmp_path, floors).right
    assert not reported_push(2, False, tmp_path, floors).found
