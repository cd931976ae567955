"""Every recording beside the project that is laid out as drives and loggers export them, as its truth expects it."""

import pytest

from tests.shared import needs_shared
from tests.studies.exports.score import EXPORTS, score, truths


@needs_shared
@pytest.mark.parametrize("name", truths())
def test_an_export_is_answered_or_refused_as_expected(name):
    outcome = score(EXPORTS / name, truths()[name])
    assert outcome.verdict == "right", outcome.detail
