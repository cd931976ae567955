"""Pages and figures of commands, as a user gets them."""

import re
import xml.etree.ElementTree

import numpy as np
import pytest
from PIL import Image

from bench.report.document import Chart, TimeGraph
from bench.report.publish import read_document
from bench.trace.write import write
from tests.diagnosis.test_commands import run_of
from tests.report.conftest import blocks


def text_of(page):
    return page.read_text(encoding="utf-8").replace("\N{NO-BREAK SPACE}", " ")


def test_identify_leaves_a_page_and_figures_with_estimates_and_the_floor(bench, tmp_path):
    for k in (1, 2):
        write(run_of(seed=k), f"run{k}.csv")
    asked = ("identify", "run1.csv", "run2.csv", "--rig", "rig.toml", "--out", "result", "--figures", "svg")
    status, out, _ = bench(*asked)
    assert status == 0
    assert {"wrote result/report.html", "wrote result/identification.svg"} <= {*out.splitlines()}
    page = read_document(tmp_path / "result" / "report.json")
    assert page.verdict.startswith("The moment of inertia is")
    assert len(blocks(page, TimeGraph)) == 2
    assert "run2.csv" in text_of(tmp_path / "result" / "report.html")
    root = xml.etree.ElementTree.parse(tmp_path / "result" / "identification.svg").getroot()
    text = " ".join(" ".join(root.itertext()).split())
    assert ("moment of inertia" in text, "±" in text) == (True, True)
    for chart in blocks(page, Chart):
        assert {one.style for panel in chart.panels for one in panel.series} == {"band", "dots"}
        assert len({panel.series[0].high for panel in chart.panels}) == 1


def test_figures_of_a_diagnosis_are_drawn(found):
    for name in ("where.png", "gaps.png"):
        with Image.open(found / name) as picture:
            assert picture.format == "PNG" and picture.width > 1000
            assert np.asarray(picture.convert("L")).std() > 10.0


def test_replay_writes_a_page_where_asked(bench, found, tmp_path):
    model, trace = found / "model.toml", found.parent / "holdout.csv"
    asked = ("replay", model, trace, "--rig", "rig.toml", "--out", "replay.csv")
    status, out, _ = bench(*asked, "--report", "replay.html")
    assert status == 0
    assert out.splitlines()[-2:] == ["wrote replay.csv", "wrote replay.html"]
    text = text_of(tmp_path / "replay.html")
    (left,) = re.findall(r"velocity gap ([\d.]+) of", out)
    assert f"off by {float(left):.3g} rad/s" in text
    for place, words in (("replay.txt", "allowed: .html"), (trace, "is an input of this command")):
        status, _, err = bench(*asked, "--report", place)
        assert (status, err.count("\n"), words in err) == (2, 1, True)


def test_friction_writes_a_page_where_asked(bench, tmp_path):
    from tests.friction_map.test_friction_command import STATIC, STRIBECK, steady

    names = steady(rise=STATIC - 0.06)
    status, out, _ = bench("friction", *names, "--rig", "rig.toml", "--report", "friction.html")
    assert status == 0
    assert "wrote friction.html" in out
    text = text_of(tmp_path / "friction.html")
    assert "Stribeck friction (static friction 0.07" in text
    (speed,) = re.findall(r"Stribeck velocity ([\d.]+) rad/s\)", text)[:1]
    assert float(speed) == pytest.approx(STRIBECK, rel=0.1)
