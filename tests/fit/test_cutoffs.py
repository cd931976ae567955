"""An estimate that moves with the cut-off, that leaves much, or that cannot be: reported, widened or refused."""

import json

import numpy as np
import pytest

from bench.arrays import rms
from bench.fit.cutoffs import BELOW, Tried, among
from bench.fit.estimate import RefusedEstimateError
from bench.fit.identify import choose, identify
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from bench.trace.write import write
from tests.diagnosis.command import started
from tests.fit.motions import NAMES, RIG, UNITS, Truth, recording

INERTIA = NAMES[0]


def fed_back(rng, gain=0.2, noise=0.05, **what):
    """A drive that answers the noise of its speed: current holds -gain*noise, which moves the axis hardly."""
    truth = Truth()
    trace = recording(rng, truth, velocity_noise=0.0, **what)
    hiss = rng.normal(scale=noise, size=len(trace))
    signals = {"velocity": trace["velocity"] + hiss, "current": trace["current"] - gain * hiss / 0.8}
    return truth, trace.with_signals(signals, {})


def test_a_clean_recording_keeps_the_highest_cut_off():
    trace = recording(np.random.default_rng(0))
    found, (doubt, warnings) = choose(trace, RIG, None)
    cutoff = found.rows.conditioning.filter.cutoff
    assert cutoff == pytest.approx(identify(trace, RIG).cutoff)
    assert not doubt.any() and not warnings
    assert cutoff == pytest.approx(66.3, rel=0.01)


def estimates(*inertias, widths):
    """Estimates of J at falling cut-offs, from 100 Hz, with half widths of 95 %; friction alike at all."""
    found = []
    for k, (inertia, width) in enumerate(zip(inertias, widths, strict=True)):
        theta, reach = np.array([inertia, 1.0, 1.0]), np.array([width, 0.1, 0.1])
        found.append(Tried(100.0 * 10.0 ** (-0.25 * k), theta, reach, lambda: np.zeros(3)))
    return found


@pytest.mark.parametrize(("narrow", "taken"), [(0.61, 0), (0.59, 2), (0.35, 2)])
def test_a_lower_cut_off_is_taken_where_its_interval_is_clearly_narrower(narrow, taken):
    tried = estimates(1.0, 1.0, 1.0, widths=(0.1, 0.09, 0.1 * narrow))
    place, (_, warnings) = among(tried, RIG.axis_kind)
    assert place == taken
    assert not warnings


@pytest.mark.parametrize(("inertia", "rejected"), [(1.13, False), (1.15, True)])
def test_an_estimate_counts_where_it_agrees_with_those_at_all_lower_cut_offs(inertia, rejected):
    """Two half widths of 0.1 leave 0.1414 of room, and rounding 1e-4."""
    tried = estimates(inertia, 1.0, 1.0, widths=(0.1, 0.1, 0.1))
    place, (_, warnings) = among(tried, RIG.axis_kind)
    assert (place > 0) == rejected == bool(warnings)


def test_what_may_still_be_off_is_what_the_next_moved_but_no_more_than_lower_ones_leave():
    _, (moved, _) = among(estimates(1.3, 1.0, 1.0, widths=(0.1, 0.1, 0.3)), RIG.axis_kind)
    assert moved == pytest.approx([0.3, 0.0, 0.0])
    place, (bounded, _) = among(estimates(2.0, 1.0, 1.02, widths=(0.1, 0.1, 0.3)), RIG.axis_kind)
    assert place == 1
    assert bounded[0] == pytest.approx(0.02 + 0.3)
    _, (lowest, _) = among(estimates(2.0, 1.0, widths=(0.1, 0.1)), RIG.axis_kind)
    assert lowest[0] == pytest.approx(1.0)


def test_noise_that_the_drive_feeds_back_moves_the_cut_off_and_leaves_the_inertia():
    rng, kept, plain = np.random.default_rng(1), [], []
    for _ in range(10):
        truth, trace = fed_back(rng, speed=0.05, duration=8.0)
        found, (fixed, _) = identify(trace, RIG), choose(trace, RIG, 66.25)
        kept.append((found[INERTIA].value / truth.inertia - 1.0, found[INERTIA].half_width / truth.inertia))
        plain.append(fixed.theta[0] / truth.inertia - 1.0)
        assert found.cutoff < 0.7 * 66.25
    error, width = np.array(kept).T
    chosen, highest = (100.0 * rms(np.array(errors)) for errors in (error, plain))
    print(f"\nJ off by {chosen:.2f} % at the cut-off chosen, by {highest:.1f} % at 66 Hz")
    assert chosen < 0.2 * highest
    assert np.mean(np.abs(error) < width) >= 0.8


def test_it_is_reported_where_the_estimate_moves():
    truth, trace = fed_back(np.random.default_rng(2), gain=0.3, speed=0.04, duration=8.0)
    found = identify(trace, RIG)
    (moves,) = [warning for warning in found.warnings if "moves with the filter's cut-off" in warning]
    assert "Hz" in moves and "bench diagnose" in moves
    assert found[INERTIA].ci95[0] < truth.inertia < found[INERTIA].ci95[1]


def test_a_cut_off_that_is_asked_for_is_taken():
    _, trace = fed_back(np.random.default_rng(3), speed=0.05)
    assert identify(trace, RIG, cutoff=40.0).cutoff == pytest.approx(40.0)
    assert BELOW[-1] == pytest.approx(0.1)


def cut_in_stretches(trace, rng, length, moving):
    """The recording behind a long standstill with coarse speed, and cut into short stretches by holes."""
    rest = np.arange(4 * length) * trace.sample_period
    signals = {"velocity": np.zeros(rest.size), "current": rng.normal(scale=0.01 / 0.8, size=rest.size)}
    starts = np.arange(0, len(trace) - length, length + 40)[:moving]
    kept = np.concatenate([np.arange(start, start + length) for start in starts])
    gone = rest[-1] + 1.0
    time = np.concatenate([rest, gone + trace.time[kept]])
    return Trace(
        time, {name: np.concatenate([signals[name], trace[name][kept]]) for name in signals}, UNITS, "in stretches"
    )


def test_conditioning_is_read_where_the_axis_moves():
    """The longest stretch is one at rest, whose coarse speed shows no noise: J was drawn towards zero."""
    rng, truth = np.random.default_rng(4), Truth()
    trace = recording(rng, truth, speed=0.05, velocity_noise=0.1, torque_noise=1e-4, duration=60.0)
    cut = cut_in_stretches(trace, rng, 300, 150)
    assert len(cut.segments) > 100
    found = identify(cut, RIG)
    assert found[INERTIA].value == pytest.approx(truth.inertia, rel=0.03)


@pytest.mark.parametrize("kind", ["drag", "offset", "wave"])
def test_misfit_counts_in_the_interval(kind):
    rng, truth = np.random.default_rng(5), Truth()
    inside = []
    for _ in range(8):
        trace = recording(rng, truth, position=True)
        w = trace["velocity"]
        more = {"drag": 4e-6 * w * np.abs(w), "offset": 0.02 + 0.0 * w, "wave": 0.03 * np.sin(trace["position"])}[kind]
        found = identify(trace.with_signals({"current": trace["current"] + more / 0.8}, {}), RIG)
        inside.append([found[n].ci95[0] <= v <= found[n].ci95[1] for n, v in zip(NAMES, truth.values, strict=True)])
        assert found.residual.rms > 1.12 * found.residual.noise_floor
        assert any("bench diagnose" in warning for warning in found.warnings)
    print(f"\n{kind}: inside {np.mean(inside, axis=0)} (J, viscous, Coulomb)")
    assert np.mean(inside, axis=0)[0] >= 0.9


def test_the_share_explained_is_reported():
    trace = recording(np.random.default_rng(6))
    found = identify(trace, RIG)
    assert found.explained == pytest.approx(1.0 - (found.residual.relative) ** 2, abs=2e-3)
    assert found.explained > 0.99


def test_less_than_half_explained_is_no_identification():
    rng = np.random.default_rng(7)
    trace = recording(rng, duration=8.0)
    foreign = 3.0 * np.sin(2.0 * np.pi * 1.7 * trace.time + 0.4)
    with pytest.raises(RefusedEstimateError) as refused:
        identify(trace.with_signals({"current": trace["current"] + foreign}, {}), RIG)
    assert refused.value.estimate.explained < 0.5
    assert INERTIA in refused.value.estimate.parameters


def test_a_load_lighter_than_nothing_is_refused():
    rig = Rig.of(
        {"name": "a", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A", "rotor_inertia": "1 kg*m**2"}}
    )
    with pytest.raises(
        RefusedEstimateError, match=r"load moment of inertia cannot be determined: .*negative.*rotor_inertia"
    ):
        identify(recording(np.random.default_rng(8)), rig)


def test_one_way_tells_the_inertia_all_the_same(tmp_path, capsys):
    trace = recording(np.random.default_rng(9), speed=0.5, bias=300.0)
    with pytest.raises(RefusedEstimateError, match="forward only") as refused:
        identify(trace, RIG)
    parameters = refused.value.estimate.parameters
    assert parameters[INERTIA].value == pytest.approx(Truth().inertia, rel=5e-3)
    assert "coulomb_friction_torque" not in parameters
    write(trace, tmp_path / "run.csv")
    status = started(tmp_path)("identify", "run.csv", "--rig", "rig.toml", "--json", "found.json")
    assert status == 1
    assert "forward only" in capsys.readouterr().err
    found = json.loads((tmp_path / "found.json").read_text(encoding="utf-8"))
    assert found["parameters"][INERTIA]["value"] == pytest.approx(Truth().inertia, rel=5e-3)
    assert "forward only" in found["refused"] and found["explained"] > 0.5
