"""A page of ten million samples zooms and moves for as much CPU time of the browser as one of ten seconds."""

import pytest

from bench.report.html import html
from bench.report.over_time import time_graph
from tests.report.test_samples import page_of, recording

#: One key a frame: in, on, back and out again.
KEYS = [*["+"] * 6, *["ArrowRight"] * 6, *["ArrowLeft"] * 6, *["-"] * 6]
ROUNDS = 2
FRAMES = """async (keys) => { // where the view was in each frame that follows a key
  const place = document.querySelector(".graph"), range = document.querySelector(".range");
  place.scrollIntoView();
  const next = () => new Promise(requestAnimationFrame), found = [];
  for (let k = 0; k < 5; k++) await next();
  for (const key of keys) {
    place.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
    await next();
    found.push(range.value);
  }
  return found;
}"""


def cpu_time(page):
    """A clock of the time that the page's thread has run - s -, whatever else the machine does."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})

    def clock():
        metrics = session.send("Performance.getMetrics")["metrics"]
        return next(one["value"] for one in metrics if one["name"] == "TaskDuration")

    return clock


@pytest.mark.slow  # `test_samples.py` bounds what a page holds
@pytest.mark.parametrize("samples", [400_000, 10_000_000])
def test_a_long_recording_zooms_as_fluently_as_a_short_one(opened, tmp_path, samples):
    """Its page holds as much from 0.3 million samples on, so that the shorter test sees the same."""
    pages, seconds = [], [[], []]
    for count in (10_000, samples):
        time, signals = recording(count)
        path = tmp_path / f"{count}.html"
        path.write_text(html(page_of(time_graph("t", "a", time, signals, ("one", "other")))), encoding="utf-8")
        del time, signals
        page = opened(path)
        pages.append((page, cpu_time(page)))
    for _ in range(ROUNDS):
        for (page, clock), taken in zip(pages, seconds, strict=True):
            page.bring_to_front()
            before = clock()
            views = page.evaluate(FRAMES, KEYS)
            taken.append(clock() - before)
            assert len(set(views)) >= 12  # it did zoom and move
    short, long = (1e3 * min(taken) / len(KEYS) for taken in seconds)
    print(f"\n{samples} samples: {long:.1f} ms of CPU a frame, 10 000: {short:.1f} ms, ratio {long / short:.2f}")
    assert long < 1.5 * short
