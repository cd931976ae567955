"""A short push is found beside a misfit as large as the noise floor, and none where none was."""

import pytest

from tests.studies.pulses import told_of


@pytest.mark.slow
def test_a_push_is_told_in_size_and_time_and_none_without_one(tmp_path):
    assert told_of(2, True, tmp_path, 1.0).right
    assert not told_of(2, False, tmp_path, 1.0).found
