"""Several recordings in one diagnosis, and a holdout: how they differ, whose they are, and what a result came from."""

import hashlib
import json
from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.arrays import rms
from bench.diagnosis.same_axis import same_axis
from bench.errors import InputError
from bench.fit.rows import Rows
from bench.report.diagnosis import diagnosis_json
from bench.report.verdict import reasons
from bench.trace.write import write
from tests.diagnosis.command import started
from tests.diagnosis.constructed import COULOMB, INERTIA, SINES, VISCOUS, bare, base, moved, recorded, vibration
from tests.diagnosis.constructed import RIG as AXIS
from tests.fit.motions import NAMES, RIG, Truth, recording

PENDULUM, WARM, SECONDS = 0.12, 0.8, 1.5


def run_of(seed, truth=Truth(), **more):  # noqa: B008 - frozen
    found = recording(np.random.default_rng(seed), truth, **{"duration": 3.0, "position": True, **more})
    return replace(found, origin=f"run{seed}")


def with_torque(trace, torque):
    return replace(trace, signals={**trace.signals, "current": trace["current"] + torque / 0.8})


def with_unbalance(trace):
    return with_torque(trace, PENDULUM * np.sin(trace["position"]))


def inside(parameter, value):
    return parameter.ci95[0] <= value <= parameter.ci95[1]


def test_an_effect_in_both_recordings_is_found_in_both_and_the_holdout():
    runs = [with_unbalance(run_of(k)) for k in (1, 2)]
    found = bench.diagnose(runs, RIG, with_unbalance(run_of(3)))
    assert (found.verdict, [effect.name for effect in found.effects]) == ("explained", ["unbalance"])
    assert inside(found.effects[0].parameters["amplitude"], PENDULUM)
    for name, value in zip(NAMES, Truth().values, strict=True):
        assert found.parameters[name].value == pytest.approx(value, rel=0.03)
        assert set(found.between) == set(NAMES)
    assert [alone.origin for alone in found.recordings] == ["run1", "run2"]
    assert found.holdout.same is True
    content = json.loads(diagnosis_json(found))
    assert [each["file"] for each in content["recordings"]] == ["run1", "run2"]
    assert set(content["between"]) == set(NAMES)
    one = json.loads(diagnosis_json(bench.diagnose(runs[:1], RIG)))
    assert (one["recordings"], one["between"]) == ([], None)


def test_what_warms_up_does_so_in_every_recording_anew():
    def warming(trace):
        cold = Truth.coulomb * np.sign(trace["velocity"]) + Truth.viscous * trace["velocity"]
        return with_torque(trace, WARM * np.exp(-trace.time / SECONDS) * cold)

    found = bench.diagnose([warming(run_of(k, duration=5.0, bias=30.0)) for k in (1, 2)], RIG)
    assert (found.verdict, [effect.name for effect in found.effects]) == ("explained", ["friction_warmup"])
    assert found.effects[0].parameters["time_constant"].value == pytest.approx(SECONDS, rel=0.15)
    assert found.velocity.identify[1] < 0.7 * found.velocity.identify[0]


def test_hum_of_another_phase_in_every_recording_is_no_remainder():
    def humming(trace, phase):
        return with_torque(trace, 0.02 * np.sin(2.0 * np.pi * 50.0 * trace.time + phase))

    found = bench.diagnose([humming(run_of(1), 0.0), humming(run_of(2), 2.0)], RIG)
    assert (found.verdict, found.effects) == ("nothing_missing", [])


def test_recordings_that_differ_widen_the_interval_and_are_reported():
    runs = [run_of(k, Truth(inertia=Truth.inertia * (1.0 + 0.004 * (k - 2)))) for k in (1, 2, 3)]
    found = bench.diagnose(runs, RIG)
    assert any("the recordings differ in moment_of_inertia" in warning for warning in found.warnings)
    low, high = found.parameters["moment_of_inertia"].ci95
    assert low < 0.997 * Truth.inertia < 1.003 * Truth.inertia < high
    assert found.between["moment_of_inertia"].std_dev == pytest.approx(0.004 * Truth.inertia, rel=0.1)


@pytest.mark.parametrize("seed", [1, 5, 7])
def test_runs_that_each_go_one_way_are_one_recording_of_both(seed):
    """Through all of one of them an event would act as the offset does: what lasts that long is none."""
    runs = [run_of(seed + k, Truth(offset=0.03), bias=300.0 * (-1.0) ** k, position=False) for k in (0, 1)]
    assert any("only" in warning for warning in bench.diagnose(runs[0], RIG).warnings)
    found = bench.diagnose(runs, RIG)
    assert [effect.name for effect in found.effects] == ["torque_offset"]
    assert inside(found.effects[0].parameters["torque"], 0.03)
    assert inside(found.parameters["coulomb_friction_torque"], Truth.coulomb)
    assert all("Coulomb friction torque and torque offset" in alone.reason for alone in found.recordings)


def test_the_command_takes_several_and_no_holdout_that_is_one_of_them(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = started(tmp_path)
    for k in (1, 2):
        write(run_of(k), tmp_path / f"run{k}.csv")
    two = ("diagnose", "run1.csv", "run2.csv", "--rig", "rig.toml")
    assert command(*two, "--json", "found.json", "--out", "out") == 0
    found = json.loads((tmp_path / "found.json").read_text())
    assert found["verdict"] == "nothing_missing"
    assert [each["file"] for each in found["provenance"]["traces"]] == ["run1.csv", "run2.csv"]
    assert [each["sha256"] for each in found["recordings"]] == [t["sha256"] for t in found["provenance"]["traces"]]
    assert command("replay", "out/model.toml", "run2.csv", "--rig", "rig.toml", "--out", "replay.csv") == 0
    assert command(*two, "--holdout", "run2.csv") == 2
    assert "the recording itself" in capsys.readouterr().err
    with pytest.raises(InputError, match="the same recording"):
        bench.diagnose([run_of(1), run_of(1)], RIG)


HERE, THERE = moved(3.0), moved(3.0, sines=tuple((size, 1.1 * f, phase + 1.0) for size, f, phase in SINES))
UNITS = dict(zip(NAMES, ("kg*m**2", "N*m*s/rad", "N*m"), strict=True))


def compared(*more, here=()):
    """Whether a holdout is of the axis, on closed forms hardly noisy: J is known within 0.02 %, K_w within 0.6 %."""
    fitted = bare(recorded(HERE, *here, noise=0.1))
    width = fitted.rows.conditioning.filter.width
    return same_axis(fitted, Rows.of(recorded(THERE, *more, seed=1, noise=0.1), AXIS, width=width), UNITS)


def unknown(share):
    """A torque no effect is, such that it makes up that share, RMS, of a recording's."""
    return lambda motion: vibration(np.sqrt(2.0) * share / np.sqrt(1.0 - share**2) * rms(base(motion)), 11.0)(motion)


QUANTITIES = [
    (INERTIA, "acceleration", (0.992, 1.008), (0.988, 1.012, 0.973, 1.028), (0.968, 1.032)),
    (VISCOUS, "velocity", (0.79, 1.28), (0.75, 1.32, 0.35, 2.95), (0.31, 3.05)),
    (COULOMB, "sign", (0.92, 1.09), (0.90, 1.11, 0.68, 1.48), (0.655, 1.52)),
]


@pytest.mark.parametrize("place", range(3))
def test_what_may_differ_is_distinguished_from_other_conditions_and_another_axis(place):
    """Inertia by 1 and 3 %, viscous friction by 1.3 and 3, Coulomb friction by 1.1 and 1.5 times, either way."""
    value, signal, alike, other_conditions, another_axis = QUANTITIES[place]
    for factors, same, differs in ((alike, True, 0), (other_conditions, None, 1), (another_axis, False, 1)):
        for factor in factors:
            found = compared(lambda motion, by=factor: (by - 1.0) * value * getattr(motion, signal))
            assert (found.same, [*found.differs]) == (same, [NAMES[place]][:differs]), factor
            assert bool(found.warnings) == (same is False)


@pytest.mark.parametrize(
    ("here", "there", "same"), [(0.0, 0.18, True), (0.0, 0.22, False), (0.08, 0.22, True), (0.08, 0.28, False)]
)
def test_a_torque_that_the_effects_do_not_explain_there_is_another_axis(here, there, same):
    """A fifth of the holdout's torque, and three times the share of the recording's."""
    found = compared(unknown(there), here=(unknown(here),) if here else ())
    assert found.same is same
    assert ("unexplained by the effects found" in " ".join(found.warnings)) is not same


@pytest.mark.parametrize(
    ("changed", "same", "quantities", "warned"),
    [
        ({}, True, [], ""),
        ({"coulomb": 1.49}, None, ["coulomb_friction_torque"], ""),
        ({"coulomb": 0.8, "viscous": 0.6}, None, ["viscous_friction_coefficient", "coulomb_friction_torque"], ""),
        ({"inertia": 1.02}, None, ["moment_of_inertia"], ""),
        ({"inertia": 1.2}, False, ["moment_of_inertia"], "1.2 times the inertia"),
        ({"inertia": 20.0}, False, ["moment_of_inertia"], "20 times the inertia"),
        ({"coulomb": 2.5}, False, ["coulomb_friction_torque"], "times the Coulomb friction"),
    ],
    ids=str,
)
def test_a_holdout_that_differs_says_in_what(changed, same, quantities, warned):
    truth = replace(Truth(), **{name: factor * getattr(Truth, name) for name, factor in changed.items()})
    found = bench.diagnose(run_of(1, duration=2.0), RIG, run_of(2, truth, duration=2.0))
    content = json.loads(diagnosis_json(found))["holdout"]
    assert (content["same_axis"], [each["quantity"] for each in content["differs"]]) == (same, quantities)
    for each in content["differs"]:
        place = NAMES.index(each["quantity"])
        for which, true in (("recording", Truth()), ("holdout", truth)):
            low, high = each[f"{which}_ci95"]
            assert low < each[which] < high
            assert each[which] == pytest.approx(true.values[place], rel=0.05)
    if quantities:
        assert found.verdict == "unexplained_remainder"
        assert any("holdout" in said for said in reasons(found))
    assert len(found.warnings) == bool(warned)
    assert all(warned in warning and "not used as proof" in warning for warning in found.warnings)


def test_without_a_holdout_nobody_can_tell():
    found = bench.diagnose(run_of(1, duration=2.0), RIG)
    assert json.loads(diagnosis_json(found))["holdout"] == {"same_axis": None, "differs": []}
    units = {"moment_of_inertia": "kg*m**2", "viscous_friction_coefficient": "", "coulomb_friction_torque": ""}
    assert same_axis(None, None, units).same is None


def test_the_json_says_what_it_came_from(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = started(tmp_path)
    for k in (1, 2):
        write(run_of(k, Truth(coulomb=Truth.coulomb * (1.0 + 0.5 * (k == 2)))), tmp_path / f"run{k}.csv")
    arguments = ("diagnose", "run1.csv", "--rig", "rig.toml", "--without", "backlash", "--json", "found.json")
    assert command(*arguments, "--holdout", "run2.csv", "--out", "out") == 0

    def digest(name):
        return hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()

    found = json.loads((tmp_path / "found.json").read_text())
    assert found["provenance"] == {
        "version": bench.__version__,
        "rig_sha256": digest("rig.toml"),
        "traces": [{"file": "run1.csv", "sha256": digest("run1.csv")}],
        "options": {"without": ["backlash"]},
        "holdout": {"file": "run2.csv", "sha256": digest("run2.csv")},
    }
    assert json.loads((tmp_path / "out" / "diagnosis.json").read_text())["provenance"] == found["provenance"]
    assert "the holdout differs: Coulomb friction torque" in capsys.readouterr().out
