"""The benchmarks run, at sizes that measure nothing, and their page is written; no time is asserted."""

import numpy as np
import pytest
import typer

import bench
from bench.assets import asset
from bench.trace.write import write
from tests.hostile import ROOT
from tests.studies.benchmarks import __main__ as command
from tests.studies.benchmarks import (
    beside_before,
    beside_pyarrow,
    beside_stepping,
    diagnosing,
    starting,
)
from tests.studies.benchmarks.table import Table
from tests.studies.benchmarks.timing import Timed, in_turn


@pytest.mark.parametrize(
    ("measured", "rows"),
    [
        (lambda: beside_stepping.measured(steps=40, rounds=1), (7,)),
        (lambda: beside_pyarrow.measured((2000,), 1), (2,)),
    ],
    ids=["stepping", "reading"],
)
def test_each_measures_every_way(measured, rows):
    tables = measured()
    assert tuple(len(table.rows) for table in tables) == rows
    for table in tables:
        lines = table.markdown.splitlines()
        assert len({line.count("|") for line in lines[2:]}) == 1
        assert all(line.startswith("| ") for line in lines[2:])


def test_a_diagnosis_is_timed(tmp_path):
    rig = bench.load_rig(asset("data", "rigs", "sh30701p.toml"))
    write(bench.simulate(rig, "speed_staircase").trace.between(0.0, 3.0), tmp_path / "run.csv")
    files = tmp_path / "run.csv", "", asset("data", "rigs", "sh30701p.toml")
    (table,) = diagnosing.measured({"one": [files], "two": [files, files]})
    assert [row[:2] for row in table.rows] == [("one", "1"), ("two", "2")]
    assert all(float(row[2].removesuffix(" s")) > 0.0 for row in table.rows)


@pytest.mark.slow
def test_beside_an_earlier_commit_both_identify():
    (table,) = beside_before.measured(2.0, 1)
    assert [row[0] for row in table.rows] == [beside_before.BEFORE, "today", "ratio"]


@pytest.mark.slow
def test_whole_commands_are_timed():
    (table,) = starting.measured(3.0, 1, before=ROOT)
    assert len(table.rows) == 4


@pytest.mark.slow
def test_beside_sysid_both_find_the_axis():
    pytest.importorskip("tabulate", reason="pip install -e '.[benchmarks]'")
    from tests.studies.benchmarks import beside_sysid

    (run,) = beside_sysid.recordings(1, 3.0)
    ours, theirs = beside_sysid.by_bench(run), beside_sysid.by_sysid(run, 1e-3)
    np.testing.assert_allclose(ours.values, 1.0, atol=0.1)
    np.testing.assert_allclose(theirs.values, 1.0, atol=0.5)
    assert len(beside_sysid.compared({beside_sysid.OURS: [ours], "theirs": [theirs]}, 3.0).rows) == 2


def test_ways_take_turns():
    turns = []
    timed = in_turn({name: lambda name=name: turns.append(name) for name in "ab"}, 3)
    assert turns == ["a", "b"] * 4  # the first turn does not count
    assert [len(seconds) for seconds in timed.seconds.values()] == [3, 3]


def test_a_ratio_is_the_median_of_the_rounds():
    timed = Timed({"a": (2.0, 8.0, 90.0), "b": (1.0, 2.0, 3.0)})
    assert timed.ratio("a", "b") == 4.0
    assert timed.median("a") == 8.0


def benchmarks(figure):
    """Two that measure nothing."""

    def table():
        return [Table("Told.", ("", "ratio"), (("a", figure),))]

    return {"first": ("First", table), "second": ("Second", table)}


def test_the_page_holds_what_was_measured_and_keeps_what_was_not(tmp_path):
    command.measure([], tmp_path, benchmarks("1.00"))
    whole = (tmp_path / command.PAGE).read_text(encoding="utf-8")
    assert whole.index("## First") < whole.index("## Second")
    command.measure(["second"], tmp_path, benchmarks("2.00"))
    again = command.sections((tmp_path / command.PAGE).read_text(encoding="utf-8"))
    assert "1.00" in again["First"]
    assert "2.00" in again["Second"]


def test_an_unknown_name_is_reported():
    with pytest.raises(typer.BadParameter, match="found third; allowed: first, second"):
        command.measure(["third"], None, benchmarks(""))


def test_the_committed_page_is_of_these_benchmarks():
    page = (ROOT / "docs" / command.PAGE).read_text(encoding="utf-8")
    found = command.sections(page)
    assert list(found) == [heading for heading, _ in command.BENCHMARKS.values()]
    assert page == command.page(found)
