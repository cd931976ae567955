import json

import numpy as np
import pytest

from bench.report.inspection import inspection as document
from bench.report.terminal import show
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording, to_json
from bench.trace.read import read_recording
from tests.trace.recordings import csv_text

TIME = np.delete(np.arange(400) * 1e-3, np.arange(100, 140))
SPEED = np.round(50.0 * np.sin(2 * np.pi * 3.0 * TIME) / 0.25) * 0.25


@pytest.fixture
def inspection(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text(csv_text(TIME, velocity__rad_s=SPEED, current__mA=np.full(TIME.size, 7.0), spare__deg=TIME))
    return inspect_recording(read_recording(path), GivenOptions())


def test_numbers_and_their_json(inspection):
    assert (inspection.samples, inspection.segments, inspection.duplicates) == (360, 2, 0)
    assert (inspection.rate, inspection.duration) == (pytest.approx(1000.0), pytest.approx(0.399))
    assert inspection.holes == (pytest.approx((0.099, 0.041)),)
    assert not inspection.resampled and inspection.jitter < 1e-6
    assert inspection.dropped == ("spare [deg]",)
    speed, amps = inspection.signals
    assert (speed.minimum, speed.maximum) == (SPEED.min(), SPEED.max())
    assert (speed.rms, speed.resolution) == (pytest.approx(np.sqrt(np.mean(SPEED**2))), 0.25)
    assert (amps.column, amps.rms, amps.resolution) == ("current [mA]", pytest.approx(7e-3), None)
    content = json.loads(to_json(inspection))
    assert (content["schema"], content["signals"][0]["resolution"]) == ("bench.inspect/1", 0.25)
    assert content["holes"] == [pytest.approx([0.099, 0.041])]


def test_table(inspection, capsys):
    show(document(inspection))
    text = capsys.readouterr().out.replace("\N{NO-BREAK SPACE}", " ")
    words = ("CSV table", "360 samples in 2 segments", "at 1000 Hz", "0.041 s at 0.099 s", "spare [deg]", "constant")
    assert [word for word in (*words, "- 1 hole") if word not in text] == []
