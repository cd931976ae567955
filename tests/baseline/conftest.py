"""What tests of the command share."""

from tests.diagnosis.conftest import bench

__all__ = ["bench"]
