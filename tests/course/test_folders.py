"""A student's folder in the states that it comes in: which tasks are done, and why others are not."""

import gzip
import json
import shutil
import sys

import numpy as np
import pytest

from bench.assets import asset
from bench.course.axis import Sources, lab_rig
from bench.course.course import course
from bench.course.flights import read_flights
from bench.course.record import record
from bench.course.recordings import LabRecordings
from bench.course.report import CourseReport, first_numbers, lab_json
from bench.errors import InputError
from bench.report.terminal import rendered
from bench.trace.read import read
from bench.trace.write import write
from tests.command import bench
from tests.course.conftest import as_a_student_has_them
from tests.course.mistakes import NAMES, SI, SIMULATED, results_of

TRACES = asset("data", "traces")
#: Tasks of each recording; of recordings that contradict the axis none of REFUSED is done.
ON_FRICTION = {"7", "8", "9", "range", "tracking"}
REFUSED = {"5", "6", "10"} | ON_FRICTION
RECORDED = {"1"} | REFUSED


def signals(folder, name):
    """time, velocity, current of a recording, which is taken away from the folder."""
    trace = read(folder / f"{name}.trace")
    (folder / f"{name}.trace").unlink()
    return trace.time, trace["velocity"], trace["current"]


def table(path, header, *columns, decimal="."):
    rows = (";".join(f"{value:.6g}".replace(".", decimal) for value in row) for row in zip(*columns, strict=True))
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")


def columns_of(folder, text):
    """A rig file that names the columns of the recordings."""
    (folder / "rig.toml").write_text(f"[trace.columns]\n{text}\n")


def as_it_is(folder):
    pass


def wrong_sign(folder):
    for name in NAMES:
        time, velocity, current = signals(folder, name)
        table(folder / f"{name}.csv", SI, time, velocity, -current)


def wrong_sign_turned_by_the_advice(folder):
    wrong_sign(folder)
    columns_of(folder, 'current = "-current [A]"')


def one_way(folder):
    _, velocity, current = signals(folder, "JLoadAndFriction")
    forward = (np.cumsum(velocity < 20.0) == np.argmax(velocity > 20.0)) & (velocity > 20.0)
    time = np.arange(forward.sum()) * 1e-3
    table(folder / "JLoadAndFriction.csv", SI, time, np.abs(velocity[forward]), current[forward] + 0.05 / 0.75)


def german_names(folder):
    for name in NAMES:
        time, velocity, current = signals(folder, name)
        columns = 1e3 * time, np.degrees(velocity), 1e3 * current, np.degrees(np.cumsum(velocity) * 1e-3)
        head = "Zeit [ms];Geschwindigkeit [Grad/s];Strom [mA];Lage [Grad]"
        table(folder / f"{name}.csv", head, *columns, decimal=",")


def group_suffixes(folder):
    for name, suffix in zip(NAMES, ("_Gruppe7", " (1)", "-group 12"), strict=True):
        (folder / f"{name}.trace").rename(folder / f"{name}{suffix}.trace")


def another_format_and_letters(folder):
    for name in NAMES:
        path = folder / f"{name}.trace"
        units = {"velocity": "rpm", "current": "A", "time": "us"}
        write(read(path), folder / f"{name.lower()}.csv.gz", units)
        path.unlink()


def named(head):
    """All three recordings with these names of their columns."""

    def made(folder):
        for name in NAMES:
            table(folder / f"{name}.csv", head, *signals(folder, name))

    return made


foreign_names, unknown_names = named("time [s];rOmega [rad/s];rI [A]"), named("time [s];ch2;ch3")


def unknown_names_in_the_advice(folder):
    unknown_names(folder)
    columns_of(folder, 'velocity = "ch2 [rad/s]"\ncurrent = "ch3 [A]"')


def a_full_rig(folder):
    text = asset("data", "rigs", "lab.toml").read_text(encoding="utf-8")
    motor = 'model = "SH30701P"'
    text = text[: text.index("[drive]")].replace(motor, f'{motor}\nrotor_inertia = "0.3 kg*cm**2"')
    (folder / "rig.toml").write_text(text)


def a_rig_of_another_motor(folder):
    (folder / "rig.toml").write_text('name = "mine"\nkind = "rotary"\n[motor]\ntorque_constant = "0.72 N*m/A"\n')


def two_samples(folder):
    (folder / "MaxAcc.trace").unlink()
    table(folder / "MaxAcc.csv", SI, [0.0, 0.001], [0.0, 1.0], [0.0, 1.0])


def at_rest(folder):
    for name, factor in (("JLoadAndFriction", 0.0), ("JLoadWithoutFriction", 1.0)):
        time, velocity, current = signals(folder, name)
        table(folder / f"{name}.csv", SI, time, 0.0 * velocity, factor * current)


def two_of_a_name(folder):
    (folder / "MaxAcc.csv.gz").write_bytes(gzip.compress(b"time [ms],velocity [rpm]\n0,1\n1,2\n"))


def a_file_missing_beside_others(folder):
    (folder / "JLoadAndFriction.trace").unlink()
    for name in ("MaxAcc.png", "MaxAcc.m"):
        (folder / name).write_bytes(b"not a recording")


def a_linear_axis(folder):
    (folder / "JLoadWithoutFriction.trace").unlink()
    count = np.arange(50.0)
    table(folder / "JLoadWithoutFriction.csv", "time [ms];velocity [mm/s];current [A]", count, count, 0.0 * count + 1.0)


def a_workbook(folder):
    (folder / "MaxAcc.trace").rename(folder / "MaxAcc.xlsx")


def damaged(folder):
    for name in NAMES:
        path = folder / f"{name}.trace"
        path.write_bytes(path.read_bytes()[:4001])


def without_flights(folder):
    shutil.rmtree(folder / "catapult")


def nothing_usable(folder):
    damaged(folder)
    without_flights(folder)


def empty(folder):
    shutil.rmtree(folder)
    folder.mkdir()


def flights_in_mm_without_a_unit(folder):
    points = np.concatenate(read_flights(folder / "catapult").points)
    without_flights(folder)
    table(folder / "catapult.csv", "y;z", *1e3 * points.T)


def flights_straight_up(folder):
    without_flights(folder)
    (folder / "catapult.csv").write_text("y [m],z [m]\n0,1\n0,2\n0,3\n0,2.5\n")


#: What was made of the folder, the tasks that then cannot be done, and words that say why.
STATES = [
    (as_it_is, set(), []),
    (wrong_sign, REFUSED, ["opposite signs", '[trace.columns] current = "-']),
    (wrong_sign_turned_by_the_advice, set(), []),
    (one_way, {"9", "tracking"}, ["one way only"]),
    (german_names, set(), []),
    (group_suffixes, set(), []),
    (another_format_and_letters, set(), []),
    (foreign_names, set(), []),
    (unknown_names, REFUSED, ['[trace.columns] and velocity = "ch2 [rad/s]" and current = "ch3 [A]"', "'ch2'"]),
    (unknown_names_in_the_advice, set(), []),
    (a_full_rig, set(), []),
    (a_rig_of_another_motor, {"3", "4", "10", "11", "range", "tracking"}, ["rotor_inertia", "kT(Iq)"]),
    (two_samples, {"10"}, ["MaxAcc"]),
    (at_rest, {"6", "8", "9", "tracking"}, ["speed never changes", "20 rad/s"]),
    (two_of_a_name, {"10"}, ["several"]),
    (a_file_missing_beside_others, ON_FRICTION, ["JLoadAndFriction.trace: no such file"]),
    (a_linear_axis, {"5", "6"}, ["linear"]),
    (a_workbook, {"10"}, ["MaxAcc.xlsx: is no recording, as files ending in .xlsx are not read; save it as CSV"]),
    (damaged, REFUSED, ["damaged"]),
    (without_flights, {"1"}, ["catapult"]),
    (nothing_usable, RECORDED, ["damaged", "catapult"]),
    (empty, RECORDED, ["no such file", "no recording"]),
    (flights_in_mm_without_a_unit, {"1"}, ["without a unit", "y [mm]"]),
    (flights_straight_up, {"1"}, ["fewer than three places"]),
]


@pytest.mark.parametrize(("state", "missing", "words"), STATES, ids=[state.__name__ for state, *_ in STATES])
def test_a_students_folder(state, missing, words, tmp_path, done):
    folder = as_a_student_has_them(tmp_path)
    state(folder)
    recordings, results = results_of(folder, SIMULATED - missing)
    assert CourseReport(results, []).usable == (not missing >= RECORDED)
    tasks = {task["key"]: task for task in json.loads(lab_json(results, recordings.rig.name))["tasks"]}
    reasons = {key: task["reason"] for key, task in tasks.items() if task["status"] == "not_done"}
    assert set(reasons) == missing, reasons
    shown = "".join(rendered(first_numbers(results), 80).plain.split())
    for word in words:
        assert any(word in reason for reason in reasons.values()), (word, reasons)
        assert "".join(word.split()) in shown, word
    for key in {"1", "6", "9", "10"} - missing:
        _is_as_without(tasks[key], done[key], same=state is not a_rig_of_another_motor)


def _is_as_without(task, reference, same):
    """Every number as from the recordings as they are: the file's form changes nothing."""
    for number in task["numbers"]:
        assert number["truth"] is None
        assert number["source"]
        if same and number["name"] in ("a", "b", "c", "J", "K_fric_w", "K_fric_0", "measured corner"):
            assert number["value"] == pytest.approx(reference[number["name"]].value, rel=2e-3), number["name"]


@pytest.mark.parametrize(("state", "status"), [(two_samples, 0), (empty, 1)])
def test_the_command_reports_a_folder_with_tasks_missing_without_typst_too(state, status, tmp_path, monkeypatch):
    """Page and sources leave out what is missing; without any recording the status says so, and one line the remedy."""
    monkeypatch.setitem(sys.modules, "typst", None)
    state(as_a_student_has_them(tmp_path / "data"))
    done = bench("lab", "--data", tmp_path / "data", "--out", tmp_path / "out")
    assert (done.status, done.err.count("\n"), "lab.pdf" in done.out) == (status, 1, False), done.err
    assert "pip install 'servobench[lab]'" in done.err
    assert "Not done: " in (tmp_path / "out" / "lab.html").read_text(encoding="utf-8")
    scripts = {path.name for path in (tmp_path / "out" / "sources").glob("task*.py")}
    assert "task03.py" in scripts and "task10.py" not in scripts
    assert ("task09.py" in scripts) == (state is two_samples)


def test_a_rig_without_simulation_loses_no_section(tmp_path):
    """What is simulated runs on the embedded example then; a rig that can be simulated is its own."""
    a_full_rig(as_a_student_has_them(tmp_path))
    assert LabRecordings.in_folder(tmp_path).example == lab_rig()
    assert LabRecordings.in_folder(tmp_path).rig.motor.rotor_inertia == pytest.approx(0.3e-4)
    text = asset("data", "rigs", "lab.toml").read_text(encoding="utf-8").replace("22.5 kg*cm**2", "30 kg*cm**2")
    (tmp_path / "rig.toml").write_text(text)
    assert LabRecordings.in_folder(tmp_path).example.simulation.moment_of_inertia == pytest.approx(30e-4)


def test_every_value_tells_its_source(tmp_path):
    (tmp_path / "rig.toml").write_text('[motor]\nmodel = "SH30701P"\nrotor_inertia = "0.3 kg*cm**2"\n')
    embedded, own = Sources.of(None), Sources.of(tmp_path / "rig.toml")
    assert embedded("motor", "cold_resistance_share") == "course"
    for section, key, of_embedded, of_own in (
        ("motor", "peak_torque", "datasheet", "datasheet"),
        ("motor", "rotor_inertia", "assumed", "rig file"),
        ("load", "outer_diameter", "embedded rig", "embedded rig"),
    ):
        assert (embedded(section, key), own(section, key)) == (of_embedded, of_own)


def test_another_disk_is_given_by_its_moment_of_inertia(tmp_path):
    """Of a disk of 19 kg*cm**2 the rig says 40: the reason names the disk, and the remedy works."""
    folder = as_a_student_has_them(tmp_path)

    def recorded(load):
        (folder / "rig.toml").write_text(f"[load]\n{load}\n")
        return LabRecordings.in_folder(folder).sound("JLoadAndFriction")

    with pytest.raises(InputError, match=r'what the disk has in theory.*moment_of_inertia = "30 kg\*cm\*\*2"'):
        recorded('moment_of_inertia = "40 kg*cm**2"')
    assert recorded('moment_of_inertia = "19.2 kg*cm**2"').time.size > 100
    with pytest.raises(InputError, match="either moment_of_inertia or the geometry"):
        recorded('moment_of_inertia = "19.2 kg*cm**2"\nouter_diameter = "1 m"\nmass = "1 kg"')


def test_no_folder_is_an_error(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        LabRecordings.in_folder(tmp_path / "nowhere")


@pytest.mark.parametrize("name", NAMES)
def test_recordings_are_machine_expert_traces_in_the_labs_units(name):
    trace = read(TRACES / f"{name}.trace")
    assert trace.metadata["format"] == "CODESYS / Machine Expert trace"
    assert trace.metadata["Comment"] == "units: velocity [deg/s], current [mA]"
    assert set(trace.signals) == {"velocity", "current"}
    assert trace.sample_period == pytest.approx(1e-3)
    truth = json.loads((TRACES / f"{name}.trace.truth.json").read_text())["parameters"]["moment_of_inertia"]
    assert truth == {"value": pytest.approx(0.00225), "unit": "kg*m**2"}


def test_the_command_makes_the_recordings_again(tmp_path):
    written = {path.relative_to(tmp_path) for path in record(tmp_path)}
    assert written == {path.relative_to(TRACES) for path in TRACES.rglob("*") if path.is_file()}
    for name in NAMES:
        again, stored = (read(where / f"{name}.trace") for where in (tmp_path, TRACES))
        for signal in ("velocity", "current"):
            # written to 1e-3 deg/s and 0.1 mA; processors differ in the last place
            assert again[signal] == pytest.approx(stored[signal], abs=2e-4)
    again, stored = (np.concatenate(read_flights(where / "catapult").points) for where in (tmp_path, TRACES))
    assert again == pytest.approx(stored, abs=2e-4)


def test_progress_is_reported_after_every_task():
    shares = []
    course(LabRecordings.in_folder(None), shares.append, keys={"2", "3", "4", "5"})
    assert shares == pytest.approx([0.25, 0.5, 0.75, 1.0])
