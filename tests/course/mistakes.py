"""Mistakes that students make with their recordings, of random strengths, and words that name each."""

import json
from dataclasses import dataclass, field

import numpy as np

from bench.course.course import TASKS, course
from bench.course.flights import find_flights, read_flights
from bench.course.recordings import LabRecordings
from bench.course.report import lab_json
from bench.trace.read import read

BARE, FRICTION, FASTEST = NAMES = ("JLoadWithoutFriction", "JLoadAndFriction", "MaxAcc")
SI = "time [s];velocity [rad/s];current [A]"


@dataclass
class Folder:
    """What a student hands in: a table (n, 3) of time, speed, current and its head for each name, and flights."""

    tables: dict
    flights: list
    heads: dict = field(default_factory=lambda: dict.fromkeys(NAMES, SI))

    def scale(self, names, *factors):
        for name in names:
            self.tables[name] = self.tables[name] * factors

    def write(self, folder):
        (folder / "catapult").mkdir(parents=True)
        for name, rows in self.tables.items():
            text = "".join(f"{t:.7g};{w:.7g};{i:.7g}\n" for t, w, i in rows)
            (folder / f"{name}.csv").write_text(f"{self.heads[name]}\n{text}", encoding="utf-8")
        for k, flight in enumerate(self.flights):
            text = "".join(f"{y:.4f};{z:.4f}\n" for y, z in flight)
            (folder / "catapult" / f"{k}.csv").write_text(f"y [m];z [m]\n{text}")


def some(random):
    """All recordings, or one of them."""
    return NAMES if random.random() < 0.5 else (str(random.choice(NAMES)),)


def in_other_units(name, *factors):
    """Some recordings in units that are not those of their head: time, speed, current times these factors."""

    def mistake(of, random):
        of.scale(some(random), *factors)

    mistake.__name__ = name
    return mistake


def scale_of_the_current(of, random):
    of.scale(NAMES, 1.0, 1.0, random.choice([random.uniform(1.06, 1.3), random.uniform(0.8, 0.93)]))


def late(of, random):
    for name in some(random):
        rows, by = of.tables[name], int(random.integers(1, 8))
        moved = (rows[:-by, 2], rows[by:, 1]) if random.random() < 0.5 else (rows[by:, 2], rows[:-by, 1])
        of.tables[name] = np.column_stack([rows[: len(rows) - by, 0], moved[1], moved[0]])


def files_swapped(of, random):
    one, other = random.choice(NAMES, 2, replace=False)
    of.tables[one], of.tables[other] = of.tables[other], of.tables[one]


def the_same_file_twice(of, random):
    of.tables[BARE] = of.tables[FRICTION]


def columns_swapped(of, random):
    for name in NAMES:
        of.tables[name] = of.tables[name][:, [0, 2, 1]]


def columns_swapped_in_the_units_of_the_course(of, random):
    of.scale(NAMES, 1e3, 180.0 / np.pi, 1e3)
    of.heads = dict.fromkeys(NAMES, "time [ms];velocity [deg/s];current [mA]")
    columns_swapped(of, random)


def glitch(of, random):
    name, column = str(random.choice(NAMES)), int(random.integers(1, 3))
    rows = of.tables[name].copy()
    place = int(random.integers(50, len(rows) - 50))
    rows[place, column] += random.choice([-1.0, 1.0]) * random.uniform(0.3, 1.0) * np.ptp(rows[:, column])
    of.tables[name] = rows


def one_sample_at_zero(of, random):
    rows = of.tables[FRICTION].copy()
    rows[np.argmax(rows[:, 1]) + int(random.integers(-20, 20)), 1] = 0.0
    of.tables[FRICTION] = rows


def hole(of, random):
    rows, start = of.tables[FASTEST], int(random.integers(60, 300))
    of.tables[FASTEST] = np.delete(rows, slice(start, start + int(random.integers(20, 80))), axis=0)


def flight_swapped(of, random):
    k = int(random.integers(len(of.flights)))
    of.flights[k] = of.flights[k][:, ::-1]


def flight_with_an_outlier(of, random):
    k = int(random.integers(len(of.flights)))
    of.flights[k] = of.flights[k].copy()
    of.flights[k][int(random.integers(20)), 1] += random.uniform(0.1, 1.0)


def two_at_once(of, random):
    of.scale(NAMES, 1.0, 180.0 / np.pi, 1e3)


def cut_off(of, random):
    name = str(random.choice([BARE, FRICTION]))
    rows = of.tables[name].copy()
    limit = random.uniform(0.5, 0.98) * rows[:, 2].max()
    rows[:, 2] = np.clip(rows[:, 2], -limit, limit)
    of.tables[name] = rows


def held(of, random):
    rows, start = of.tables[FRICTION].copy(), int(random.integers(200, 300))
    rows[start : start + int(random.integers(10, 60)), 2] = rows[start, 2]
    of.tables[FRICTION] = rows


def rounded(of, random):
    for name in some(random):
        step, rows = random.uniform(0.1, 0.5), of.tables[name]
        of.tables[name] = np.column_stack([rows[:, :2], np.round(rows[:, 2] / step) * step])


def filtered(of, random):
    lag = np.exp(-np.arange(200) / random.uniform(10.0, 15.0))
    rows = of.tables[FASTEST]
    smooth = [np.convolve(column, lag / lag.sum())[: len(rows)] for column in rows[:, 1:].T]
    of.tables[FASTEST] = np.column_stack([rows[:, 0], *smooth])


def a_few_percent(of, random):
    of.scale((str(random.choice([BARE, FRICTION])),), 1.0, 1.0, random.choice([0.96, 0.98, 1.02, 1.04]))


def one_flight_twice(of, random):
    one, other = random.choice(len(of.flights), 2, replace=False)
    of.flights[one] = of.flights[other]


def half_of_the_flights_mirrored(of, random):
    for k in random.choice(len(of.flights), len(of.flights) // 2, replace=False):
        of.flights[k] = of.flights[k] * [-1.0, 1.0]


#: What no undoing mends, and words that tell it.
BEYOND_MENDING = {
    cut_off: "it was cut off, or held",
    held: "it was cut off, or held",
    rounded: "of the largest: too coarse",
    filtered: "it was filtered",
    a_few_percent: "one axis has one J",
    one_flight_twice: "are one and the same",
    half_of_the_flights_mirrored: "its y is counted the other way",
}
#: Each mistake, and words that name it.
MISTAKES = {
    in_other_units("degrees_as_radians", 1.0, 180.0 / np.pi, 1.0): "deg/s that is labelled rad/s",
    in_other_units("radians_as_degrees", 1.0, np.pi / 180.0, 1.0): "rad/s that is labelled deg/s",
    in_other_units("rpm_as_radians", 1.0, 30.0 / np.pi, 1.0): "rpm that is labelled rad/s",
    in_other_units("turns_as_radians", 1.0, 0.5 / np.pi, 1.0): "turns/s that is labelled rad/s",
    in_other_units("seconds_as_ms", 1e-3, 1.0, 1.0): "s that are labelled ms",
    in_other_units("ms_as_seconds", 1e3, 1.0, 1.0): "ms that are labelled s",
    in_other_units("milliamperes_as_amperes", 1.0, 1.0, 1e3): "mA that is labelled A",
    in_other_units("amperes_as_milliamperes", 1.0, 1.0, 1e-3): "A that is labelled mA",
    in_other_units("peak_for_rms", 1.0, 1.0, np.sqrt(2.0)): "√2 times too large",
    scale_of_the_current: "correct its scale",
    in_other_units("sign", 1.0, 1.0, -1.0): "opposite directions",
    late: "not of the same instants",
    files_swapped: "files look exchanged",
    the_same_file_twice: "one and the same recording",
    columns_swapped: "columns of speed and current look exchanged",
    columns_swapped_in_the_units_of_the_course: "columns of speed (deg/s) and current (mA) look exchanged",
    glitch: "a glitch",
    one_sample_at_zero: "a glitch",
    hole: "has a hole",
    flight_swapped: "its y and z are exchanged",
    flight_with_an_outlier: "is an outlier",
    two_at_once: "labelled A",
}


def recorded_in(folder):
    """Tables and flights of a folder of sound recordings."""
    traces = {name: read(folder / f"{name}.trace") for name in NAMES}
    tables = {
        name: np.column_stack([trace.time, trace["velocity"], trace["current"]]) for name, trace in traces.items()
    }
    return tables, read_flights(find_flights(folder)).points


#: Tasks of which nothing depends on the folder but time.
SIMULATED = {"11", "tracking"}


def results_of(folder, without=SIMULATED):
    """The recordings of a folder, and what comes of the tasks."""
    recordings = LabRecordings.in_folder(folder)
    return recordings, course(recordings, keys={task.key for task in TASKS} - without)


def tasks_of(folder):
    """Tasks as the report of a folder has them."""
    recordings, results = results_of(folder)
    return json.loads(lab_json(results, recordings.rig.name))["tasks"]


def wrong_numbers(tasks, truth):
    """Numbers of tasks that are done and further from the truth than they say."""
    found = {(task["key"], n["name"]): n for task in tasks if task["status"] == "done" for n in task["numbers"]}
    return {key: found[key] for key, true in truth.items() if key in found and wrong(found[key], true)}


def wrong(number, true):
    return abs(number["value"] - true) > number["half"]
