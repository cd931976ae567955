"""A fleet as a user meets it: a row for every recording whatever it does, once, and the same table every time."""

import json
import logging
import re
import shutil
from dataclasses import replace

import fsspec
import numpy as np
import pyarrow.parquet as pq
import pytest
from distributed import LocalCluster

from bench.fleet.fleet import fleet
from bench.jobs.process import Limits
from bench.trace.write import write
from tests.command import bench
from tests.diagnosis.command import RIG
from tests.docs.pages import PAGES, run_commands
from tests.fit.motions import NAMES, Truth, recording
from tests.fleet.made import DAMAGES, fleet_of, missing
from tests.fleet.storage import Deadly, Never, offer

STORAGES = ("never", "deadly")
LIMITS = Limits(deadline=12.0)  # far beyond what a busy machine takes for the others


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A manifest of two axes that are recorded eight times, of which one changes, and of whatever goes wrong."""
    folder = tmp_path_factory.mktemp("fleet")
    made = fleet_of(folder, axes=2, each=8, changed={1})
    for place, damage in enumerate(DAMAGES):
        damage(folder / f"{damage.__name__}.csv.gz")
        made.add(f"{damage.__name__}.csv.gz", "press 0", 8 + place)
    made.add("press_0_0.csv.gz", "press 2", 0, rig="no_such_rig.toml")
    made.add("never://disk/1.csv", "press 2", 1)
    made.add("deadly://disk/2.csv", "press 2", 2)
    made.add(f"file://{folder}/press_0_1.csv.gz", "press 2", 3)
    made.add("of_another_unit.csv", "press 2", 4)
    trace = recording(np.random.default_rng(0), duration=3.0)
    columns = np.stack([trace.time, trace["velocity"], 1e3 * trace["current"]], axis=1)
    head = "time [s],velocity [rad/s],current [MA]"
    np.savetxt(folder / "of_another_unit.csv", columns, delimiter=",", header=head, comments="")
    offer(folder / "site")
    return made.write()


@pytest.fixture(scope="module", autouse=True)
def broken_storage(made):
    """Known here and, by its entry points, to every process that is started from here."""
    for storage in (Never, Deadly):
        fsspec.register_implementation(storage.protocol, storage)
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(made.parent / "site")
        yield


@pytest.fixture(scope="module")
def cluster(broken_storage):
    """A Dask worker, as somebody else may have started it."""
    quiet = {"dashboard_address": "127.0.0.1:0", "silence_logs": logging.CRITICAL}
    with LocalCluster(1, threads_per_worker=1, **quiet) as cluster:
        yield cluster


@pytest.fixture(scope="module")
def found(made):
    """The fleet, its folder and the rows of its table, by one process."""
    out = made.parent / "out"
    fleet_ = fleet(made, out, storages=STORAGES, limits=LIMITS, workers=1)
    return fleet_, out, pq.read_table(out / "fleet.parquet").to_pylist()


def test_every_recording_has_a_row_in_the_manifests_order(made, found):
    _, _, rows = found
    named = [line.split(",")[0] for line in made.read_text().splitlines()[1:]]
    assert [row["file"] for row in rows] == named
    statuses = {row["file"]: row["status"] for row in rows[:-5]}
    assert {statuses[name] for name in named[:16]} == {"done"}
    for damage in DAMAGES:
        assert statuses[f"{damage.__name__}.csv.gz"] == ("missing" if damage is missing else "refused")
    assert [row["status"] for row in rows[-5:]] == ["missing", "timed_out", "failed", "done", "done"]
    assert all((row["reason"] is None) == (row["status"] == "done") for row in rows)


def test_reasons_say_what_was_found_without_where_it_lay(made, found):
    reasons = {row["file"]: row["reason"] for row in found[2] if row["reason"]}
    assert reasons["missing.csv.gz"] == "recording: no such file; give the path of a file"
    assert "pipe or a device" in reasons["pipe.csv.gz"]
    assert "the file is empty" in reasons["empty.csv.gz"]
    assert reasons["never://disk/1.csv"] == "no result within 12 s"
    assert reasons["deadly://disk/2.csv"] == "its worker was killed (SIGKILL)"
    assert not any(str(made.parent) in reason for reason in reasons.values())


def test_the_row_is_what_identify_tells(made, found):
    row, target = found[2][0], made.parent / "single.json"
    bench("identify", made.parent / row["file"], "--rig", made.parent / "rig.toml", "--json", target)
    single = json.loads(target.read_text())
    for name, truth in zip(NAMES, Truth().values, strict=True):
        assert row[name] == single["parameters"][name]["value"] == pytest.approx(truth, rel=0.05)
        assert row[f"{name}_std_error"] == single["parameters"][name]["std_error"]
        assert row[f"{name}_unit"] == single["parameters"][name]["unit"]
    assert row["explained"] == single["explained"]
    assert row["gap_torque"] == single["residual"]["rms"]
    assert (row["rig_sha256"], row["trace_sha256"]) == (
        single["provenance"]["rig_sha256"],
        single["provenance"]["traces"][0]["sha256"],
    )
    assert row["shift"] == "000"  # carried along as it was


def test_a_copy_of_a_url_tells_the_same_and_what_is_assumed_of_a_unit_is_a_warning(found):
    rows = {row["file"]: row for row in found[2]}
    url = next(name for name in rows if name.startswith("file://"))
    for name in ("moment_of_inertia", "trace_sha256"):
        assert rows[url][name] == rows["press_0_1.csv.gz"][name]
    told = [json.loads(path.read_text("utf-8")).get("warnings", []) for path in (found[1] / "results").rglob("*.json")]
    assert [one for warnings in told for one in warnings if "MA taken as mA" in one]


def test_only_what_is_missing_is_done_and_the_table_is_the_same_to_the_byte(made, found):
    first, out, _ = found
    assert first.evaluated == 16 + 5 + 2 + 2  # all but what cannot be begun: missing, pipe, no rig
    table = (out / "fleet.parquet").read_bytes()
    again = fleet(made, out, storages=STORAGES, limits=LIMITS, workers=1)
    assert again.evaluated == 0
    assert (out / "fleet.parquet").read_bytes() == table
    results = sorted((out / "results").rglob("*.json"))
    results[0].unlink()
    results[1].write_text("{")
    (out / "fleet.parquet").unlink()
    assert fleet(made, out, storages=STORAGES, limits=LIMITS, workers=1).evaluated == 2
    assert (out / "fleet.parquet").read_bytes() == table


@pytest.mark.slow  # `tests/jobs` has Dask beside each run of the tests
def test_on_dask_the_table_is_the_same_to_the_byte(made, found, cluster):
    out = made.parent / "on_dask"
    assert fleet(made, out, storages=STORAGES, limits=LIMITS, scheduler=cluster.scheduler_address).evaluated == 25
    assert (out / "fleet.parquet").read_bytes() == (found[1] / "fleet.parquet").read_bytes()


def test_another_trace_rig_or_option_is_another_result(made, tmp_path):
    folder = tmp_path / "fleet"
    made = fleet_of(folder, axes=1, each=2)
    path, out = made.write(), tmp_path / "out"
    assert fleet(path, out, workers=1).evaluated == 2
    shutil.copy(folder / "press_0_1.csv.gz", folder / "press_0_0.csv.gz")
    assert fleet(path, out, workers=1).evaluated == 0  # what it holds now is known
    rig = (folder / "rig.toml").read_text()
    (folder / "rig.toml").write_text(rig.replace("0.8 N*m/A", "0.9 N*m/A"))
    assert fleet(path, out, workers=1).evaluated == 1  # the same recording twice is one
    rows = pq.read_table(out / "fleet.parquet").to_pylist()
    assert rows[0]["moment_of_inertia"] == rows[1]["moment_of_inertia"] == pytest.approx(1.5e-3 * 0.9 / 0.8, rel=0.02)


def test_the_axis_that_changed_is_named_with_its_day(found):
    (changed,) = found[0].summary.changed
    assert (changed.history.axis, changed.history.quantity, changed.since) == (
        "press 1",
        NAMES[2],
        "2026-01-05 06:00:00",
    )
    assert changed.file == "press_1_4.csv.gz"
    assert changed.step.after / changed.step.before == pytest.approx(1.15, abs=0.03)
    assert changed.chance < 0.01


def test_who_needs_a_person_is_reported_gravest_first(found):
    concerns = [(one.axis, one.kind, one.recordings, one.of) for one in found[0].summary.concerns]
    assert concerns == [
        ("press 2", "failed", 1, 5),
        ("press 2", "timed_out", 1, 5),
        ("press 2", "missing", 1, 5),
        ("press 0", "missing", 1, 15),
        ("press 0", "refused", 6, 15),
    ]


def test_the_command_prints_and_writes_what_it_found(made, found):
    out = made.parent / "out"
    allowed = [word for one in STORAGES for word in ("--storage", one)]
    status, printed, _ = bench("fleet", made, "--out", out, "--workers", 1, *allowed)
    assert status == 0
    for line in ("28 recordings of 3 axes", "18 done, 2 missing, 6 refused, 1 failed, 1 timed out", "0 evaluated now"):
        assert line in printed
    assert "press 1" in printed
    summary = json.loads((out / "summary.json").read_text())
    assert summary["schema"] == "bench.fleet/1"
    assert summary["recordings"] == {"total": 28, "done": 18, "missing": 2, "refused": 6, "failed": 1, "timed_out": 1}
    assert [one["quantity"] for one in summary["changed"]] == ["coulomb_friction_torque"]
    assert summary["attention"][1]["reason"] == "no result within 12 s"
    page = (out / "fleet.html").read_text(encoding="utf-8")
    assert "1 of 3 axes changed" in page
    assert "press 1: Coulomb friction torque" in page


def test_effects_are_named_where_that_is_asked_for(tmp_path):
    made = fleet_of(tmp_path / "fleet", axes=1, each=2)
    trace = recording(np.random.default_rng(0), duration=4.0, position=True)
    more = 0.12 * np.sin(trace["position"]) / 0.8
    unbalanced = replace(trace, signals={**trace.signals, "current": trace["current"] + more})
    write(unbalanced, made.folder / "press_0_1.csv.gz")
    found = fleet(made.write(), tmp_path / "out", diagnose=True, workers=1)
    plain, heavy = pq.read_table(tmp_path / "out" / "fleet.parquet").to_pylist()
    assert (plain["verdict"], plain["names"]) == ("nothing_missing", [])
    assert (heavy["verdict"], heavy["names"]) == ("explained", ["unbalance"])
    assert plain["gap_torque_before"] == plain["gap_torque"]
    assert heavy["gap_torque_before"] > 2.0 * heavy["gap_torque"]
    assert heavy["gap_velocity"] > 0.0
    assert heavy["explained"] < plain["explained"]
    (named,) = found.summary.shown
    assert (named.name, named.recordings, named.of, named.since) == ("unbalance", 1, 2, "2026-01-02 06:00:00")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("file,axis\na.csv,x\n", "rig is missing"),
        ("file,rig\n,rig.toml\n", "row 1: file"),
        ("file,rig,time\na.csv,rig.toml,yesterday\n", "found 'yesterday'"),
        ("file,rig,status\na.csv,rig.toml,7\n", "status: found a column that the fleet's table has too"),
        ("file,rig,file\na,b,c\n", "found this column twice"),
        ("file,rig\n", "found no recording"),
        ("", "found no table"),
        ("file,rig\na.csv\n", "found no table"),
    ],
)
def test_a_bad_manifest_is_one_line(text, expected, tmp_path):
    (tmp_path / "fleet.csv").write_text(text)
    status, _, message = bench("fleet", tmp_path / "fleet.csv", "--out", tmp_path / "out")
    assert (status, message.count("\n")) == (2, 1)
    assert expected in message
    assert not (tmp_path / "out").exists()


def test_an_output_is_never_an_input(tmp_path):
    made = fleet_of(tmp_path, axes=1, each=1)
    (tmp_path / "press_0_0.csv.gz").rename(tmp_path / "fleet.parquet")
    made.rows = [made.rows[0].replace("press_0_0.csv.gz", "fleet.parquet")]
    status, _, message = bench("fleet", made.write(), "--out", tmp_path)
    assert (status, "is an input of this command" in message) == (2, True)


def test_the_manuals_commands_run(tmp_path, cluster, monkeypatch):
    manual = PAGES["docs/fleet.md"]
    (example,) = re.findall(r"^```csv\n(.*?)^```", manual, re.MULTILINE | re.DOTALL)
    (tmp_path / "fleet.csv").write_text(example)
    (tmp_path / "rig.toml").write_text(RIG)
    for row, line in enumerate(example.splitlines()[1:]):
        write(recording(np.random.default_rng(row), duration=2.0, position=True), tmp_path / line.split(",")[0])
    monkeypatch.chdir(tmp_path)
    done = run_commands(manual, lambda line: line.replace("tcp://scheduler:8786", cluster.scheduler_address))
    assert len(done) == 4
    assert any("3 recordings of 2 axes" in one.out and "3 done" in one.out for one in done)
    columns = pq.read_table("result/fleet.parquet").column_names
    for name in re.findall(r"`(\w+)`", manual.partition("fleet.parquet`:")[2].partition("- `results`")[0]):
        assert any(name in column for column in columns), name
