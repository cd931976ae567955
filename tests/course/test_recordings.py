"""The synthetic recordings: made by a command of the project, read by the reader that reads a student's."""

import gzip
import json
import shutil
import zipfile

import numpy as np
import pytest

from bench.assets import asset
from bench.course.course import course
from bench.course.flights import find_flights, read_flights
from bench.course.record import record
from bench.course.recordings import LabRecordings
from bench.errors import InputError
from bench.trace.read import read
from bench.trace.write import write
from tests.course.conftest import as_a_student_has_them

TRACES = asset("data", "traces")
NAMES = ("JLoadWithoutFriction", "JLoadAndFriction", "MaxAcc")
OF_THE_RECORDING = {
    "JLoadWithoutFriction": {"5", "6"},
    "JLoadAndFriction": {"7", "8", "9", "range", "tracking"},
    "MaxAcc": {"10"},
}


@pytest.fixture
def folder(tmp_path):
    """A student's folder: the recordings without any truth beside them."""
    return as_a_student_has_them(tmp_path)


#: Tasks that recordings matter to, and quick ones that they do not; the others simulate for seconds.
READING = {"1", "2", "3", "4"}.union(*OF_THE_RECORDING.values())


def results(folder):
    done = course(LabRecordings.in_folder(folder), keys=READING)
    missed = {result.key: str(result.reason) for result in done if result.reason}
    return {result.key: result for result in done if not result.reason}, missed


@pytest.mark.parametrize("name", NAMES)
def test_recordings_are_machine_expert_traces_in_the_labs_units(name):
    trace = read(TRACES / f"{name}.trace")
    assert trace.metadata["format"] == "CODESYS / Machine Expert trace"
    assert trace.metadata["Comment"] == "units: velocity [deg/s], current [mA]"
    assert set(trace.signals) == {"velocity", "current"}
    assert trace.sample_period == pytest.approx(1e-3)
    assert (TRACES / f"{name}.trace").stat().st_size < 200_000
    truth = json.loads((TRACES / f"{name}.trace.truth.json").read_text())
    assert truth["parameters"]["moment_of_inertia"]["unit"] == "kg*m**2"
    assert truth["parameters"]["moment_of_inertia"]["value"] == pytest.approx(0.00225)


def test_the_command_makes_the_recordings_again(tmp_path):
    paths = record(tmp_path)
    assert {path.relative_to(tmp_path) for path in paths} == {
        path.relative_to(TRACES) for path in TRACES.rglob("*") if path.is_file()
    }
    for name in NAMES:
        again, stored = (read(where / f"{name}.trace") for where in (tmp_path, TRACES))
        for signal in ("velocity", "current"):
            # written to 1e-3 deg/s and 0.1 mA; processors differ in the last place
            assert again[signal] == pytest.approx(stored[signal], abs=2e-4)
    again, stored = (np.concatenate(read_flights(where / "catapult").points) for where in (tmp_path, TRACES))
    assert again == pytest.approx(stored, abs=2e-4)


def test_a_students_folder_gives_the_same_numbers_without_truth(folder, done):
    found, missed = results(folder)
    assert missed == {}
    for key in ("1", "6", "9", "10"):
        assert [n.value for n in found[key].numbers] == pytest.approx([n.value for n in done[key].numbers])
        assert all(number.truth is None for number in found[key].numbers)


@pytest.mark.parametrize("name", NAMES)
def test_with_a_file_missing_the_other_tasks_are_done(folder, name):
    (folder / f"{name}.trace").unlink()
    found, missed = results(folder)
    assert set(missed) == OF_THE_RECORDING[name]
    for reason in missed.values():
        assert f"{name}.trace" in reason
        assert "no such file" in reason
    assert set(found) == READING - OF_THE_RECORDING[name]


def test_without_the_catapult_all_else_is_done(folder):
    shutil.rmtree(folder / "catapult")
    found, missed = results(folder)
    assert set(missed) == {"1"}
    assert "catapult" in missed["1"]
    assert set(found) == READING - {"1"}


def misnamed(path):
    """The same recording with names that the bench does not know."""
    text = path.read_bytes().decode("utf-16")
    text = text.replace('VarName="velocity"', 'VarName="GVL.rOmega"').replace('VarName="current"', 'VarName="GVL.rI"')
    text = text.replace("units: velocity [deg/s], current [mA]", "")
    path.write_bytes(text.encode("utf-16"))


def test_misnamed_signals_are_named_and_a_rig_file_beside_them_helps(folder):
    misnamed(folder / "JLoadAndFriction.trace")
    found, missed = results(folder)
    assert set(missed) == OF_THE_RECORDING["JLoadAndFriction"]
    assert "GVL.rOmega" in missed["9"]
    assert {"6", "10"} <= set(found)
    for name in ("JLoadWithoutFriction", "MaxAcc"):
        misnamed(folder / f"{name}.trace")
    rig = asset("data", "rigs", "lab.toml").read_text(encoding="utf-8")
    columns = '[trace.columns]\nvelocity = "GVL.rOmega [deg/s]"\ncurrent = "GVL.rI [mA]"\n'
    (folder / "rig.toml").write_text(rig + columns, encoding="utf-8")
    found, missed = results(folder)
    assert missed == {}
    assert found["6"]["J"].value == pytest.approx(22.5, rel=0.005)


def test_other_units_other_formats_and_other_letters_are_read(folder):
    trace = read(folder / "JLoadWithoutFriction.trace")
    (folder / "JLoadWithoutFriction.trace").unlink()
    write(trace, folder / "jloadwithoutfriction.csv.gz", {"velocity": "rpm", "current": "A", "time": "us"})
    found, missed = results(folder)
    assert missed == {}
    assert found["6"]["J"].value == pytest.approx(22.5, rel=0.005)


def test_damaged_files_and_two_of_a_name_are_reported_to_be_so(folder):
    path = folder / "JLoadAndFriction.trace"
    path.write_bytes(path.read_bytes()[:5000])
    (folder / "MaxAcc.csv.gz").write_bytes(gzip.compress(b"time [ms],velocity [rpm]\n0,1\n1,2\n"))
    found, missed = results(folder)
    assert set(missed) == OF_THE_RECORDING["JLoadAndFriction"] | OF_THE_RECORDING["MaxAcc"]
    assert "damaged" in missed["9"]
    assert "several" in missed["10"]
    assert "6" in found


def test_other_files_beside_the_recordings_are_passed_over_and_linear_axes_refused(folder):
    for name in ("MaxAcc.png", "MaxAcc.m", "JLoadAndFriction.docx"):
        (folder / name).write_bytes(b"not a recording")
    (folder / "JLoadWithoutFriction.trace").unlink()
    slide = "time [ms],velocity [mm/s],current [A]\n" + "".join(f"{k},{k},1\n" for k in range(50))
    (folder / "JLoadWithoutFriction.csv").write_text(slide)
    found, missed = results(folder)
    assert set(missed) == OF_THE_RECORDING["JLoadWithoutFriction"]
    assert "linear" in missed["6"]
    assert {"9", "10"} <= set(found)


def test_progress_is_reported_after_every_task():
    shares = []
    course(LabRecordings.in_folder(None), shares.append, keys=READING)
    assert shares == sorted(shares)
    assert len(shares) == len(READING)
    assert shares[-1] == 1.0


def test_no_folder_is_an_error(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        LabRecordings.in_folder(tmp_path / "nowhere")


def test_catapult_from_a_zip_with_german_tables_in_other_units(tmp_path):
    flights = read_flights(TRACES / "catapult").points
    with zipfile.ZipFile(tmp_path / "Katapult.zip", "w") as archive:
        for k, flight in enumerate(flights):
            rows = "\n".join(f"{100 * y:.4f};{100 * z:.4f}".replace(".", ",") for y, z in flight)
            archive.writestr(f"data/versuch{k:02}.txt", f"y [cm];z [cm]\n{rows}\n")
        archive.writestr("data/readme.md", "not a table")
    again = read_flights(find_flights(tmp_path)).points
    assert len(again) == 10
    assert np.concatenate(again) == pytest.approx(np.concatenate(flights), abs=1e-9)


def test_catapult_tables_without_head_with_time_or_turned(tmp_path):
    (tmp_path / "catapult1.txt").write_text("0.0 1.0\n1.0 2.0\n2.0 1.5\n")
    assert read_flights(find_flights(tmp_path)).points[0].tolist() == [[0.0, 1.0], [1.0, 2.0], [2.0, 1.5]]
    (tmp_path / "catapult1.txt").write_text("t [s],z [mm],y [m]\n0,1000,0\n1,2000,1\n2,1500,2\n")
    assert read_flights(find_flights(tmp_path)).points[0].tolist() == [[0.0, 1.0], [1.0, 2.0], [2.0, 1.5]]


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("y,z\n1,2\n", "at least three"),
        ("y [kg],z [m]\n1,2\n2,3\n3,4\n", "kg"),
        ("y,z\n1,2\n2,three\n3,4\n", "line 3"),
        ("", "at least three"),
    ],
)
def test_bad_catapult_tables_are_refused(tmp_path, text, word):
    (tmp_path / "catapult.csv").write_text(text)
    with pytest.raises(InputError, match=word):
        read_flights(tmp_path / "catapult.csv")
    (tmp_path / "catapult.zip").write_bytes(b"PK no zip")
    with pytest.raises(InputError, match="zip"):
        read_flights(tmp_path / "catapult.zip")
