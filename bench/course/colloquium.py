"""Three questions for each student, whose figures are of the own recordings, and the examiner's answers."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bench.arrays import rms
from bench.assets import asset
from bench.course.answers import Worked
from bench.course.axis import MAINS, circuit, torque_constant
from bench.course.friction import in_step
from bench.course.methods import KG_CM2, LEAST_SPEED, RPM, WIDTH
from bench.course.recordings import LabRecordings
from bench.course.run import LabRun
from bench.course.ways import Way
from bench.errors import BenchError, InputError
from bench.files import read_text, write_text
from bench.report.document import Document, Paragraph, Section, neighbours, section
from bench.report.html import html
from bench.rig.limits import HOT, peak_curve
from bench.rig.rig import Load, Rig

TITLE = "Industrial Drives, Part 2: colloquium"
TEXTS = asset("data", "lab", "questions.md")
_QUESTION = re.compile(r"^## (\w+): (.+)\n((?:[^>#].*\n)+)((?:> .*\n)+)", re.MULTILINE)
GROUPS = ("filter", "torque", "axis")
#: Gravity - m/s**2, radius of the ring in the question of the hub - m, and the other threshold - rad/s.
GRAVITY, RING, FASTER = 9.81, 0.02, 60.0


@dataclass(frozen=True)
class AskedQuestion:
    """The questions to a student, with the own figures, and what the examiner expects."""

    name: str
    text: str
    answer: str


def questions(recordings: LabRecordings, number: int) -> list[AskedQuestion]:
    """One of each group; the next number has other ones, and 36 numbers in a row no three in common.

    Raises BenchError where a recording is missing or cannot be of the axis.
    """
    own, texts = figures(recordings), _QUESTION.findall(read_text(TEXTS, "questions"))
    asked = []
    for group, turn in zip(GROUPS, (number, number + number // 3, number), strict=True):
        of_group = [found for found in texts if found[0] == group]
        _, name, text, answer = of_group[turn % len(of_group)]
        filled = (" ".join(part.split()).format(**own) for part in (text, re.sub("^> ", "", answer, flags=re.M)))
        asked.append(AskedQuestion(name, *filled))
    return asked


def figures(recordings: LabRecordings) -> dict[str, float]:
    """Every figure in a question or an answer, by its name there, in its unit there."""
    worked = Worked(recordings)
    right = worked.answers()
    same = {"J": "J", "K_w": "K_fric_w", "K_0": "K_fric_0", "M_max": "M_max", "kT_stall": "kT_stall"}
    return {
        **{name: right[answer] for name, answer in same.items()},
        **_of_ways(worked, right),
        **_of_filter(recordings.with_friction, right),
        **_of_torque(recordings, right),
        **_of_corner(recordings.rig, worked.corner),
        **_of_axis(recordings, right),
        **_of_throw(right, sum(len(flight) for flight in recordings.flights.points)),
    }


def _of_ways(worked: Worked, right: dict[str, float]) -> dict[str, float]:
    """The answers of other ways: shares off."""
    ways = {
        "late": Way(width=WIDTH - 1, set_back=WIDTH // 2 - 1),
        "bare": Way(width=1, set_back=0),
        "slow": Way(least=FASTER),
        "constant": Way(constant="stall"),
        "rms": Way(current=math.sqrt(2.0)),
    }
    names = {"J": "J", "w": "K_fric_w", "0": "K_fric_0", "M": "M_max"}
    found = {way: worked.answers(how) for way, how in ways.items()}
    off = {f"{way}_{short}": of[name] / right[name] - 1.0 for way, of in found.items() for short, name in names.items()}
    return {**off, "rms_peak": found["rms"]["M_max"]}


def _of_filter(run: LabRun, right: dict[str, float]) -> dict[str, float]:
    """Half a sample and noise by what they are, and which samples remain."""
    fast, whole = np.abs(run.velocity) >= LEAST_SPEED, in_step(run)
    sign = np.sign(run.velocity)
    columns = np.stack([whole.acceleration, run.velocity, sign], axis=1)[fast]
    bend = np.gradient(whole.acceleration, run.sample_period)[fast]
    inertia = right["J"] / KG_CM2
    moved = np.linalg.lstsq(columns, 0.5 * run.sample_period * inertia * bend, rcond=None)[0].tolist()
    # third differences of a smooth speed are noise, 1 + 9 + 9 + 1 times its variance
    noise = rms(np.diff(run.velocity, 3)) / math.sqrt(20.0)
    noise_alpha = math.sqrt(2.0) * noise / run.sample_period
    attenuation = -((noise_alpha / rms(whole.acceleration[fast])) ** 2)

    def alike(least: float) -> float:
        speeds = np.abs(run.velocity[np.abs(run.velocity) >= least])
        return float(np.mean(speeds)) / rms(speeds)

    return {
        "project_J": moved[0] / inertia,
        "project_w": moved[1] / right["K_fric_w"],
        "project_0": moved[2] / right["K_fric_0"],
        "share": rms(right["K_fric_w"] * run.velocity + right["K_fric_0"] * sign) / rms(run.torque),
        "noise": noise,
        "noise_alpha": noise_alpha,
        "alpha_rms": rms(whole.acceleration[fast]),
        "attenuation": attenuation,
        "attenuation_half": 4.0 * attenuation,
        "kept": float(np.mean(np.abs(run.velocity) >= FASTER)),
        "alike_20": alike(LEAST_SPEED),
        "alike_60": alike(FASTER),
        "top": float(np.abs(run.velocity).max()),
    }


def _of_torque(recordings: LabRecordings, right: dict[str, float]) -> dict[str, float]:
    constant, current = torque_constant(recordings.rig), rms(recordings.with_friction.current)
    largest = float(recordings.fastest.current.max())
    more = math.sqrt(2.0) * current
    at = {name: float(constant(np.asarray(value))) for name, value in (("", current), ("2", more), ("max", largest))}
    return {
        "I_rms": current,
        "I_rms2": more,
        "I_max": largest,
        "kT_rms": at[""],
        "kT_rms2": at["2"],
        "kT_max": at["max"],
        "ratio_rms": right["kT_stall"] / at[""] - 1.0,
        "ratio_2": math.sqrt(2.0) * at["2"] / at[""] - 1.0,
        "I_turn": math.sqrt(-constant.constant / (3.0 * constant.curvature)) if constant.curvature else math.inf,
    }


def _of_corner(rig: Rig, corner: float) -> dict[str, float]:
    """The winding by a corner - rad/s -, by the course's circuit."""
    motor, sheet = circuit(rig), peak_curve(rig.motor, MAINS, rig.source)
    share = (sheet.no_load_speed - corner) / (sheet.no_load_speed - sheet.corner_speed)
    kelvin = motor.temperature_coefficient
    return {
        "corner": corner * RPM,
        "sheet": sheet.corner_speed * RPM,
        "share_R": share,
        "per_kelvin": 100.0 * kelvin,
        "temperature": HOT - (1.0 - share) / kelvin,
        "room": motor.cold_share,
    }


def _of_axis(recordings: LabRecordings, right: dict[str, float]) -> dict[str, float]:
    """Coasting, the hub, and friction by speed."""
    inertia, viscous, coulomb = right["J"] / KG_CM2, right["K_fric_w"], right["K_fric_0"]
    top = float(np.abs(recordings.with_friction.velocity).max())
    load, disk = right["J_load"] / KG_CM2, recordings.rig.load or Load()
    theory, rotor = disk.disk_inertia or math.nan, inertia - load
    diameter = (load / theory) ** 0.25 - 1.0
    return {
        "coast": inertia / viscous * math.log1p(viscous * top / coulomb),
        "coast_0": inertia * top / coulomb,
        "hub": load / theory - 1.0,
        "extra": (load - theory) * KG_CM2,
        "ring": 1e3 * (load - theory) / RING**2,
        "diameter": diameter,
        "millimetres": 1e3 * diameter * (disk.outer_diameter or math.nan),
        "rotor": rotor * KG_CM2,
        "rotor_share": rotor / load,
        "equal": coulomb / viscous,
        "equal_rpm": coulomb / viscous * RPM,
        "equal_power": 2.0 * coulomb**2 / viscous,
    }


def _of_throw(right: dict[str, float], points: int) -> dict[str, float]:
    a, b, c = (right[f"catapult_{name}"] for name in "abc")
    forward = math.sqrt(-GRAVITY / (2.0 * a))
    return {
        "v_y": forward,
        "angle": math.degrees(math.atan(b)),
        "v": forward * math.hypot(1.0, b),
        "apex": c - b**2 / (4.0 * a),
        "points": points,
        "per_point": 1e3 * math.sqrt(right["catapult_E"] / points),
    }


def write_questions(folder: Path, out: Path) -> tuple[list[Path], list[BenchError]]:
    """Write `questions.html` with the answers, and a page without them for each student, into a folder.

    Args:
        folder: with a folder of recordings for each student, or one student's; InputError where there is none.
        out: where to write.

    Returns:
        The paths, and why a student has none.
    """
    if not folder.is_dir():
        raise InputError(folder, "no such folder", "give the folder of the class, with a folder for each student")
    students = sorted(path for path in folder.iterdir() if path.is_dir() and path.name != "catapult") or [folder]
    students = [folder] if (folder / "catapult").exists() else students
    sections, pages, missing = [], {}, []
    for number, student in enumerate(students):
        try:
            asked = questions(LabRecordings.in_folder(student), number)
        except BenchError as reason:
            missing.append(InputError(student, f"has no questions ({reason})", "give recordings of all tasks"))
            continue
        name = re.sub(r"[^\w.-]", "-", student.resolve().name)
        sections.append(_section(student.name, asked, name))
        alone = _section(student.name, [replace(one, answer="") for one in asked], name)
        pages[f"questions/{name}.html"] = _page(f"{student.name}: three questions", alone)
    if sections:
        near = section("pages", "Without answers", neighbours({name: name[10:-5] for name in pages}))
        title = f"Three questions for each of {len(sections)}, with answers"
        pages["questions.html"] = _page(title, *sections, near)
    for name, page in pages.items():
        write_text(out / name, page)
    return [out / name for name in pages], missing


def _section(student: str, asked: list[AskedQuestion], key: str) -> Section:
    """Questions, each with its answer where it has one."""
    texts = []
    for one in asked:
        texts.append(f"{one.name[0].upper()}{one.name[1:]}. {one.text}")
        texts += [f"Answer: {one.answer}"] if one.answer else []
    return section(f"of-{key}", student, *(Paragraph(text=text) for text in texts))


def _page(verdict: str, *sections: Section) -> str:
    return html(Document(title=TITLE, subject=TITLE, verdict=verdict, tone="sure", answers={}, sections=sections))
