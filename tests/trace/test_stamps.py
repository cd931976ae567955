"""Times in two columns, whole seconds and nanoseconds, as messages of ROS and C's `timespec` have them."""

import numpy as np
import pytest

from bench.trace.channel import Channel, with_stamps
from bench.trace.read import read

EPOCH = 1_700_000_000


@pytest.mark.parametrize(
    ("whole", "part"), [("sec", "nsec"), ("header.stamp.sec", "header.stamp.nanosec"), ("tv_sec", "tv_nsec")]
)
def test_seconds_and_nanoseconds_are_one_time(tmp_path, whole, part):
    ticks = np.arange(4000) * 500_000 + 900_000_000
    velocity = 20.0 * np.sin(3e-9 * ticks)
    rows = zip(EPOCH + ticks // 10**9, ticks % 10**9, velocity.tolist(), np.cos(3e-9 * ticks).tolist(), strict=True)
    lines = [f"{whole},{part},velocity [rad/s],torque [N*m]", *(",".join(map(str, row)) for row in rows)]
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    trace = read(tmp_path / "log.csv")
    assert trace.sample_period == pytest.approx(5e-4, rel=1e-9)
    assert (len(trace), len(trace.segments)) == (4000, 1)
    np.testing.assert_allclose(trace["velocity"], velocity)


@pytest.mark.parametrize(
    ("whole", "part"),
    [([0.25, 0.5], [1.0, 2.0]), ([1.0, 2.0], [0.0, 2e9]), ([1.0, 2.0], [-1.0, 0.0]), ([], [])],
)
def test_columns_that_are_no_stamp_stay_two(whole, part):
    channels = [Channel(name, None, np.array(values), "log") for name, values in (("sec", whole), ("nsec", part))]
    assert with_stamps(channels) == tuple(channels)
