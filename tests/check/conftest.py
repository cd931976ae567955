"""What tests of the command share."""

from tests.diagnose.conftest import bench

__all__ = ["bench"]
