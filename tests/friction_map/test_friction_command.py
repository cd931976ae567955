"""`bench friction` as a user meets it: steady speeds of a closed-form friction curve, from files to table, figure."""

import json

import numpy as np
import pytest

from bench.trace.trace import Trace
from bench.trace.write import write
from tests.diagnosis.conftest import bench
from tests.fit.motions import UNITS

__all__ = ["bench"]
VISCOUS, COULOMB, OFFSET = 8e-4, 0.06, 0.004
STATIC, STRIBECK = 0.075, 4.0
#: Speeds of both directions.
SPEEDS = np.concatenate([sign * np.geomspace(0.5, 60.0, 14) for sign in (-1.0, 1.0)])


def friction(speed, rise):
    bent = COULOMB + rise * np.exp(-((speed / STRIBECK) ** 2))
    return VISCOUS * speed + bent * np.sign(speed) + OFFSET


def steady(speeds=SPEEDS, rise=0.0, scatter=2e-4, turned=1.0, ramp=0.0):
    """Write a recording of a fifth of a second for each speed; returns their names."""
    rng, names = np.random.default_rng(3), []
    time = np.arange(200) * 1e-3
    for k, speed in enumerate(speeds):
        velocity = speed * (1.0 + ramp * (time - time.mean())) + rng.normal(scale=0.03, size=time.size)
        torque = friction(speed, rise) + rng.normal(scale=scatter) + rng.normal(scale=2e-3, size=time.size)
        names.append(f"at{k}.csv")
        write(Trace(time, {"velocity": velocity, "current": turned * torque / 0.8}, UNITS, "closed form"), names[-1])
    return names


def test_stribeck_friction_is_named_with_its_values_drawn_and_written(bench, tmp_path):
    names = steady(rise=STATIC - COULOMB)
    status, out, err = bench("friction", *names, "--rig", "rig.toml", "--json", "f.json", "--out", "f.png")
    assert (status, err) == (0, "")
    for words in ("Stribeck friction (static friction", "viscous friction coefficient", "28 steady speeds", "f.png"):
        assert words in out
    assert (tmp_path / "f.png").stat().st_size > 10_000
    found = json.loads((tmp_path / "f.json").read_text())
    assert (found["schema"], found["effect"]["name"]) == ("bench.friction/1", "stribeck_friction")
    values = found["effect"]["parameters"]
    assert values["static_friction"] == {"value": pytest.approx(STATIC, rel=0.02), "unit": "N*m"}
    assert values["stribeck_velocity"] == {"value": pytest.approx(STRIBECK, rel=0.15), "unit": "rad/s"}
    assert found["parameters"]["viscous_friction_coefficient"]["value"] == pytest.approx(VISCOUS, rel=0.02)
    assert found["parameters"]["coulomb_friction_torque"]["value"] == pytest.approx(COULOMB, rel=0.02)
    assert found["parameters"]["torque_offset"]["value"] == pytest.approx(OFFSET, rel=0.1)
    assert found["chance"] < 1e-9
    assert found["unexplained"]["after"] < 0.2 * found["unexplained"]["before"]
    assert len(found["velocity"]["values"]) == len(found["effort"]["values"]) == SPEEDS.size


@pytest.mark.parametrize("dwell", [0.1, 1.0])
def test_one_recording_of_all_speeds_is_cut_where_it_keeps_one(bench, dwell):
    """Ramps of 400 rad/s**2 between them, whose inertia takes five times the friction."""
    steps = np.concatenate([np.geomspace(2.0, 60.0, 10), -np.geomspace(2.0, 60.0, 10), [0.0]])
    ramps = np.abs(np.diff(steps, prepend=0.0)) / 400.0
    ends = np.cumsum(ramps + dwell)
    knots = np.column_stack([ends - dwell, ends]).ravel()
    time = np.arange(0.0, ends[-1], 1e-3)
    velocity = np.interp(time, knots, np.repeat(steps, 2), left=0.0)
    torque = friction(velocity, 0.0) + 1.5e-3 * np.gradient(velocity, time)
    rng = np.random.default_rng(8)
    noisy = {"velocity": velocity + rng.normal(scale=0.01, size=time.size)}
    noisy["current"] = (torque + rng.normal(scale=2e-3, size=time.size)) / 0.8
    write(Trace(time, noisy, UNITS, "closed form"), "all.csv")
    status, out, err = bench("friction", "all.csv", "--rig", "rig.toml", "--json", "-")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["effect"] is None and len(found["velocity"]["values"]) == 20
    np.testing.assert_allclose(np.sort(found["velocity"]["values"]), np.sort(steps[:-1]), rtol=0.01)
    assert found["parameters"]["viscous_friction_coefficient"]["value"] == pytest.approx(VISCOUS, rel=0.02)
    assert found["parameters"]["coulomb_friction_torque"]["value"] == pytest.approx(COULOMB, rel=0.01)


def test_friction_without_an_effect_is_given_no_name(bench):
    status, out, err = bench("friction", *steady(), "--rig", "rig.toml", "--json", "-", "--out", "f.png")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert found["effect"] is None
    assert found["chance"] > 1e-3
    assert found["parameters"]["coulomb_friction_torque"]["value"] == pytest.approx(COULOMB, rel=0.01)


def test_a_direction_of_its_own_takes_the_offset_whole(bench):
    """Closed form: the backward half has twice the viscous friction; the constant is D_0/2, no offset beside it."""
    names = steady()
    for name, speed in zip(names[:14], SPEEDS[:14], strict=True):
        torque = friction(speed, 0.0) + VISCOUS * speed
        signals = {"velocity": np.full(200, speed), "current": np.full(200, torque / 0.8)}
        write(Trace(np.arange(200) * 1e-3, signals, UNITS, "closed form"), name)
    status, out, _ = bench("friction", *names, "--rig", "rig.toml", "--json", "-")
    assert status == 0
    found = json.loads(out)
    assert found["effect"]["name"] == "direction_dependent_friction"
    assert found["effect"]["parameters"]["coulomb_difference"]["value"] == pytest.approx(2.0 * OFFSET, rel=0.1)
    assert found["effect"]["parameters"]["viscous_difference"]["value"] == pytest.approx(-VISCOUS, rel=0.05)
    assert "torque_offset" not in found["parameters"]


def assert_refused(done, folder, names, status, words):
    """In one line with these words, and without a file."""
    assert (done.status, done.out, done.err.count("\n")) == (status, "", 1), done.err
    assert [word for word in words if word not in done.err] == []
    assert sorted(entry.name for entry in folder.iterdir()) == sorted([*names, "rig.toml"])


@pytest.mark.parametrize(
    ("speeds", "words"),
    [
        (SPEEDS[:18], ["found 4 steady speeds", "at least 8 different speeds"]),
        (np.repeat(SPEEDS[::3], 3), ["found 5 steady speeds"]),
        (SPEEDS[14:], ["found 0 steady speeds"]),
        (np.concatenate([np.linspace(-19.0, -10.0, 9), np.linspace(10.0, 19.0, 9)]), ["no speed twice another"]),
    ],
    ids=["few", "repeated", "one direction", "narrow"],
)
def test_too_few_speeds_are_status_one_with_what_to_record(bench, tmp_path, speeds, words):
    names = steady(speeds)
    done = bench("friction", *names, "--rig", "rig.toml", "--json", "f.json", "--out", "f.png")
    assert_refused(done, tmp_path, names, 1, ["record instead", *words])


@pytest.mark.parametrize(
    ("changes", "arguments", "words"),
    [
        ({"speeds": SPEEDS[:4], "ramp": 5.0}, (), ["at0.csv", "keeps no speed", "steady speeds, each kept for"]),
        ({"turned": -1.0}, (), ["opposite signs", "[trace.columns]"]),
        ({"speeds": SPEEDS[:4]}, ("at3.csv",), ["at3.csv", "again"]),
        ({"speeds": SPEEDS[:4]}, ("nowhere.csv",), ["nowhere.csv", "no such file"]),
        ({}, ("--out", "f.doc"), ["f.doc", ".png"]),
    ],
    ids=["ramp", "turned", "twice", "missing", "ending"],
)
def test_bad_input_is_one_line_and_status_two(bench, tmp_path, changes, arguments, words):
    names = steady(**changes)
    done = bench("friction", *names, *arguments, "--rig", "rig.toml", "--json", "f.json")
    assert_refused(done, tmp_path, names, 2, words)
