"""A short push is found beside a misfit as large as the noise floor or five times it, and none where none was."""

import pytest

from tests.studies.pulses import reported_push


@pytest.mark.slow
@pytest.mark.parametrize(("number", "floors"), [(5, 5.0), (2, 1.0), (2, 5.0)])
def test_a_push_is_found_in_size_and_time_and_none_without_one(tmp_path, number, floors):
    assert reported_push(number, True, tmp_path, floors).right
    assert number != 2 or not reported_push(number, False, tmp_path, floors).found
