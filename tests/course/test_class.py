"""A class: every student's own axis, forms filled in right and wrong, and the command that grades them."""

import contextlib
import csv
import hashlib
import json
import re
import stat
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.signal import butter, filtfilt, savgol_filter

from bench.course.grade import SEALED, read_truth_of_class, seal
from bench.course.record import draw_rig, record_class
from bench.course.submission import QUESTIONS
from bench.course.suspicion import SUSPECT
from bench.errors import InputError
from bench.trace.read import read
from tests.command import bench
from tests.studies.copied import donors, measured

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

    def answers(self, radian=DEG, set_back=2, width=4, rpm=RPM, fast=20.0, method=None, **torque):
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
        if method is not None:
            rows = np.arange(omega.size)
            alpha = method(omega)
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


def spline(omega):
    time = 1e-3 * np.arange(omega.size)
    return make_interp_spline(time, omega, 5)(time, 1)


#: What a student does with the own numbers, and the mistakes that grading must name; none for right ways.
RIGHT = (
    {},
    {"set_back": 1, "width": 2},
    {"set_back": 3, "width": 6},
    {"fast": 30.0},
    {"method": lambda omega: np.gradient(omega, 1e-3)},
    {"method": lambda omega: savgol_filter(omega, 9, 3, deriv=1, delta=1e-3)},
    {"method": lambda omega: filtfilt(*butter(3, 0.2), np.gradient(omega, 1e-3))},
    {"method": spline},
)
BY_STALL, BY_PEAK, BY_ZERO = ({"constant": which} for which in ("stall", "peak", "zero"))
WRONG = {
    "degrees for radians": ({"radian": 1.0},),
    "milliamperes for amperes": ({"ampere": 1.0}, {"ampere": 1.0, **BY_STALL}, {"ampere": 1.0, **BY_ZERO}),
    "no kT(Iq)": (BY_STALL, BY_PEAK, BY_ZERO),
    "half-sample lag": (*({"width": w, "set_back": w // 2} for w in (3, 5, 7)), {"set_back": 1}),
    "filter not synchronised": ({"set_back": 0}, *({"width": width, "set_back": 0} for width in (3, 5, 7))),
    "backward difference": ({"width": 1, "set_back": 0},),
    "2π": ({"rpm": 60.0}, {"radian": 1.0 / 360.0}, {"radian": 2.0 * np.pi * DEG}),
    "rpm for rad/s": ({"radian": 1.0 / 6.0},),
    "wrong sign": ({"ampere": -1e-3},),
    "peak value for RMS": ({"ampere": 1e-3 * np.sqrt(2.0)},),
}
#: Made after the work: name, and what is changed in the answers.
SLIPS = {
    "J_motor not subtracted": lambda a: {"J_load": a["J"], "J_load_without_friction": a["J_without_friction"]},
    "K_w and K_0 exchanged": lambda a: {"K_fric_w": a["K_fric_0"], "K_fric_0": a["K_fric_w"]},
    "kg·m² as kg·cm²": lambda a: {name: 1e-4 * a[name] for name in a if name.startswith("J")},
    "rad/s as rpm": lambda a: {"corner": a["corner"] / RPM},
}
#: Two at once, in how a student works.
PAIRS = (
    ("degrees for radians", "milliamperes for amperes"),
    ("degrees for radians", "no kT(Iq)"),
    ("rpm for rad/s", "filter not synchronised"),
    ("no kT(Iq)", "half-sample lag"),
    ("milliamperes for amperes", "backward difference"),
    ("peak value for RMS", "half-sample lag"),
)


def fill(folder, number, answers, random):
    """The form with five digits, some of it in other units, or as JSON, or with decimal commas."""
    units = {question.name: question.unit for question in QUESTIONS}
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


@dataclass(frozen=True)
class Class:
    """Recorded students, by number, and the folder of them all."""

    folder: Path
    students: dict[int, Student]


#: A salt for classes that are the same in every run.
SALT = 0x5EA1_0FA_C1A55


def recorded(folder, count, salt=SALT, into=None):
    """A class that the command recorded; all of one seed, so that the first students are the same of any count.

    Args:
        folder: of the class and its truth.
        count: of students.
        salt: in the place of a random one; the command draws its own without.
        into: the folder of the class as the command is given it.
    """
    if salt is None:
        status, out, _ = bench("lab", "--record", into, "--students", count, "--seed", 7)
        assert (status, out.count("wrote")) == (0, count + 2)
    else:
        record_class(folder / "class", count, 7, salt=salt)
    return Class(folder, {number: Student(folder / "class" / f"student-{number:02}") for number in range(1, count + 1)})


def graded(of, ways, out):
    """Fill in every student's form in a way, and grade; returns rows of grades.csv by student.

    Args:
        of: the class.
        ways: how each student works, by number, and the mistake in it, if there is one.
        out: folder of the forms and grades.
    """
    random = np.random.default_rng(1)
    for number, (_, how) in ways.items():
        student = of.students[number]
        constants = {"stall": student.stall[0] / student.stall[1], "peak": student.peak[0] / student.peak[1]}
        if "constant" in how:
            how = {**how, "constant": {**constants, "zero": student.c}[how["constant"]]}
        answers = student.answers(**{key: value for key, value in how.items() if key != "slip"})
        fill(out / "handed in", number, {**answers, **how.get("slip", lambda a: {})(answers)}, random)
    forms, truth = out / "handed in", of.folder / "class.truth.json"
    asked = ("--acceleration", "synchronised")
    status, _, err = bench("lab", "--grade", forms, "--truth", truth, "--out", out / "grades", *asked)
    assert (status, err) == (0, "")
    with (out / "grades" / "grades.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {number: [row for row in rows if int(row["student"]) == number] for number in ways}


def check(of, ways, out):
    """Every mistake is named, with nothing left wrong that it does not explain; what is right is marked so."""
    for number, rows in graded(of, ways, out).items():
        mistake, how = ways[number]
        off = {row["quantity"]: (row["given"], row["expected"]) for row in rows if row["verdict"] == "wrong"}
        page = (out / "grades" / "students" / f"student-{number:02}.html").read_text(encoding="utf-8")
        assert {row["mistake"] for row in rows} - {""} == ({mistake} if mistake else set()), (number, how, off)
        if mistake:
            assert all(row["mistake"] for row in rows if row["verdict"] == "wrong"), (number, how, off)
            assert mistake in page
        else:
            assert {row["verdict"] for row in rows} == {"right", "not judged"}, (number, how, off)
            assert 'class="marked"' not in page


#: Right ways, and every mistake in each of its ways.
ALL_RIGHT = [("", how) for how in RIGHT]
ALL_WRONG = [(mistake, how) for mistake, hows in WRONG.items() for how in hows]
ALL_WRONG += [(mistake, {"slip": slip}) for mistake, slip in SLIPS.items()]


def drawn_pairs(count):
    """Two mistakes at once: in how a student works, and in that and a slip after it."""
    works = [(f"{one} and {other}", {**WRONG[one][0], **WRONG[other][0]}) for one, other in PAIRS]
    works += [
        (f"{mistake} and {slip}", {**how, "slip": SLIPS[slip]})
        for mistake, how in ALL_WRONG
        if mistake in WRONG
        for slip in ("K_w and K_0 exchanged", "kg·m² as kg·cm²")
    ]
    return [works[k] for k in np.random.default_rng(40).permutation(len(works))[:count]]


@pytest.fixture(scope="module")
def four(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("four"), 4)


@pytest.fixture(scope="module")
def salted(tmp_path_factory):
    """A class of one, of the same seed, with the salt that the command draws, recorded into the folder one is in."""
    folder = tmp_path_factory.mktemp("salted")
    (folder / "class").mkdir()
    with contextlib.chdir(folder / "class"):
        return recorded(folder, 1, salt=None, into=".")


def test_every_mistake_is_named_and_no_right_one_marked_down(four, tmp_path):
    """Each way by one of four students on recordings of an own axis, as many rounds of forms as it takes."""
    ways = [*ALL_RIGHT, *ALL_WRONG]
    for start in range(0, len(ways), len(four.students)):
        check(four, dict(enumerate(ways[start : start + len(four.students)], 1)), tmp_path / str(start))


@pytest.mark.slow
def test_forty_students(tmp_path):
    """Every mistake alone by forty, forty pairs, and 200 right ones."""
    of = recorded(tmp_path, 40)
    check(of, dict(enumerate(ALL_WRONG, 1)), tmp_path / "wrong")
    for k, how in enumerate(RIGHT[3:]):
        check(of, dict.fromkeys(of.students, ("", how)), tmp_path / f"right {k}")
    named_as_two(of, dict(enumerate(drawn_pairs(40), 1)), tmp_path / "pairs")


def named_as_two(of, ways, out):
    """Of every two mistakes at once two or more are named, and of nine in ten both, in one task or in several."""
    mistakes = {number: {row["mistake"] for row in rows} - {""} for number, rows in graded(of, ways, out).items()}
    assert not [found for found in mistakes.values() if len(found) < 2 and " and " not in "".join(found)]
    both = {n: ways[n][0].split(" and ", 1) for n in ways}
    named = [n for n, found in mistakes.items() if all(one in "; ".join(found) for one in both[n])]
    missed = {ways[n][0]: found for n, found in mistakes.items() if n not in named}
    print(f"{len(named)} of {len(mistakes)} pairs named as they are; not: {missed}")
    assert len(named) >= 0.9 * len(mistakes)


def test_two_mistakes_at_once_are_named_as_two(four, tmp_path):
    named_as_two(four, dict(enumerate(drawn_pairs(4), 1)), tmp_path)


def grades_of(four, out, *options):
    """Rows of the grades of the forms in `out / in`."""
    truth = four.folder / "class.truth.json"
    bench("lab", "--grade", out / "in", "--truth", truth, "--out", out / "out", *options)
    return [*csv.DictReader((out / "out" / "grades.csv").read_text(encoding="utf-8").splitlines())]


def pages_of(out):
    """What students read, in one text."""
    return "".join(page.read_text(encoding="utf-8") for page in (out / "out" / "students").iterdir())


@pytest.mark.parametrize("mistaken", [{}, {"radian": 1.0}, {"constant": 0.9}])
def test_a_copied_form_is_suspected_for_the_teacher_alone_in_each_task(four, tmp_path, mistaken):
    """Changed by up to 1 %, right or wrong by a known or an unknown mistake; no student reads of it."""
    source, random = four.students[2].answers(**mistaken), np.random.default_rng(5)
    fill(tmp_path / "in", 2, source, random)
    copied = {name: value * (1.0 + 0.007 * random.uniform(-1.0, 1.0)) for name, value in source.items()}
    fill(tmp_path / "in", 4, copied, random)
    fill(tmp_path / "in", 3, four.students[3].answers(), random)
    grades_of(four, tmp_path)
    rows = [*csv.DictReader((tmp_path / "out" / "suspicion.csv").read_text(encoding="utf-8").splitlines())]
    assert {frozenset((row["student"], row["like student"])) for row in rows} == {frozenset(("02", "04"))}
    of_student = {row["task"]: row["the same wrong answers"] for row in rows}
    assert {"6", "9"} <= set(of_student)
    assert "K_fric_w" in of_student["9"]
    pages = pages_of(tmp_path)
    assert "copi" not in pages
    assert not re.search(r"student[- ]02", (tmp_path / "out" / "students" / "student-04.html").read_text("utf-8"))


def test_a_form_that_was_not_handed_in_is_suspected_as_a_source_too(four, tmp_path):
    fill(tmp_path / "in", 4, four.students[2].answers(), np.random.default_rng(0))
    grades_of(four, tmp_path)
    assert "04,02," in (tmp_path / "out" / "suspicion.csv").read_text(encoding="utf-8")


def test_hardly_an_honest_pair_is_suspected_and_nearly_every_copy_is(four):
    """Forty classes of twenty, drawn as `tests.studies.copied` draws 1000."""
    copies, pairs, _ = measured(40, 20, 1, donors(four.folder / "class.truth.json"))
    suspected, found = np.count_nonzero(pairs > SUSPECT), np.mean(copies > SUSPECT)
    print(f"{suspected} of {pairs.size} honest pairs suspected, {found:.1%} of copies found")
    assert suspected / pairs.size <= 1e-3
    assert found >= 0.95


@pytest.mark.parametrize("rounds", [8, pytest.param(40, marks=pytest.mark.slow)])
def test_honest_factors_of_their_own_are_no_suspicion(rounds, four, tmp_path):
    """Of 40 rounds 80 forms with J of task 6 off by up to 15 %, as many with one factor on every torque."""
    random = np.random.default_rng(2)
    for each in range(rounds):
        out = tmp_path / str(each)
        for number, student in four.students.items():
            answers, factor = student.answers(), random.uniform(0.85, 1.15)
            for name in ("J_without_friction", *(("J", "K_fric_w", "K_fric_0") if each % 2 else ())):
                answers[name] *= factor
            answers["J_load_without_friction"] = answers["J_without_friction"] - student.rotor
            answers["J_load"] = answers["J"] - student.rotor
            fill(out / "in", number, answers, random)
        grades_of(four, out)
        assert (out / "out" / "suspicion.csv").read_text(encoding="utf-8").count("\n") == 1
        assert "copi" not in pages_of(out)


def mean_of_centred(early):
    """The mean of four centred differences, which belongs between two samples, on the one or the other."""
    shift = 1 if early else 2

    def method(omega):
        padded = np.pad(np.gradient(omega, 1e-3), 2, mode="edge")
        return np.convolve(padded, np.full(4, 0.25), mode="valid")[shift - 1 :][: omega.size]

    return method


AS_THE_TEXT = [{"width": 1, "set_back": 0}, {"width": 3, "set_back": 1}, {"width": 5, "set_back": 2}]


@pytest.mark.parametrize("ways", [AS_THE_TEXT, [{"method": mean_of_centred(early)} for early in (False, True)]])
def test_the_texts_acceleration_is_right_unless_the_teacher_asks_for_a_synchronised_one(four, tmp_path, ways):
    """Half a sample late, friction is off by a third; it is explained, and counts by default."""
    late = [f"{number:02}" for number in range(1, 1 + len(ways))]
    for number, how in enumerate([*ways, {}], 1):
        fill(tmp_path / "in", number, four.students[number].answers(**how), np.random.default_rng(0))
    for acceleration, of_late, synchronised in (
        ("either", "right", "right"),
        ("text", "right", "wrong"),
        ("synchronised", "wrong", "right"),
    ):
        rows = grades_of(four, tmp_path, "--acceleration", acceleration)
        assert {row["verdict"] for row in rows if row["quantity"] == "J"} == {"right"}
        for row in rows:
            if row["quantity"] == "K_fric_w":
                assert row["verdict"] == (of_late if row["student"] in late else synchronised), (acceleration, row)
        if acceleration == "either":
            for student in late:
                page = (tmp_path / "out" / "students" / f"student-{student}.html").read_text(encoding="utf-8")
                assert "as in the text" in page
                assert 'class="marked"' not in page


def test_what_fits_nothing_is_not_known(four, tmp_path):
    """J too large by a tenth beside right friction is no mistake that has figures; nor is a number far away."""
    answers = four.students[4].answers()
    strange = {**answers, "J": 1.1 * answers["J"], "K_fric_0": 1e8 * answers["K_fric_0"]}
    fill(tmp_path / "in", 4, strange, np.random.default_rng(0))
    wrong = {row["quantity"]: row["mistake"] for row in grades_of(four, tmp_path) if row["verdict"] == "wrong"}
    assert wrong == {"J": "", "K_fric_0": ""}
    assert "1e+08 times" in (tmp_path / "out" / "grades.html").read_text(encoding="utf-8")


def test_the_seed_does_not_give_the_truth_away(salted):
    """Who draws axes for every seed, as the course's code does, finds none like a student's public rig file."""
    assert {path.name for path in salted.folder.iterdir()} >= {"class", "class.truth.json", "class.truth.key"}
    public = tomllib.loads((salted.folder / "class" / "student-01" / "rig.toml").read_text(encoding="utf-8"))
    assert not [seed for seed in range(300) if draw_rig(np.random.default_rng([seed, 1]))["load"] == public["load"]]
    salt = int(json.loads((salted.folder / "class.truth.json").read_text())["salt"], 16)
    assert salt.bit_length() > 64
    # with the salt it is found: what keeps the truth is the salt, which no student's file has
    assert draw_rig(np.random.default_rng([7, 1, salt]))["load"] == public["load"]
    files = [path for path in (salted.folder / "class").rglob("*") if path.is_file()]
    assert not [path for path in files if f"{salt:032x}".encode() in path.read_bytes()]


def test_students_folders_hold_no_truth_which_is_for_its_owner_alone(four, salted):
    folders = sorted((four.folder / "class").iterdir())
    assert [folder.name for folder in folders] == [f"student-{number:02}" for number in four.students]
    assert not list((four.folder / "class").rglob("*truth*"))
    texts = [(folder / "rig.toml").read_text(encoding="utf-8") for folder in folders]
    texts.append((salted.folder / "class" / "student-01" / "rig.toml").read_text(encoding="utf-8"))
    assert len(set(texts)) == len(texts)
    assert not [text for text in texts if "simulation" in text or "inertia_feedforward" in text]
    truth, key = four.folder / "class.truth.json", four.folder / "class.truth.key"
    assert [stat.S_IMODE(path.stat().st_mode) for path in (truth, key)] == [0o600, 0o600]
    assert len(bytes.fromhex(key.read_text().strip())) == 32
    assert key.read_text().strip() not in truth.read_text()
    for student, known in zip(four.students.values(), read_truth_of_class(truth).values(), strict=True):
        for name, true in known["truth"].items():
            assert known["expected"][name] == pytest.approx(true, rel=0.03), name
        assert known["truth"]["J"] - known["truth"]["J_load"] == pytest.approx(student.rotor)
        assert known["truth"]["J_load"] > 0.5 * 19.0  # of its disk


def test_what_is_marked_by_hand_has_a_sheet_and_is_asked_for_in_the_form(four, tmp_path):
    """The form as it is written is read, with its lines about what goes on paper."""
    (tmp_path / "in").mkdir()
    form = (four.folder / "class" / "student-01" / "answers.csv").read_text(encoding="utf-8")
    (tmp_path / "in" / "answers.csv").write_text(form.replace("J,,", "J,20,"), encoding="utf-8")
    asked = [line.split(":")[0] for line in form.splitlines() if line.startswith("#")]
    assert asked == [f"# on paper, task {task}" for task in ("2", "5", "7", "8", "11")]
    grades_of(four, tmp_path)
    rows = [*csv.DictReader((tmp_path / "out" / "by_hand.csv").read_text(encoding="utf-8").splitlines())]
    found = [(row["student"], row["task"], row["marks"]) for row in rows]
    assert found == [("01", task, "") for task in ("2", "5", "7", "8", "11")]


@pytest.fixture(scope="module")
def known():
    expected = {question.name: 1.0 for question in QUESTIONS}
    return {"07": {"expected": expected, "truth": {}, "mistakes": [], "tolerance": {}}}


def sealed(path, known):
    content = {"schema": SEALED, "seed": 0, "students": known}
    path.write_text(json.dumps({**content, "seal": seal(content, "key")}))
    path.with_suffix(".key").write_text("key\n")
    return path


def a_form(student, rows="J,1,"):
    return f"quantity,value,unit\nstudent,{student},\n{rows}\n"


def grade_texts(folder, known, forms):
    """What the command prints of forms, by their names, of the students of a truth; grades are in `out`."""
    (folder / "in").mkdir()
    for name, text in forms.items():
        (folder / "in" / name).write_text(text, encoding="utf-8")
    truth = sealed(folder / "truth.json", known)
    return bench("lab", "--grade", folder / "in", "--truth", truth, "--out", folder / "out")


#: One, as the course and students write it.
ONE_KG_CM2 = {
    **dict.fromkeys(("kg*cm**2", "", "kgcm²", "[kgcm²]", "kgcm^2", "kgcm2", "kg cm²"), "1.0"),
    "kgm²": "1e-4",
    "kg·m²": "0.0001",
    "gcm²": "1e3",
}
#: A speed of one turn a minute; 1/s is right in turns and in radians.
ONE_RPM = {
    **dict.fromkeys(("1/min", "min⁻¹", "min^-1", "U/min", "rpm"), 1.0),
    "1/s": 1.0 / 60.0,
    "Hz": 1.0 / 60.0,
    "s^-1": 1.0 / RPM,
    "rad/s": 1.0 / RPM,
}


@pytest.mark.parametrize(
    ("student", "row", "verdict", "word"),
    [
        *(("7", f"J,{value},{unit}", "right", "") for unit, value in ONE_KG_CM2.items()),
        *(("7", f"corner,{value},{unit}", "right", "") for unit, value in ONE_RPM.items()),
        *((name, "K_fric_w,1.0,Nms/rad", "right", "") for name in ("07", "student-07", "Student 7")),
        ("7", 'J,"1,0",kg*cm**2', "right", ""),
        ("7", "J,1.0,N*m", "wrong unit", "measures"),
        ("7", "J,1.0,bananas", "wrong unit", "no unit"),
        ("7", "J,1.5,kg*cm**2", "wrong", "no mistake that is known"),
        ("7", "J,,kg*cm**2", "not answered", ""),
    ],
)
def test_a_form_is_read_as_students_write_it(tmp_path, known, student, row, verdict, word):
    ended = grade_texts(tmp_path, known, {"a.csv": a_form(student, row)})
    assert (ended.status, "07" in ended.out) == (0, True)
    with (tmp_path / "out" / "grades.csv").open(encoding="utf-8") as file:
        found = {row["quantity"]: row["verdict"] for row in csv.DictReader(file)}
    assert found[row.split(",")[0]] == verdict
    assert word in (tmp_path / "out" / "students" / "student-07.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.csv", a_form("7", "Jay,1,"), ["line 3", "Jay", "not in the form"]),
        ("a.csv", a_form("7", "J,about 3,"), ["line 3", "about 3"]),
        ("a.csv", "quantity,value,unit\nJ,3,\n", ["student", "missing"]),
        ("a.csv", a_form("99", "J,3,"), ["99", "07"]),
        ("a.csv", a_form("7", "J,3,\nJ,4,"), ["twice"]),
        ("a.csv", a_form("7", "J,22,4,kg*cm**2"), ["line 3", "cells"]),
        ("a.csv", a_form("7", "J,1e999,"), ["line 3", "1e999"]),
        ("a.json", '{"student": "7", "answers": {"J": {"value": 1}, "J": {"value": 2}}}', ["'J'", "twice"]),
    ],
)
def test_a_bad_form_is_reported_and_the_others_are_graded(tmp_path, known, name, text, words):
    status, out, err = grade_texts(tmp_path, known, {name: text, "good.csv": a_form("7")})
    assert (status, err.count("\n")) == (1, 1)
    assert not [word for word in words if word not in err], err
    assert "07" in out


def test_two_forms_of_one_student_leave_the_others_alone(tmp_path, known):
    forms = {"a.csv": a_form("07"), "b.csv": a_form("7"), "c.csv": a_form("08")}
    ended = grade_texts(tmp_path, {**known, "08": known["07"]}, forms)
    assert (ended.status, "found 2 of student 07" in ended.err, "08" in ended.out) == (1, True, True)


def test_a_changed_truth_and_missing_ones_are_refused(tmp_path, known, four):
    (tmp_path / "in").mkdir()
    truth, new = sealed(tmp_path / "truth.json", known), tmp_path / "class"
    for arguments, word in (
        (("--grade", tmp_path / "in", "--truth", truth), "no filled form"),
        (("--grade", tmp_path / "nowhere", "--truth", truth), "no such folder"),
        (("--grade", tmp_path / "in"), "--truth"),
        (("--grade", tmp_path / "in", "--truth", tmp_path / "none.json"), "no such file"),
        (("--students", 3), "--record"),
        (("--data", "nowhere"), "nowhere"),
        (("--record", new, "--students", 1, "--seed", -1), "seed"),
        (("--record", four.folder / "class", "--students", 2), "not empty"),
    ):
        status, _, err = bench("lab", *arguments)
        assert (status, err.count("\n"), word in err) == (2, 1, True), err
    assert not new.exists()
    truth.write_text(truth.read_text().replace('"J": 1.0', '"J": 2.0'))
    (tmp_path / "in" / "good.csv").write_text(a_form("7"))
    status, _, err = bench("lab", "--grade", tmp_path / "in", "--truth", truth)
    assert (status, "seal" in err) == (2, True)


def test_only_who_has_the_key_can_seal_a_truth(tmp_path, known):
    truth, key = sealed(tmp_path / "truth.json", known), tmp_path / "truth.key"
    assert read_truth_of_class(truth) == known
    key.rename(tmp_path / "elsewhere")
    with pytest.raises(InputError, match=r"truth\.key: no such file; give the path of the key .* --key"):
        read_truth_of_class(truth)
    assert read_truth_of_class(truth, tmp_path / "elsewhere") == known
    content = json.loads(truth.read_text())
    del content["seal"]
    content["students"]["07"]["expected"]["J"] = 2.0
    checksum = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
    for forged in (checksum, seal(content, ""), seal(content, "another key"), None, 1):
        truth.write_text(json.dumps({**content, "seal": forged}))
        with pytest.raises(InputError, match="its seal does not fit"):
            read_truth_of_class(truth, tmp_path / "elsewhere")
