"""Diagrams one above the other on a screen of 400 px: whole, and no label off it."""

import numpy as np

from bench.course.result import chart, curve, panel
from bench.report.document import Document, Section
from bench.report.html import html

RIGHT = "[...document.querySelectorAll('figure svg, figure svg *')].map(e => e.getBoundingClientRect())"


def test_stacked_panels_fit_a_phone(opened, tmp_path):
    time = np.linspace(0.0, 6.0, 50)
    drawn = chart(
        "Stacked",
        panel("time / s", "error, backward / (1/s)", curve(time, 5e-4 * np.sin(time), "a"), curve(time, time, "b")),
        panel("time / s", "acceleration α / (rad/s²)", curve(time, -1.2e3 * np.sin(time))),
        panel("time / s", "error / (1/s)", curve(time, 2e-6 * np.sin(time))),
    )
    section = Section(key="one", heading="One", blocks=(drawn,))
    page = Document(title="t", subject="t", verdict="v", tone="sure", answers={}, sections=(section,))
    (tmp_path / "page.html").write_text(html(page), encoding="utf-8")
    shown = opened(tmp_path / "page.html", width=400)
    edges = shown.evaluate(f"{RIGHT}.map(r => [r.left, r.right])")
    assert len(edges) > 30
    assert min(left for left, _ in edges) >= 0.0
    assert max(right for _, right in edges) <= 400.0
    letters = shown.evaluate("[...document.querySelectorAll('svg text')].map(e => e.getBoundingClientRect().height)")
    assert min(letters) > 8.0  # to be read
