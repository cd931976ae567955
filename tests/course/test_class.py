"""A class: every student's own axis, forms filled in right and wrong, and the command that grades them."""

import csv
import json
import re
from time import process_time

import numpy as np
import pytest

from bench.course.answers import ASKED
from bench.course.students import SCHEMA, seal
from bench.trace.read import read
from tests.command import bench

DEG, RPM = np.pi / 180.0, 30.0 / np.pi


class Student:
    """Works as the course says, with numpy alone; what a keyword changes is a mistake."""

    def __init__(self, folder):
        self.folder = folder
        self.runs = {}
        for name in ("JLoadWithoutFriction", "JLoadAndFriction", "MaxAcc"):
            trace = read(folder / f"{name}.trace")
            self.runs[name] = np.degrees(trace["velocity"]), 1e3 * trace["current"]
        text = (folder / "rig.toml").read_text(encoding="utf-8")

        def value(key):
            return float(re.search(rf'^{key} = "([\d.]+)', text, re.MULTILINE)[1])

        self.stall = value("continuous_stall_torque"), value("continuous_stall_current")
        self.peak = value("peak_torque"), value("peak_current")
        self.rotor = value("rotor_inertia")
        stall, peak = self.stall[0] / self.stall[1], self.peak[0] / self.peak[1]
        self.a = (peak - stall) / (self.peak[1] ** 2 - self.stall[1] ** 2)
        self.c = stall - self.a * self.stall[1] ** 2

    def torque(self, milliamperes, ampere=1e-3, constant=None):
        current = milliamperes * ampere
        return (self.a * current**2 + self.c if constant is None else constant) * current

    def answers(self, radian=DEG, set_back=2, width=4, rpm=RPM, fast=20.0, **torque):
        found = {"kT_stall": self.stall[0] / self.stall[1], "kT_peak": self.peak[0] / self.peak[1]}
        found |= {"kT_a": self.a, "kT_b": 0.0, "kT_c": self.c}
        files = sorted((self.folder / "catapult").glob("*.csv"))
        y, z = np.concatenate([np.loadtxt(path, delimiter=",", skiprows=1) for path in files]).T
        fit = np.polyfit(y, z, 2)
        found |= dict(zip(("catapult_a", "catapult_b", "catapult_c"), fit, strict=True))
        found["catapult_E"] = np.sum((z - np.polyval(fit, y)) ** 2)
        degrees, milliamperes = self.runs["JLoadWithoutFriction"]
        alpha, moment = (
            np.diff(degrees * radian, prepend=degrees[0] * radian) / 1e-3,
            self.torque(milliamperes, **torque),
        )
        hard = np.abs(alpha) >= np.abs(alpha).max() / 4.0
        found["alpha_max"] = np.abs(alpha).max()
        found["J_without_friction"] = 1e4 * np.mean(moment[hard] / alpha[hard])
        found["J_load_without_friction"] = found["J_without_friction"] - self.rotor
        degrees, milliamperes = self.runs["JLoadAndFriction"]
        omega, moment = degrees * radian, self.torque(milliamperes, **torque)
        rows = np.arange(width, omega.size)
        alpha = (omega[rows] - omega[rows - width]) / (width * 1e-3)
        rows = rows - set_back
        keep = np.abs(omega[rows]) >= fast
        matrix = np.stack([alpha, omega[rows], np.sign(omega[rows])], axis=1)[keep]
        if np.count_nonzero(keep) > 3:  # else no sample is fast enough in the wrong unit, and the task is left blank
            theta, error = np.linalg.lstsq(matrix, moment[rows][keep], rcond=None)[:2]
            found |= {"J": 1e4 * theta[0], "K_fric_w": theta[1], "K_fric_0": theta[2], "E": error[0]}
            found["J_load"] = found["J"] - self.rotor
        degrees, milliamperes = self.runs["MaxAcc"]
        moment = self.torque(milliamperes, **torque)
        found["M_max"] = moment.max()
        # where the torque has fallen by two percent, as one reads it from the drawing
        amperes = milliamperes / 1000.0
        last = np.flatnonzero(amperes > 0.985 * np.median(amperes[amperes > 0.95 * amperes.max()]))[-1]
        found["corner"] = degrees[last] * radian * rpm
        return found


#: What a student does with the own numbers, and the mistakes that grading must name; none for right ways.
RIGHT = (
    {},
    {"set_back": 1, "width": 2},
    {"set_back": 3, "width": 6},
    {"fast": 30.0},
)
WRONG = {
    "degrees for radians": ({"radian": 1.0},),
    "milliamperes for amperes": ({"ampere": 1.0},),
    "no kT(Iq)": ({"constant": "stall"}, {"constant": "peak"}),
    "half-sample lag": ({"width": 5, "set_back": 2},),
    "filter not synchronised": ({"set_back": 0}, {"width": 5, "set_back": 0}),
    "backward difference": ({"width": 1, "set_back": 0},),
    "2π": ({"rpm": 60.0}, {"radian": 1.0 / 360.0}),
}


def fill(folder, number, answers, random):
    """The form with five digits, some of it in other units, or as JSON, or with decimal commas."""
    units = {asked.name: asked.unit for asked in ASKED}
    rows = {name: (float(value), units[name]) for name, value in answers.items()}
    if number % 4 == 1:
        rows["J"] = rows["J"][0] * 1e-4, "kg*m^2"
        rows["K_fric_0"] = rows["K_fric_0"][0] * 1e3, "mNm"
        rows["corner"] = rows["corner"][0] / RPM, "rad/s"
    name = f"{number:02}"
    own = folder / f"group {name}"
    own.mkdir(parents=True)
    if number % 4 == 2:
        content = {key: {"value": float(f"{value:.5g}"), "unit": unit} for key, (value, unit) in rows.items()}
        (own / "answers.json").write_text(json.dumps({"student": name, "answers": content}))
        return
    comma = number % 4 == 3
    lines = [f"student,{name},"] + [f"{key},{value:.5g},{unit}" for key, (value, unit) in rows.items()]
    random.shuffle(lines)
    text = "\n".join(["quantity,value,unit", *lines]) + "\n"
    (own / "answers.csv").write_text(text.replace(",", ";").replace(".", ",") if comma else text, encoding="utf-8")


def graded_class(folder, students, wrong):
    """Record, fill in, grade; returns rows of grades.csv by student. `wrong`: mistake and keywords by student."""
    start = process_time()
    status, out, _ = bench("lab", "--record", folder / "class", "--students", students, "--seed", 7)
    took = process_time() - start
    assert status == 0
    assert out.count("wrote") == students + 1
    random = np.random.default_rng(1)
    for number in range(1, students + 1):
        student = Student(folder / "class" / f"student-{number:02}")
        _, how = wrong.get(number, ("", RIGHT[number % len(RIGHT)]))
        constants = {"stall": student.stall, "peak": student.peak}
        if how.get("constant") in constants:
            torque, current = constants[how["constant"]]
            how = {**how, "constant": torque / current}
        fill(folder / "handed in", number, student.answers(**how), random)
    status, out, err = bench(
        "lab", "--grade", folder / "handed in", "--truth", folder / "class.truth.json", "--out", folder / "grades"
    )
    assert (status, err) == (0, "")
    with (folder / "grades" / "grades.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return took, {n: [row for row in rows if int(row["student"]) == n] for n in range(1, students + 1)}


def check(graded, wrong, folder):
    for number, rows in graded.items():
        verdicts = {row["quantity"]: row["verdict"] for row in rows}
        mistakes = {row["mistake"] for row in rows} - {""}
        off = {row["quantity"]: (row["given"], row["expected"]) for row in rows if row["verdict"] == "wrong"}
        page = (folder / "grades" / "students" / f"student-{number:02}.html").read_text(encoding="utf-8")
        if number in wrong:
            name, _ = wrong[number]
            assert mistakes == {name}, (number, off)
            assert all(row["mistake"] for row in rows if row["verdict"] == "wrong"), (number, name, off)
            assert name in page
        else:
            assert set(verdicts.values()) == {"right", "not judged"}, (number, off)
            assert mistakes == set()
            assert 'class="wrong"' not in page


def drawn(first):
    """Every mistake once, in each of its ways, from a student on."""
    ways = [(name, how) for name, hows in WRONG.items() for how in hows]
    return {first + k: way for k, way in enumerate(ways)}


def test_every_mistake_is_named_and_no_right_one_marked_down(tmp_path):
    wrong = drawn(5)
    _, graded = graded_class(tmp_path, 14, wrong)
    check(graded, wrong, tmp_path)


@pytest.mark.slow
def test_forty_students(tmp_path):
    """Ten of forty with a mistake; recorded in CPU time that is below five minutes on one core."""
    wrong = drawn(21)
    assert len(wrong) == 10
    took, graded = graded_class(tmp_path, 40, wrong)
    print(f"40 students recorded in {took:.0f} s of CPU")
    assert took < 300.0
    check(graded, wrong, tmp_path)


def test_students_folders_hold_no_truth(tmp_path):
    status, _, _ = bench("lab", "--record", tmp_path / "class", "--students", 2, "--seed", 3)
    assert status == 0
    folders = sorted((tmp_path / "class").iterdir())
    assert [folder.name for folder in folders] == ["student-01", "student-02"]
    assert not list((tmp_path / "class").rglob("*truth*"))
    first, second = ((folder / "rig.toml").read_text() for folder in folders)
    assert first != second
    for text in (first, second):
        assert "simulation" not in text
        assert "inertia_feedforward" not in text
    truth = tmp_path / "class.truth.json"
    assert truth.stat().st_mode & 0o077 == 0
    content = json.loads(truth.read_text())
    known = content["students"]["01"]
    for name, true in known["truth"].items():
        assert known["expected"][name] == pytest.approx(true, rel=0.03), name
    disk = 19.0
    assert known["truth"]["J_load"] > 0.5 * disk
    again = tmp_path / "again"
    bench("lab", "--record", again, "--students", 1, "--seed", 3)
    assert (again / "student-01" / "rig.toml").read_text() == first
    status, _, err = bench("lab", "--record", tmp_path / "class", "--students", 2)
    assert (status, err.count("\n")) == (2, 1)
    assert "not empty" in err


@pytest.fixture(scope="module")
def known():
    expected = {asked.name: 1.0 for asked in ASKED}
    return {"07": {"expected": expected, "truth": {}, "mistakes": {}}}


def sealed(path, known):
    content = {"schema": SCHEMA, "seed": 0, "students": known}
    path.write_text(json.dumps({**content, "seal": seal(content)}))
    return path


@pytest.mark.parametrize(
    ("rows", "verdict", "word"),
    [
        ("J,1.0,kg*cm**2", "right", ""),
        ("J,0.0001,kg·m²", "right", ""),
        ("J,1.0,", "right", ""),
        ("J,1.0,N*m", "wrong unit", "measures"),
        ("J,1.0,kgcm2", "wrong unit", "no unit"),
        ("J,1.5,kg*cm**2", "wrong", "no mistake that is known"),
        ("J,,kg*cm**2", "not answered", ""),
    ],
)
def test_units_are_checked(tmp_path, known, rows, verdict, word):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.csv").write_text(f"quantity,value,unit\nstudent,7,\n{rows}\n", encoding="utf-8")
    truth = sealed(tmp_path / "truth.json", known)
    status, _, _ = bench("lab", "--grade", tmp_path / "in", "--truth", truth, "--out", tmp_path / "out")
    assert status == 0
    with (tmp_path / "out" / "grades.csv").open(encoding="utf-8") as file:
        found = {row["quantity"]: row["verdict"] for row in csv.DictReader(file)}
    assert found["J"] == verdict
    assert word in (tmp_path / "out" / "students" / "student-07.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.csv", "quantity,value,unit\nstudent,7,\nJay,1,\n", ["line 3", "Jay", "not asked for"]),
        ("a.csv", "quantity,value,unit\nstudent,7,\nJ,about 3,\n", ["line 3", "about 3"]),
        ("a.csv", "quantity,value,unit\nJ,3,\n", ["student", "missing"]),
        ("a.csv", "quantity,value,unit\nstudent,99,\nJ,3,\n", ["99", "07"]),
        ("a.csv", "quantity,value,unit\nstudent,7,\nJ,3,\nJ,4,\n", ["twice"]),
        ("a.csv", "quantity,value,unit\nstudent,7,\nJ,22,4,kg*cm**2\n", ["line 3", "cells"]),
    ],
)
def test_a_bad_form_is_reported_and_the_others_are_graded(tmp_path, known, name, text, words):
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / name).write_text(text)
    (tmp_path / "in" / "good.csv").write_text("quantity,value,unit\nstudent,7,\nJ,1,\n")
    truth = sealed(tmp_path / "truth.json", known)
    status, out, err = bench("lab", "--grade", tmp_path / "in", "--truth", truth, "--out", tmp_path / "out")
    assert (status, err.count("\n")) == (1, 1)
    for word in words:
        assert word in err
    assert "07" in out


def test_a_changed_truth_and_missing_ones_are_refused(tmp_path, known):
    (tmp_path / "in").mkdir()
    truth = sealed(tmp_path / "truth.json", known)
    for arguments, word in (
        (("--grade", tmp_path / "in", "--truth", truth), "no filled form"),
        (("--grade", tmp_path / "nowhere", "--truth", truth), "no such folder"),
        (("--grade", tmp_path / "in"), "--truth"),
        (("--grade", tmp_path / "in", "--truth", tmp_path / "none.json"), "no such file"),
        (("--students", 3), "--record"),
    ):
        status, _, err = bench("lab", *arguments)
        assert (status, err.count("\n")) == (2, 1), err
        assert word in err
    truth.write_text(truth.read_text().replace('"J": 1.0', '"J": 2.0'))
    (tmp_path / "in" / "good.csv").write_text("quantity,value,unit\nstudent,7,\nJ,1,\n")
    status, _, err = bench("lab", "--grade", tmp_path / "in", "--truth", truth)
    assert status == 2
    assert "seal" in err
