"""Flights of the catapult: read in any form that students hand in, and doubted where no throw scatters so."""

import shutil
import zipfile

import numpy as np
import pytest
import scipy.io

from bench.assets import asset
from bench.course.flights import contradiction, find_flights, read_flights
from bench.errors import InputError

POINTS = np.array(read_flights(asset("data", "traces") / "catapult").points)
GRAVITY, HEIGHT, SPEED, ANGLE = 9.81, 0.46, 3.75, np.radians(45.0)


def lines(*columns, separator=";", decimal="."):
    """Rows of numbers (n,) each as text."""
    rows = zip(*columns, strict=True)
    return "".join(separator.join(f"{value:.9g}".replace(".", decimal) for value in row) + "\n" for row in rows)


def each_in(name, head, row, **how):
    """Writes flights in files of their own; `row`: their columns of y - m -, z - m - and time - s."""

    def write(folder):
        (folder / "catapult").mkdir()
        for k, flight in enumerate(POINTS):
            columns = row(*flight.T, 0.02 * np.arange(len(flight)))
            (folder / "catapult" / name.format(k)).write_text(head + lines(*columns, **how))

    return write


def zipped(folder):
    """German tables in cm, beside what is none."""
    with zipfile.ZipFile(folder / "Katapult.zip", "w") as archive:
        for k, flight in enumerate(POINTS):
            archive.writestr(f"data/versuch{k:02}.txt", "y [cm];z [cm]\n" + lines(*100.0 * flight.T, decimal=","))
        for none in ("data/readme.md", "__MACOSX/versuch.txt", "data/.versuch.txt"):
            archive.writestr(none, "no table")


def side_by_side(folder):
    head = ";".join(f"y{k} [m];z{k} [m]" for k in range(1, 11))
    text = lines(*(side for flight in POINTS for side in flight.T), decimal=",")
    (folder / "Katapult.csv").write_text(f"{head}\n{text}")


def numbered(folder):
    rows = "\n".join(f"{k},{y},{z}" for k, flight in enumerate(POINTS, 1) for y, z in flight)
    (folder / "catapult.csv").write_text(f"flight,y [m],z [m]\n{rows}\n")


def with_a_readme(folder):
    shutil.copytree(asset("data", "traces") / "catapult", folder / "catapult")
    (folder / "catapult" / "readme.txt").write_text("Ten flights, recorded on a Monday.\ny, z in m\n")


def mat(content):
    return lambda folder: scipy.io.savemat(folder / "Katapult_Gruppe7.mat", content)


FORMS = {
    "time, mm and another order": each_in("{:02}.csv", "z [mm];y [mm];t [s]\n", lambda y, z, t: (1e3 * z, 1e3 * y, t)),
    "y, z, t": each_in("{:02}.csv", "y,z,t\n", lambda y, z, t: (y, z, t), separator=","),
    "no head": each_in("{:02}.txt", "", lambda y, z, t: (y, z), separator=" "),
    "blanks, decimal commas": each_in(
        "{:02}.txt", "y [m]  z [m]\n\n", lambda y, z, t: (y, z), separator="  ", decimal=","
    ),
    "zip": zipped,
    "side by side": side_by_side,
    "numbered": numbered,
    "a readme": with_a_readme,
    "sides": mat({"y": POINTS[..., 0].T, "z": POINTS[..., 1].T}),
    "matrices": mat({f"flight{k}": flight for k, flight in enumerate(POINTS)}),
    "numbered sides": mat({f"{side}{k}": f[:, j] for k, f in enumerate(POINTS) for j, side in enumerate("yz")}),
    "structs": mat({f"exp{k}": {"y": flight[:, 0], "z": flight[:, 1]} for k, flight in enumerate(POINTS)}),
    "block": mat({"flights": POINTS}),
}


@pytest.mark.parametrize("form", FORMS)
def test_flights_of_any_form_are_the_same(tmp_path, form):
    FORMS[form](tmp_path)
    assert np.array(read_flights(find_flights(tmp_path)).points) == pytest.approx(POINTS, abs=1e-8)


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("catapult.csv", b"y,z\n1,2\n", "at least three"),
        ("catapult.csv", b"y [kg],z [m]\n1,2\n2,3\n3,4\n", "kg"),
        ("catapult.csv", b"y,z\n1,2\n2,three\n3,4\n", "line 3"),
        ("catapult.csv", b"", "at least three"),
        ("catapult.csv", b"y [m];z\n0;100\n1;900\n2;1000\n3;400\n", "lengths that span 900 without a unit.*y \\[mm\\]"),
        ("catapult.zip", b"PK no zip", "zip"),
        ("catapult.mat", b"MATLAB 5.0 MAT-file".ljust(200), r"catapult\.mat"),
        ("Katapult.xlsx", b"PK", r"Katapult\.xlsx: is no table that can be read, as files ending in \.xlsx"),
    ],
)
def test_bad_tables_are_refused(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_flights(find_flights(tmp_path))


def test_lengths_beyond_a_throw_are_read_with_a_unit_of_each_column(tmp_path):
    (tmp_path / "one.csv").write_text("y [m];z [mm]\n0;100\n1;900\n2;1000\n3;400\n")
    np.testing.assert_allclose(read_flights(tmp_path).points[0][:, 1], [0.1, 0.9, 1.0, 0.4])


def throws(random, flights=10, points=20):
    """Ballistic throws (flights, points, 2) - m - as `simulation` has them: 1.5 % of the spring, 0.5 degrees, 4 mm."""
    speed = SPEED * np.sqrt(1.0 + 0.015 * random.standard_normal(flights))
    angle = ANGLE + np.radians(0.5) * random.standard_normal(flights)
    y, z = speed * np.cos(angle), speed * np.sin(angle)
    lands = (z + np.sqrt(z**2 + 2.0 * GRAVITY * (HEIGHT - 0.05))) / GRAVITY
    time = np.linspace(0.0, lands, points).T
    path = np.stack([y[:, None] * time, HEIGHT + z[:, None] * time - GRAVITY * time**2 / 2.0], axis=2)
    return path + 0.004 * random.standard_normal(path.shape)


@pytest.mark.parametrize("students", [150, pytest.param(1000, marks=pytest.mark.slow)])
def test_no_scatter_of_the_launch_is_a_mistake_and_a_flight_counted_the_other_way_is(students):
    """Of 1000 students none is flagged; at half the limit some five are, and a class of 40 fails one time in six."""
    random = np.random.default_rng(1)
    assert [found for found in (contradiction(throws(random)) for _ in range(students)) if found] == []
    for k in range(students // 8):
        flights = throws(random)
        flights[k % 10][:, 0] *= -1.0
        assert contradiction(flights).endswith("its y is counted the other way")
