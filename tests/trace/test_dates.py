"""Dates in a time column: days of the calendar, in the order of day and month that the file allows."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pyarrow as pa
import pytest

from bench.trace.read import read
from bench.trace.readers.arrow import seconds

DAY = 86400.0
FORMS = {
    "ISO": "%Y-%m-%d %H:%M:%S.%f",
    "ISO with T": "%Y-%m-%dT%H:%M:%S.%fZ",
    "ISO with zone": "%Y-%m-%d %H:%M:%S.%f000+01:00",
    "German": "%d.%m.%Y %H:%M:%S,%f",
    "German, short": "%d.%m.%y %H:%M:%S,%f",
    "Chinese": "%Y/%m/%d %H:%M:%S.%f",
    "British": "%d/%m/%Y %H:%M:%S.%f",
    "American": "%m/%d/%Y %I:%M:%S.%f %p",
}
#: Times of a day, which run on over midnight.
CLOCKS = ("%H:%M:%S.%f", "%H:%M:%S,%f", "%H:%M:%S:%f", "%I:%M:%S.%f %p", "%H:%M:%S")
#: Moments, each list with its true seconds by Python's own calendar.
SPANS = {
    "four days": [datetime(2024, 3, day, 10, 0, day, tzinfo=UTC) for day in (1, 5)],
    "over midnight": [datetime(2024, 2, 28, 23, 59, 59, tzinfo=UTC) + timedelta(seconds=k) for k in range(3)],
    "a leap day": [datetime(2024, 2, 28, 12, tzinfo=UTC), datetime(2024, 3, 1, 12, tzinfo=UTC)],
    "no leap day": [datetime(2023, 2, 28, 12, tzinfo=UTC), datetime(2023, 3, 1, 12, tzinfo=UTC)],
    "the new year": [datetime(2024, 12, 31, 23, 59, 59, tzinfo=UTC), datetime(2025, 1, 1, 0, 0, 1, tzinfo=UTC)],
    "backwards": [datetime(2024, 3, 15, 10, tzinfo=UTC), datetime(2024, 3, 14, 11, tzinfo=UTC)],
}


@pytest.mark.parametrize("span", SPANS)
@pytest.mark.parametrize("form", FORMS)
def test_seconds_between_moments_are_those_of_the_calendar(form, span):
    moments = SPANS[span]
    found = seconds(pa.array([moment.strftime(FORMS[form]) for moment in moments]))
    assert found == pytest.approx([(moment - moments[0]).total_seconds() for moment in moments], abs=1e-6)


@pytest.mark.parametrize("form", CLOCKS)
def test_a_clock_runs_on_over_midnight(form):
    found = seconds(pa.array([moment.strftime(form) for moment in SPANS["over midnight"]]))
    assert np.diff(found) == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("dates", [("03/01", "03/05"), ("01/03", "05/03"), ("3/1", "3/5")])
def test_the_order_of_day_and_month_is_the_one_in_which_the_recording_is_short(dates):
    found = seconds(pa.array([f"{date}/2024 10:00:00" for date in dates]))
    assert found == pytest.approx([0.0, 4.0 * DAY])


@pytest.mark.parametrize("date", ["31.02.2024", "2024-13-01", "00/00/2024", "2023-02-29"])
def test_what_is_no_date_is_no_moment(date):
    assert seconds(pa.array([f"{date} 10:00:00", f"{date} 10:00:01"])) is None


def test_an_earlier_date_later_in_a_file_is_sorted_and_reported(tmp_path):
    path = tmp_path / "log.csv"
    stamps = [f"2024-03-{5 if k < 50 else 1:02d} 10:00:{k * 0.01:06.3f}" for k in range(100)]
    path.write_text("time,velocity [rad/s]\n" + "".join(f"{one},{np.sin(k)}\n" for k, one in enumerate(stamps)))
    trace = read(path)
    np.testing.assert_allclose(trace["velocity"], np.sin(np.r_[50:100, 0:50]))
    assert np.diff(trace.time).max() == pytest.approx(4.0 * DAY - 0.99)
    assert any("earlier than the one before; sorted by time" in note for note in trace.notes)
