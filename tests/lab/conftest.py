"""The course, done once for all tests that read it."""

import pytest

from bench.lab.course import course
from bench.lab.recordings import Recordings
from bench.lab.result import Task


@pytest.fixture(scope="session")
def done():
    """Tasks of the course on the synthetic recordings by their key."""
    tasks = course(Recordings.in_folder(None))
    missed = [task for task in tasks if not isinstance(task, Task)]
    assert not missed, [f"{task.key}: {task.reason}" for task in missed]
    return {task.key: task for task in tasks}
