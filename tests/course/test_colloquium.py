"""Questions of the colloquium: figures against numpy's, an integrator's and closed forms, and who is asked what."""

import re

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from bench.course.colloquium import TEXTS, figures, questions
from bench.course.recordings import LabRecordings
from bench.errors import InputError
from tests.command import bench
from tests.course.conftest import as_a_student_has_them
from tests.course.test_class import RPM, Student

RIG = """[motor]
model = "SH30701P"
continuous_stall_torque = "1.4 N*m"
continuous_stall_current = "1.8 A"
peak_torque = "3.5 N*m"
peak_current = "5.7 A"
rotor_inertia = "0.25 kg*cm**2"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The lab's axis as a student has it."""
    where = as_a_student_has_them(tmp_path_factory.mktemp("class") / "student-01")
    (where / "rig.toml").write_text(RIG)
    return where


@pytest.fixture(scope="module")
def own(folder):
    return figures(LabRecordings.in_folder(folder))


def test_what_other_ways_make_of_it_is_what_numpy_makes(own, folder):
    student = Student(folder)
    right, stall = student.answers(), student.stall[0] / student.stall[1]
    ways = {
        "late": {"width": 3, "set_back": 1},
        "bare": {"width": 1, "set_back": 0},
        "slow": {"fast": 60.0},
        "constant": {"constant": stall},
        "rms": {"ampere": 1e-3 * np.sqrt(2.0)},
    }
    for way, how in ways.items():
        found = student.answers(**how)
        for short, name in (("J", "J"), ("w", "K_fric_w"), ("0", "K_fric_0"), ("M", "M_max")):
            assert own[f"{way}_{short}"] == pytest.approx(found[name] / right[name] - 1.0, abs=1e-6), (way, name)
    assert own["rms_peak"] == pytest.approx(student.answers(**ways["rms"])["M_max"])


def test_half_a_sample_is_explained_by_what_it_leaves(own):
    """The answer's figures come from J*T/2*dalpha/dt alone, the question's from working it out that way."""
    for name in ("0", "w"):
        assert abs(own[f"late_{name}"]) > 0.1
        assert own[f"project_{name}"] == pytest.approx(own[f"late_{name}"], rel=0.05)
    assert max(abs(own["late_J"]), abs(own["project_J"])) < 0.002


def test_the_torque_constant_falls_as_the_parabola_through_stall_and_peak_does(own, folder):
    student = Student(folder)
    at, at_2 = (student.torque(1e3 * own[current]) / own[current] for current in ("I_rms", "I_rms2"))
    assert own["ratio_rms"] == pytest.approx(student.stall[0] / student.stall[1] / at - 1.0, abs=1e-9)
    assert own["ratio_2"] == pytest.approx(np.sqrt(2.0) * at_2 / at - 1.0, abs=1e-9)


def test_noise_of_the_speed_and_what_it_does_to_the_inertia(own):
    assert own["noise"] == pytest.approx(np.radians(1.5), rel=0.05)  # the lab rig's sensor
    assert own["attenuation"] == pytest.approx(-2.0 * (np.radians(1.5) / 1e-3 / own["alpha_rms"]) ** 2, rel=0.1)
    # the bare difference loses by noise, and by half a sample as little as alpha_filt does
    assert own["bare_J"] == pytest.approx(own["attenuation"], abs=1e-3)


def test_the_axis_by_an_integrator_and_by_its_motion(own):
    inertia, viscous, coulomb = own["J"] * 1e-4, own["K_w"], own["K_0"]

    def stands(t, w):
        return w[0]

    stands.terminal = True
    run = solve_ivp(lambda t, w: -(viscous * w + coulomb) / inertia, (0, 60), [own["top"]], events=stands, rtol=1e-9)
    assert own["coast"] == pytest.approx(run.t_events[0][0], rel=1e-6)
    assert own["coast"] < own["coast_0"] == pytest.approx(inertia * own["top"] / coulomb)
    equal = brentq(lambda w: viscous * w - coulomb, 1.0, 1e4)
    assert (own["equal"], own["equal_rpm"]) == pytest.approx((equal, equal * RPM))
    assert own["equal_power"] == pytest.approx((viscous * equal + coulomb) * equal)
    disk = LabRecordings.in_folder(None).rig.load
    larger = disk.model_copy(update={"outer_diameter": disk.outer_diameter + 1e-3 * own["millimetres"]})
    assert larger.disk_inertia == pytest.approx(disk.disk_inertia * (1.0 + own["hub"]), rel=0.01)
    assert own["ring"] * 1e-3 * 0.02**2 * 1e4 == pytest.approx(own["extra"])


def test_the_corner_tells_the_temperature_that_the_winding_had(own):
    """The run was simulated at 20 degC, by the course's circuit, and warms by 2 K."""
    assert own["temperature"] == pytest.approx(21.0, abs=2.0)
    assert own["share_R"] == pytest.approx(own["room"], abs=0.02)


def test_the_throw_by_an_integrator(own, folder):
    v, angle = own["v"], np.radians(own["angle"])
    assert v * np.cos(angle) == pytest.approx(own["v_y"])
    t = np.linspace(0, 1.5, 4000)
    answers = Student(folder).answers()
    start = answers["catapult_c"]
    assert (start + v * np.sin(angle) * t - 0.5 * 9.81 * t**2).max() == pytest.approx(own["apex"], abs=1e-3)


def test_every_figure_of_a_text_is_there_and_each_text_is_asked(own, folder):
    text = TEXTS.read_text(encoding="utf-8")
    assert set(re.findall(r"{(\w+)", text)) <= own.keys()
    recordings = LabRecordings.in_folder(folder)
    asked = [tuple(one.name for one in questions(recordings, number)) for number in range(36)]
    assert len(set(asked)) == 36
    assert {name for three in asked for name in three} == set(re.findall(r"^## \w+: (.+)$", text, re.MULTILINE))
    assert not [k for k in range(35) if set(asked[k]) & set(asked[k + 1])]


def test_the_command_writes_answers_for_the_examiner_alone(folder, tmp_path):
    bad = folder.parent / "student-02"
    bad.mkdir()
    (folder.parent / "list.txt").write_text("no folder, so no student")
    ended = bench("lab", "--questions", folder.parent, "--out", tmp_path)
    assert (ended.status, ended.err.count("\n")) == (1, 1)
    assert "student-02" in ended.err
    examiner = (tmp_path / "questions.html").read_text(encoding="utf-8")
    student = (tmp_path / "questions" / "student-01.html").read_text(encoding="utf-8")
    assert (examiner.count("Answer: "), student.count("Answer")) == (3, 0)
    first = questions(LabRecordings.in_folder(folder), 0)[0].text[:60]
    assert first in student and first in examiner
    assert bench("lab", "--questions", tmp_path / "none").status == 2
    with pytest.raises(InputError):
        figures(LabRecordings.in_folder(bad))
