"""The commands of docs/validate.md run as they stand there, and what they write is what the contract says."""

import contextlib
import json

import pyarrow.parquet as pq
import pytest
from pyarrow import csv

from bench.cli import app
from tests.docs.pages import PAGES, run_commands


def brief(line):
    """One recording of what no test reads."""
    return line.replace("--rigs 4 --rig my.toml", "--rigs 1 --rig my.toml")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    home = tmp_path_factory.mktemp("manual")
    with contextlib.chdir(home):
        run_commands(PAGES["docs/validate.md"], brief)
    return home


def test_the_json_is_the_contracts(folder):
    found = json.loads((folder / "any.json").read_text(encoding="utf-8"))
    assert found["schema"] == "bench.validate/1"
    assert found["runs"]["asked"] == 4 == sum(found["runs"][name] for name in ("done", "refused", "failed"))
    assert found["naming"] is None
    inertia = next(each for each in found["coverage"] if (each["group"], each["quantity"]) == ("nulls", "inertia"))
    assert [each["level"] for each in inertia["inside"]] == [0.5, 0.8, 0.95]
    assert abs(inertia["bias"]) < 0.05
    assert found["provenance"]["options"]["seed"] == 1


def test_files_of_a_run_agree_with_each_other(folder):
    home = folder / "mine"
    found = json.loads((home / "validation.json").read_text(encoding="utf-8"))
    runs = pq.read_table(home / "runs.parquet")
    assert runs.column("hidden").to_pylist() == ["unbalance", "cogging_torque", ""]
    assert csv.read_csv(home / "runs.csv").num_rows == runs.num_rows == 3
    quantities = pq.read_table(home / "quantities.parquet").to_pylist()
    asked = [each for each in found["coverage"] if each["group"] == "nulls" and each["by"] == "identify"]
    mine = [row for row in quantities if row["by"] == "identify" and row["index"] % 3 == 2]
    assert sum(each["told"] for each in asked) == len(mine) == 3
    assert set(found["naming"]["named"]) == {"unbalance", "cogging_torque"}
    written = {path.name for path in home.iterdir()}
    assert {"coverage.png", "confusion.png", "validation.md", "report.html", "report.json"} <= written
    assert "This motion on this drive" in (home / "report.html").read_text(encoding="utf-8")


def test_the_least_that_ones_own_recording_shows_is_reported(folder):
    found = json.loads((folder / "least.json").read_text(encoding="utf-8"))
    assert found["schema"] == "bench.validate.into/1"
    assert found["recording"]["verdict"] == "nothing_missing"
    assert len(found["cases"]) == 10
    assert [(name, least["unit"]) for name, least in found["least_named"].items()] == [
        ("cogging_torque", "N*m"),
        ("stribeck_friction", "N*m"),
    ]
    for name, least in found["least_named"].items():
        named = [one["size"]["value"] for one in found["cases"] if one["effect"] == name and one["fate"] == "right"]
        assert least["value"] == min(named)


def test_what_was_put_in_is_reported_with_the_truth(folder):
    found = json.loads((folder / "two.json").read_text(encoding="utf-8"))
    assert "least_named" not in found
    assert [one["strength"] for one in found["fates"]] == [2.0, 5.0]
    for case in found["cases"]:
        torque = case["quantities"]["torque"]
        assert (case["fate"], case["names"]) == ("right", ["torque_offset"])
        assert torque["found"]["ci95"][0] < torque["true"] < torque["found"]["ci95"][1]
        assert abs(torque["true"]) == pytest.approx(case["strength"] * found["recording"]["left"]["value"], rel=0.1)
    assert {"report.html", "injections.json"} <= {path.name for path in (folder / "into").iterdir()}


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        (["--into", "run.csv"], "--into: found without --rig"),
        (["--effect", "backlash"], "found without --into"),
        (["--into", "run.csv", "--rig", "my.toml", "--effect", "coging_torque"], "did you mean 'cogging_torque'"),
        (["--into", "run.csv", "--rig", "my.toml", "--strength", "-2"], "--strength: found -2"),
        (["--effects", "3-1"], "allowed: 0 to 6"),
        (["--profile", "monday.csv"], "allowed: with the rig"),
        (["--rig", "my.toml", "--profile", "monday.csv"], "allowed: the file of a recording"),
    ],
)
def test_bad_input_is_one_line(folder, monkeypatch, options, expected):
    monkeypatch.chdir(folder)
    with pytest.raises(Exception, match=expected):
        app(["validate", *options], standalone_mode=False)
