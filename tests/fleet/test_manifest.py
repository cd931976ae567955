"""Whatever names and numbers a manifest carries, the fleet's table has them as they were."""

import csv
import hashlib

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bench.fleet.evaluate import PlannedRecording, plan
from bench.fleet.fleet import tabulate
from bench.fleet.manifest import read_manifest
from bench.rig.rig import shipped

NAMES = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1)
#: Of a CSV, whose cells have no line ends, and are numbers where they look like numbers.
WORDS = st.text(st.characters(exclude_categories=["Cs", "Cc"]), min_size=1).map(lambda text: f"n{text}")
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
FREELY = settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)


def through(tmp_path, manifest):
    """Its columns, as they come back from the fleet's table."""
    refusal = {"status": "refused", "reason": "none"}
    planned = PlannedRecording("", None, refusal, {"version": "1", "rig_sha256": None, "options": {}})
    table = tabulate(manifest, [planned] * len(manifest), [refusal] * len(manifest))
    pq.write_table(table, tmp_path / "fleet.parquet")
    return pq.read_table(tmp_path / "fleet.parquet").select(manifest.table.column_names).to_pydict()


@FREELY
@given(st.lists(st.tuples(NAMES, NAMES, NAMES, NUMBERS), min_size=1, max_size=5))
def test_a_parquet_manifest(tmp_path, rows):
    file, rig, note, time = (list(column) for column in zip(*rows, strict=True))
    columns = {"file": file, "rig": rig, "axis": note, "note": note, "time": time}
    pq.write_table(pa.table(columns), tmp_path / "m.parquet")
    manifest = read_manifest(tmp_path / "m.parquet")
    assert manifest.table.to_pydict() == columns
    assert manifest.text("note") == note and manifest.times.tolist() == time
    assert through(tmp_path, manifest) == columns


@FREELY
@given(st.lists(st.tuples(WORDS, WORDS, WORDS, NUMBERS), min_size=1, max_size=5))
def test_a_csv_manifest(tmp_path, rows):
    with (tmp_path / "m.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows([("file", "rig", "note", "time"), *((*words, repr(time)) for *words, time in rows)])
    manifest = read_manifest(tmp_path / "m.csv")
    assert [tuple(row.values())[:4] for row in manifest.table.to_pylist()] == rows
    assert through(tmp_path, manifest)["note"] == [row[2] for row in rows]


def test_a_rig_is_a_file_of_the_folder_or_else_a_shipped_one(tmp_path):
    """Only the folder's own `lab` is a path: what is in it decides, not its name; nothing is made of other names."""
    (tmp_path / "lab").touch()
    (tmp_path / "m.csv").write_text("file,rig\nemps,emps\na.csv,lab\na.csv,epms\n")
    manifest = read_manifest(tmp_path / "m.csv")
    assert manifest.located("rig") == [str(shipped()["emps"]), *(str(tmp_path / name) for name in ("lab", "epms"))]
    assert manifest.located("file")[0] == str(tmp_path / "emps")
    (planned, *_) = plan(manifest, False, (), None, 1, lambda share: None)
    assert planned.basis["rig_sha256"] == hashlib.sha256(shipped()["emps"].read_bytes()).hexdigest()


def test_a_time_that_is_not_known_leaves_the_others_numbers(tmp_path):
    """Without it the column was text, and refused; a shift 007 stays text beside an empty one."""
    (tmp_path / "m.csv").write_text("file,rig,time,shift\na,r,1,007\nb,r,,\nc,r,3,008\n")
    manifest = read_manifest(tmp_path / "m.csv")
    np.testing.assert_array_equal(manifest.times, [1.0, np.nan, 3.0])
    assert manifest.text("shift") == ["007", "", "008"]
