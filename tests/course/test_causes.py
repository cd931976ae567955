"""What undoing a mistake changes of a run, and which columns the course's words name."""

import numpy as np
import pytest

from bench.course.mistakes import MISTAKES
from bench.course.run import made_run
from bench.rig.given import rig_of

RIG = rig_of("sh30701p")
RUN = made_run(np.linspace(0.0, 90.0, 50), np.linspace(2.0, -1.0, 50), 2e-3, RIG)
#: What a scale that was wrong changes.
CHANGED = {
    "speed": "velocity",
    "current": "current",
    "amplitude": "current",
    "sign": "current",
    "time": "sample_period",
}


@pytest.mark.parametrize("mistake", [each for each in MISTAKES if each.kind in CHANGED], ids=lambda each: each.words)
def test_a_scale_that_is_undone_leaves_the_rest(mistake):
    undone = mistake.undo(RUN, RIG)
    signals = {name: (getattr(RUN, name), getattr(undone, name)) for name in set(CHANGED.values())}
    assert [name for name, pair in signals.items() if not np.array_equal(*pair)] == [CHANGED[mistake.kind]]
