"""Several recordings of one axis: what only one lacks the others give, and how they differ is reported."""

import json
from dataclasses import replace

import numpy as np
import pytest

import bench
from bench.errors import InputError, UndeterminedError
from bench.fit.identify import identify
from bench.rig.rig import load_rig
from bench.trace.trace import Trace
from bench.trace.write import write
from bench.validation.independent.effects import TorqueOffset
from bench.validation.independent.references import Motion, Ramps
from bench.validation.independent.rig import write_rig
from bench.validation.independent.sensors import Noise, Sensors
from bench.validation.independent.simulate import simulate as integrate
from tests.diagnosis.command import started
from tests.fit.motions import NAMES, RIG, UNITS, Truth, recording
from tests.fit.test_recovery import AXES
from tests.fit.test_recovery import __file__ as axes_file
from tests.kept import kept
from tests.recorded import STEP

#: About what is chosen for these motions, which takes a fifth of the time where it is given - Hz.
CUTOFF = 66.0
OFFSET = RIG.model_copy(update={"offset": True})
#: Of the inertia, viscous and Coulomb friction from one recording to the next.
SPREAD = np.array([0.01, 0.05, 0.04])


def inside(parameter, value):
    low, high = parameter.ci95
    return low <= value <= high


def one_way(axis, rng, side):
    """Speeds of one direction in random order, 0.3 s each."""
    points, acceleration = [(0.0, 0.0)], 0.4 * axis.peak_torque / axis.inertia
    for speed in (*rng.permutation(np.linspace(0.1, 0.9, 5)), 0.0):
        start = points[-1][0] + abs(side * axis.top_speed * speed - points[-1][1]) / acceleration
        points += [(start + each, side * axis.top_speed * speed) for each in (0.0, 0.3)]
    return Motion((Ramps(points, 0.02),))


def moving(run):
    """The recording without its start and without the end, where the drive may overshoot into the other direction."""
    trace = run.trace
    fast = np.abs(trace["velocity_reference"]) > 0.05 * run.axis.top_speed
    return trace.between(trace.time[fast][0], trace.time[fast][-1])


def test_runs_of_one_direction_determine_together_what_neither_does_alone(tmp_path):
    noise = {"velocity": Noise(white=0.03), "current": Noise(white=8e-3)}
    sensors = Sensors(**noise, encoder_resolution=2e-5, sample_period=1e-3)
    rng, held = np.random.default_rng(3), []
    offsets = [0.3 * axis.coulomb for axis in AXES]
    axes = [axis for axis in AXES for _ in range(2)]
    motions = [one_way(axis, rng, side) for axis in AXES for side in (1.0, -1.0)]
    effects = [(TorqueOffset(offset),) for offset in offsets for _ in range(2)]

    def integrated():
        return integrate(axes, motions, effects, [sensors] * len(axes), seed=4, longest_step=STEP)

    recorded = kept(integrated, __file__, axes_file)
    for k, (axis, offset) in enumerate(zip(AXES, offsets, strict=True)):
        write_rig(axis, tmp_path / "rig.toml")
        rig = load_rig(tmp_path / "rig.toml").model_copy(update={"offset": True})
        runs = [moving(run) for run in recorded[2 * k : 2 * k + 2]]
        for run in runs:
            with pytest.raises(UndeterminedError, match="Coulomb friction torque and torque offset"):
                identify(run, rig)
        found = identify(runs, rig)
        truth = dict(zip((*NAMES, "torque_offset"), (axis.inertia, axis.viscous, axis.coulomb, offset), strict=True))
        for name, value in truth.items():
            error = (found[name].value - value) / found[name].std_error
            print(f"\n{axis.name} {name}: {found[name].value / value - 1.0:+.3%}, {error:+.2f} standard errors", end="")
            assert abs(error) < 3.5
            held.append(inside(found[name], value))
        assert found["moment_of_inertia"].value == pytest.approx(axis.inertia, rel=2e-3)
        assert found["coulomb_friction_torque"].value == pytest.approx(axis.coulomb, rel=2e-2)
        for alone in found.recordings:
            assert {"moment_of_inertia", "viscous_friction_coefficient"} <= set(alone.parameters)
            assert "coulomb_friction_torque" not in alone.parameters
            assert "Coulomb friction torque and torque offset" in alone.reason
    assert np.mean(held) >= 0.75


@pytest.mark.parametrize(("offset", "reported"), [(7e-4, False), (1.4e-3, True)])
def test_an_offset_is_reported_from_its_own_interval_on(offset, reported):
    """Beside friction of 0.06 N*m, which alone decides how well it is known: half or one and a half half widths."""
    runs = [moving_at(side * np.array([20.0, 60.0]), seed, offset) for seed, side in enumerate((1.0, -1.0))]
    asked = identify(runs, OFFSET, CUTOFF)["torque_offset"]
    assert 0.2 < abs(asked.value) / asked.half_width < 2.0
    assert (abs(asked.value) > asked.half_width) == reported
    for rig, said in ((RIG, reported), (OFFSET, False)):
        warnings = [warning for warning in identify(runs, rig, CUTOFF).warnings if "--offset" in warning]
        assert len(warnings) == said and all("torque offset of 0.001" in warning for warning in warnings)


def moving_at(speeds, seed, offset=0.0):
    """Steady speeds one after the other, gone from one to the next in 0.3 s, in closed form."""
    rng, time, period, truth = np.random.default_rng(seed), np.arange(8000) * 1e-3, 1e-3, Truth()
    knots = np.repeat(np.tile(speeds, 4), 2)
    at = np.cumsum(np.tile([0.3, 0.7], knots.size // 2)) * 8.0 / knots.size * 2.0
    omega = np.interp(time, at, knots) + 0.2 * np.sin(40.0 * time)
    alpha = np.gradient(np.interp(time, at, knots), period) + 8.0 * np.cos(40.0 * time)
    torque = truth.inertia * alpha + truth.viscous * omega + truth.coulomb * np.sign(omega) + offset
    noisy = {"velocity": omega + rng.normal(scale=0.03, size=time.size)}
    noisy["current"] = (torque + rng.normal(scale=0.01, size=time.size)) / 0.8
    return Trace(time, noisy, UNITS, f"at {speeds}")


def test_two_speeds_in_two_recordings_tell_viscous_from_coulomb_friction():
    runs = [moving_at(np.array([speed, -speed]), seed) for seed, speed in enumerate((20.0, 80.0))]
    kept = [only_fast(run, 0.9 * np.abs(run["velocity"]).max()) for run in runs]
    for run in kept:
        with pytest.raises(UndeterminedError, match="viscous friction coefficient"):
            identify(run, RIG)
    found = identify(kept, RIG)
    for name, value in zip(NAMES, Truth().values, strict=True):
        assert inside(found[name], value)
        assert found[name].value == pytest.approx(value, rel=0.1)
    assert set(found.between) == {"moment_of_inertia", "load_moment_of_inertia"}


def only_fast(trace, least):
    """A recording less its changes of speed: holes are there in their place."""
    kept = np.abs(trace["velocity"]) > least
    return Trace(trace.time[kept], {n: v[kept] for n, v in trace.signals.items()}, UNITS, trace.origin)


def test_one_recording_in_a_list_is_that_recording():
    trace = recording(np.random.default_rng(5))
    assert identify([trace], RIG) == identify(trace, RIG)
    assert bench.identify((trace,), RIG).recordings == ()


def test_parts_of_recordings_are_parts_also_among_several():
    first, second = (recording(np.random.default_rng(k), duration=8.0) for k in (6, 7))
    whole = identify([first, second], RIG)
    parts = [iter([trace.between(0.0, 4.0), trace.between(4.0, 8.0)]) for trace in (first, second)]
    joined = identify(parts, RIG)
    for name in NAMES:
        assert abs(joined[name].value - whole[name].value) < 0.3 * whole[name].std_error
    assert whole.samples_read == joined.samples_read == 16000


def test_sample_periods_sources_shifts_and_hum_are_each_recordings_own():
    truth, rng = Truth(), np.random.default_rng(8)
    quick = recording(rng, truth, shift=0.3e-3)
    slow = recording(rng, truth, period=2e-3, shift=-0.4e-3, position=True)
    humming = recording(rng, truth)
    current = humming["current"] + 0.02 * np.sin(2.0 * np.pi * 50.0 * humming.time + 1.0)
    humming = replace(humming, signals={**humming.signals, "current": current})
    found = identify([quick, slow, humming], RIG)
    for name, value in zip(NAMES, truth.values, strict=True):
        assert abs(found[name].value - value) < 3.5 * found[name].std_error
        assert found[name].value == pytest.approx(value, rel=0.01)
    shifts = [alone.parameters["misalignment"].value for alone in found.recordings]
    assert shifts == pytest.approx([0.3e-3, -0.4e-3, 0.0], abs=0.05e-3)
    assert "misalignment" not in found.parameters
    assert found.residual.rms == pytest.approx(found.residual.noise_floor, rel=0.1)


def drawn(rng):
    """The axis as it is on another day."""
    values = np.array(Truth().values) * (1.0 + SPREAD * rng.normal(size=3))
    return Truth(*values)


@pytest.mark.parametrize(
    ("count", "draws"), [(2, 20), *(pytest.param(each, 100, marks=pytest.mark.slow) for each in (2, 4))]
)
def test_the_next_recording_lies_where_it_was_expected_and_the_axis_in_the_joint_interval(count, draws):
    rng, next_one, mean, narrow = np.random.default_rng(9), [], [], []
    for _ in range(draws):
        *runs, following = (recording(rng, drawn(rng), duration=1.5) for _ in range(count + 1))
        found, after = identify(runs, RIG, CUTOFF), identify(following, RIG, CUTOFF)
        ranges = [found.between[name].predictive95 for name in NAMES]
        next_one.append([low <= after[n].value <= high for n, (low, high) in zip(NAMES, ranges, strict=True)])
        mean.append([inside(found[n], value) for n, value in zip(NAMES, Truth().values, strict=True)])
        alone = found.recordings[0].parameters
        narrow.append([inside(alone[n], value) for n, value in zip(NAMES, Truth().values, strict=True)])
    coverage = np.mean(next_one, axis=0), np.mean(mean, axis=0), np.mean(narrow, axis=0)
    print(f"\n{count} recordings: next {coverage[0]}, joint {coverage[1]}, of one alone {coverage[2]} (J, K_w, K_0)")
    chance = 3.0 * np.sqrt(0.95 * 0.05 / draws)
    assert (coverage[0] > 0.95 - chance).all()
    # two recordings that agree by chance do not show that they differ: docs/identify.md
    assert (coverage[1] > (0.95 if count > 2 else 0.85) - chance).all()
    assert (coverage[2] < 0.7).any()


@pytest.mark.parametrize("draws", [20, pytest.param(100, marks=pytest.mark.slow)])
def test_recordings_that_are_alike_leave_the_joint_interval_as_narrow_as_their_noise(draws):
    rng, held, width, warned = np.random.default_rng(10), [], [], 0
    for _ in range(draws):
        runs = [recording(rng, duration=1.5) for _ in range(3)]
        found = identify(runs, RIG, CUTOFF)
        held.append([inside(found[n], value) for n, value in zip(NAMES, Truth().values, strict=True)])
        width.append([found[n].std_error / found.recordings[0].parameters[n].std_error for n in NAMES])
        warned += any("differ" in warning for warning in found.warnings)
    narrower = np.median(width, axis=0)
    print(f"\ncoverage {np.mean(held, axis=0)}, width over one alone {narrower}, warned {warned} of {draws}")
    assert (np.mean(held, axis=0) > 0.95 - 3.0 * np.sqrt(0.95 * 0.05 / draws)).all()
    assert (narrower < 0.8).all()
    assert warned <= 0.05 * draws


def test_recordings_that_differ_are_reported_and_widen_the_interval():
    rng = np.random.default_rng(11)
    runs = [recording(rng, Truth(inertia=Truth.inertia * factor)) for factor in (0.97, 1.0, 1.03)]
    found = identify(runs, RIG)
    (warning,) = found.warnings
    assert "the recordings differ in moment_of_inertia" in warning
    assert inside(found["moment_of_inertia"], Truth.inertia)
    assert found["moment_of_inertia"].std_error > 0.01 * Truth.inertia
    assert found.between["moment_of_inertia"].std_dev == pytest.approx(0.03 * Truth.inertia, rel=0.05)
    # what does not differ keeps the interval that noise gives it
    alone = found.recordings[0].parameters["coulomb_friction_torque"]
    assert found["coulomb_friction_torque"].std_error < alone.std_error


@pytest.mark.parametrize(
    ("second", "rig", "words"),
    [
        (lambda one: one, RIG, ["found the same recording"]),
        (lambda one: replace(one, signals={"velocity": one["velocity"]}), RIG, ["contains no current"]),
        (
            lambda one: replace(
                one,
                signals={"velocity": one["velocity"], "torque": one["current"] * 0.8},
                units={"velocity": "rad/s", "torque": "N*m"},
            ),
            bench.Rig.of({"name": "in ampere", "kind": "rotary"}),
            ["effort in N*m", "in A"],
        ),
    ],
    ids=["twice", "no current", "other unit"],
)
def test_recordings_that_do_not_go_together_are_refused(second, rig, words):
    first = recording(np.random.default_rng(12))
    with pytest.raises(InputError) as refusal:
        identify([first, second(first)], rig)
    for word in words:
        assert word in str(refusal.value)


def test_recordings_that_determine_it_neither_alone_nor_together_are_refused():
    runs = [moving_at(np.array([20.0, 60.0]), seed) for seed in (1, 2)]
    with pytest.raises(UndeterminedError, match="moves forward only"):
        identify(runs, OFFSET)
    with pytest.raises(InputError, match="found none"):
        identify([], RIG)


def test_the_command_writes_what_the_contract_asks_for(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = started(tmp_path)
    for k in (1, 2):
        write(recording(np.random.default_rng(k), duration=3.0), tmp_path / f"run{k}.csv")
    two = ("identify", "run1.csv", "run2.csv", "--rig", "rig.toml")
    assert command(*two, "--json", "found.json", "--out", "out") == 0
    found = json.loads((tmp_path / "found.json").read_text())
    assert [each["file"] for each in found["recordings"]] == ["run1.csv", "run2.csv"]
    assert found["provenance"]["traces"] == [{k: each[k] for k in ("file", "sha256")} for each in found["recordings"]]
    assert found["provenance"]["version"] == bench.__version__
    assert len(found["provenance"]["rig_sha256"]) == 64
    assert found["provenance"]["options"]["offset"] is False
    for name in NAMES:
        low, high = found["between"][name]["predictive95"]
        assert low < found["parameters"][name]["value"] < high
        assert found["between"][name]["std_dev"] >= 0.0
        assert all(name in each["parameters"] and each["reason"] is None for each in found["recordings"])
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"identification.png", "identification-2.png", "identify.json", "report.html", "report.json"}
    assert "the next one" in capsys.readouterr().out
    assert command("identify", "run1.csv", "--rig", "rig.toml", "--json", "one.json") == 0
    alone = json.loads((tmp_path / "one.json").read_text())
    assert (alone["recordings"], alone["between"]) == ([], None)
    assert [each["file"] for each in alone["provenance"]["traces"]] == ["run1.csv"]
    for option in ("--refine", "--estimator=lab"):
        assert command(*two, option) == 2
    assert "with one recording" in capsys.readouterr().err
