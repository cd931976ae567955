"""A student's folder in the states that it comes in: which tasks are done, and why others are not."""

import json
import shutil

import numpy as np
import pytest
import scipy.io

from bench.assets import asset
from bench.course.axis import Sources, lab_rig
from bench.course.flights import read_flights
from bench.course.recordings import LabRecordings
from bench.course.report import CourseReport, first_numbers, lab_json
from bench.errors import InputError
from bench.report.terminal import rendered
from bench.trace.read import read
from tests.command import bench
from tests.course.conftest import as_a_student_has_them
from tests.course.mistakes import SIMULATED, results_of

TRACES = asset("data", "traces")
SI = "time [s];velocity [rad/s];current [A]"
NAMES = ("JLoadWithoutFriction", "JLoadAndFriction", "MaxAcc")
ON_FRICTION = {"7", "8", "9", "range", "tracking"}
#: Of recordings that contradict the axis nothing is done.
REFUSED = {"5", "6", "10"} | ON_FRICTION
RECORDED = {"1", "5", "6", "10"} | ON_FRICTION


def signals(folder, name):
    """time, velocity, current of a recording, which is taken away from the folder."""
    path = folder / f"{name}.trace"
    trace = read(path)
    path.unlink()
    return trace.time, trace["velocity"], trace["current"]


def lines(*columns, separator=";", decimal="."):
    """Rows of numbers (n,) each as text."""
    rows = zip(*columns, strict=True)
    return "".join(separator.join(f"{value:.6g}".replace(".", decimal) for value in row) + "\n" for row in rows)


def table(path, header, *columns, decimal="."):
    path.write_text(f"{header}\n{lines(*columns, decimal=decimal)}", encoding="utf-8")


def as_it_is(folder):
    pass


def wrong_sign(folder):
    for name in NAMES:
        time, velocity, current = signals(folder, name)
        table(folder / f"{name}.csv", SI, time, velocity, -current)


def wrong_sign_turned_by_the_advice(folder):
    wrong_sign(folder)
    (folder / "rig.toml").write_text('[trace.columns]\ncurrent = "-current [A]"\n')


def one_way(folder):
    _, velocity, current = signals(folder, "JLoadAndFriction")
    forward = np.cumsum(velocity < 20.0) == np.argmax(velocity > 20.0)
    forward &= velocity > 20.0
    shifted = np.abs(velocity[forward]), current[forward] + 0.05 / 0.75
    rows = np.arange(forward.sum()) * 1e-3
    table(folder / "JLoadAndFriction.csv", SI, rows, *shifted)


def german_names(folder):
    for name in NAMES:
        time, velocity, current = signals(folder, name)
        head = "Zeit [ms];Geschwindigkeit [Grad/s];Strom [mA];Lage [Grad]"
        lage = np.cumsum(velocity) * 1e-3
        table(
            folder / f"{name}.csv", head, 1e3 * time, np.degrees(velocity), 1e3 * current, np.degrees(lage), decimal=","
        )


def group_suffixes(folder):
    for name, suffix in zip(NAMES, ("_Gruppe7", " (1)", "-group 12"), strict=True):
        (folder / f"{name}.trace").rename(folder / f"{name}{suffix}.trace")


def foreign_names(folder):
    for name in NAMES:
        time, velocity, current = signals(folder, name)
        table(folder / f"{name}.csv", "time [s];rOmega [rad/s];rI [A]", time, velocity, current)


def unknown_names(folder):
    for name in NAMES:
        time, velocity, current = signals(folder, name)
        table(folder / f"{name}.csv", "time [s];ch2;ch3", time, velocity, current)


def unknown_names_in_the_advice(folder):
    unknown_names(folder)
    (folder / "rig.toml").write_text('[trace.columns]\nvelocity = "ch2 [rad/s]"\ncurrent = "ch3 [A]"\n')


def a_full_rig(folder):
    text = asset("data", "rigs", "lab.toml").read_text(encoding="utf-8")
    text = text[: text.index("[drive]")].replace(
        'model = "SH30701P"', 'model = "SH30701P"\nrotor_inertia = "0.3 kg*cm**2"'
    )
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


def damaged(folder):
    for name in NAMES:
        path = folder / f"{name}.trace"
        path.write_bytes(path.read_bytes()[:4001])


def nothing_usable(folder):
    damaged(folder)
    shutil.rmtree(folder / "catapult")


def empty(folder):
    shutil.rmtree(folder)
    folder.mkdir()


def flights(folder):
    points = read_flights(folder / "catapult").points
    shutil.rmtree(folder / "catapult")
    return points


def a_file_each(folder, ending, text):
    """Flights in files of their own, as `text` of y - m -, z - m - and time - s - has them."""
    points = flights(folder)
    (folder / "catapult").mkdir()
    for k, flight in enumerate(points):
        content = text(*flight.T, 0.02 * np.arange(len(flight)))
        (folder / "catapult" / f"{k:02}.{ending}").write_text(content)


def flights_in_another_order(folder):
    a_file_each(folder, "csv", lambda y, z, t: "z [mm];y [mm];t [s]\n" + lines(1e3 * z, 1e3 * y, t))


def flights_y_z_t(folder):
    a_file_each(folder, "csv", lambda y, z, t: "y,z,t\n" + lines(y, z, t, separator=","))


def flights_with_blanks_and_decimal_commas(folder):
    a_file_each(folder, "txt", lambda y, z, t: "y [m]  z [m]\n\n" + lines(y, z, separator="  ", decimal=",") + "\n")


def flights_side_by_side(folder):
    points = flights(folder)
    header = ";".join(f"y{k} [m];z{k} [m]" for k in range(1, 11))
    table(folder / "Katapult.csv", header, *(side for flight in points for side in flight.T), decimal=",")


def flights_in_mat(folder):
    points = np.array(flights(folder))
    scipy.io.savemat(folder / "Katapult_Gruppe7.mat", {"y": points[..., 0].T, "z": points[..., 1].T})


def flights_with_a_readme(folder):
    (folder / "catapult" / "readme.txt").write_text("Ten flights, recorded on a Monday.\ny, z in m\n")


def flights_in_mm_without_a_unit(folder):
    points = flights(folder)
    table(folder / "catapult.csv", "y;z", *(1e3 * np.concatenate(points)).T)


def flights_straight_up(folder):
    shutil.rmtree(folder / "catapult")
    (folder / "catapult.csv").write_text("y [m],z [m]\n0,1\n0,2\n0,3\n0,2.5\n")


#: What was made of the folder, the tasks that then cannot be done, and words that say why.
STATES = [
    (as_it_is, set(), []),
    (wrong_sign, REFUSED, ["opposite signs", '[trace.columns] current = "-']),
    (wrong_sign_turned_by_the_advice, set(), []),
    (one_way, {"9", "tracking"}, ["one way only"]),
    (german_names, set(), []),
    (group_suffixes, set(), []),
    (foreign_names, set(), []),
    (
        unknown_names,
        RECORDED - {"1"},
        ['[trace.columns] and velocity = "ch2 [rad/s]" and current = "ch3 [A]"', "'ch2'"],
    ),
    (unknown_names_in_the_advice, set(), []),
    (a_full_rig, set(), []),
    (a_rig_of_another_motor, {"3", "4", "10", "11", "range", "tracking"}, ["rotor_inertia", "kT(Iq)"]),
    (two_samples, {"10"}, ["MaxAcc"]),
    (at_rest, {"6", "8", "9", "tracking"}, ["speed never changes", "20 rad/s"]),
    (damaged, RECORDED - {"1"}, ["damaged"]),
    (nothing_usable, RECORDED, ["damaged", "catapult"]),
    (empty, RECORDED, ["no such file", "no recording"]),
    (flights_in_another_order, set(), []),
    (flights_y_z_t, set(), []),
    (flights_side_by_side, set(), []),
    (flights_with_blanks_and_decimal_commas, set(), []),
    (flights_in_mat, set(), []),
    (flights_with_a_readme, set(), []),
    (flights_in_mm_without_a_unit, {"1"}, ["without a unit", "y [mm]"]),
    (flights_straight_up, {"1"}, ["fewer than three places"]),
]


@pytest.mark.parametrize(("state", "missing", "words"), STATES, ids=lambda value: getattr(value, "__name__", ""))
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
def test_the_command_reports_a_folder_with_tasks_missing(state, status, tmp_path):
    """Page and sources leave out what is missing; without any recording the status says so."""
    state(as_a_student_has_them(tmp_path / "data"))
    done = bench("lab", "--data", tmp_path / "data", "--out", tmp_path / "out")
    assert (done.status, "Traceback" in done.out + done.err) == (status, False), done.err
    assert "Not done: " in (tmp_path / "out" / "lab.html").read_text(encoding="utf-8")
    scripts = {path.name for path in (tmp_path / "out" / "sources").glob("task*.py")}
    assert "task03.py" in scripts and "task10.py" not in scripts
    assert ("task09.py" in scripts) == (state is two_samples)


def test_flights_of_several_kinds_are_one_and_the_same(tmp_path):
    shutil.copytree(TRACES / "catapult", tmp_path / "catapult")
    points = np.array(read_flights(tmp_path / "catapult").points)
    shapes = {
        "matrices": {f"flight{k}": flight for k, flight in enumerate(points)},
        "numbered": {f"{side}{k}": flight[:, j] for k, flight in enumerate(points) for j, side in enumerate("yz")},
        "structs": {f"exp{k}": {"y": flight[:, 0], "z": flight[:, 1]} for k, flight in enumerate(points)},
        "block": {"flights": points},
    }
    for name, content in shapes.items():
        scipy.io.savemat(tmp_path / f"{name}.mat", content)
        assert np.array(read_flights(tmp_path / f"{name}.mat").points) == pytest.approx(points), name
    rows = "\n".join(f"{k},{y},{z}" for k, flight in enumerate(points, 1) for y, z in flight)
    (tmp_path / "all.csv").write_text(f"flight,y [m],z [m]\n{rows}\n")
    assert np.array(read_flights(tmp_path / "all.csv").points) == pytest.approx(points)
    (tmp_path / "bad.mat").write_bytes((tmp_path / "block.mat").read_bytes()[:200])
    with pytest.raises(Exception, match=r"bad\.mat"):
        read_flights(tmp_path / "bad.mat")


def test_a_rig_without_simulation_loses_no_section(tmp_path):
    """What is simulated runs on the embedded example then; a rig that can be simulated is its own."""
    a_full_rig(as_a_student_has_them(tmp_path))
    assert LabRecordings.in_folder(tmp_path).example == lab_rig()
    assert LabRecordings.in_folder(tmp_path).rig.motor.rotor_inertia == pytest.approx(0.3e-4)
    text = asset("data", "rigs", "lab.toml").read_text(encoding="utf-8").replace("22.5 kg*cm**2", "30 kg*cm**2")
    (tmp_path / "rig.toml").write_text(text)
    assert LabRecordings.in_folder(tmp_path).example.simulation.moment_of_inertia == pytest.approx(30e-4)


def test_every_value_tells_its_source(tmp_path):
    embedded = Sources.of(None)
    assert embedded("motor", "peak_torque") == "datasheet"
    assert embedded("motor", "rotor_inertia") == "assumed"
    assert embedded("motor", "cold_resistance_share") == "course"
    assert embedded("load", "outer_diameter") == "embedded rig"
    (tmp_path / "rig.toml").write_text('[motor]\nmodel = "SH30701P"\nrotor_inertia = "0.3 kg*cm**2"\n')
    own = Sources.of(tmp_path / "rig.toml")
    assert own("motor", "rotor_inertia") == "rig file"
    assert own("motor", "peak_torque") == "datasheet"
    assert own("load", "outer_diameter") == "embedded rig"


@pytest.mark.parametrize(("head", "refused"), [("y [m];z", True), ("y [m];z [mm]", False)])
def test_lengths_beyond_a_throw_need_a_unit_in_both_columns(tmp_path, head, refused):
    (tmp_path / "one.csv").write_text(f"{head}\n0;100\n1;900\n2;1000\n3;400\n")
    if refused:
        with pytest.raises(InputError, match="found lengths that span 900 without a unit"):
            read_flights(tmp_path)
    else:
        np.testing.assert_allclose(read_flights(tmp_path).points[0][:, 1], [0.1, 0.9, 1.0, 0.4])


@pytest.fixture
def own(tmp_path):
    """A folder with the course's recordings."""
    return as_a_student_has_them(tmp_path)


def reason(folder, name):
    with pytest.raises(InputError) as raised:
        LabRecordings.in_folder(folder).sound(name)
    return str(raised.value)


def test_a_workbook_is_called_what_it_is(own):
    (own / "MaxAcc.trace").rename(own / "MaxAcc.xlsx")
    assert "MaxAcc.xlsx: is no recording, as files ending in .xlsx are not read; save it as CSV" in reason(
        own, "MaxAcc"
    )
    shutil.rmtree(own / "catapult")
    (own / "Katapult.xlsx").write_bytes(b"PK")
    with pytest.raises(InputError, match=r"Katapult\.xlsx: is no table that can be read, as files ending in \.xlsx"):
        _ = LabRecordings.in_folder(own).flights


def test_another_disk_is_given_by_its_moment_of_inertia(own):
    """Of a disk of 19 kg*cm**2 the rig says 40: the reason names the disk, and the remedy works."""
    (own / "rig.toml").write_text('[load]\nmoment_of_inertia = "40 kg*cm**2"\n')
    text = reason(own, "JLoadAndFriction")
    assert "what the disk has in theory" in text
    assert 'moment_of_inertia = "30 kg*cm**2"' in text
    (own / "rig.toml").write_text('[load]\nmoment_of_inertia = "19.2 kg*cm**2"\n')
    assert LabRecordings.in_folder(own).sound("JLoadAndFriction").time.size > 100
    (own / "rig.toml").write_text(
        '[load]\nmoment_of_inertia = "19.2 kg*cm**2"\nouter_diameter = "1 m"\nmass = "1 kg"\n'
    )
    with pytest.raises(InputError, match="either moment_of_inertia or the geometry"):
        LabRecordings.in_folder(own)
