"""The command `bench` for tests, as those of diagnosis have it."""

from tests.diagnosis.conftest import bench

__all__ = ["bench"]
