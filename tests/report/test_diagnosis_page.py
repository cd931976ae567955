"""The page of a diagnosis says what the diagnosis found, and draws the signals whose gaps it states."""

import base64
import json
from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.diagnosis import diagnose
from bench.diagnosis.name import NamedEffect
from bench.diagnosis.policy import Reason
from bench.effects.catalogue import catalogue
from bench.effects.present import Present
from bench.plant.model_file import LOADED
from bench.report.diagnosis import diagnosis, verdict_sentence
from bench.report.document import Chart, TimeGraph
from bench.report.gap import _telling
from bench.report.over_time import unpacked
from bench.report.publish import read_document
from bench.report.verdict import reason
from bench.rig.rig import Rig
from tests.diagnosis.test_commands import run_of, with_unbalance
from tests.fit.motions import recording
from tests.report.conftest import blocks

RIG = {"name": "axis", "kind": "rotary", "motor": {"torque_constant": "0.8 N*m/A", "rotor_inertia": "2 kg*cm**2"}}


@pytest.fixture(scope="module")
def diagnosed():
    return diagnose(with_unbalance(run_of(duration=4.0)), Rig.of(RIG), excluded=frozenset({"torsion_spring"}))


@pytest.fixture(scope="module")
def page(found):
    return read_document(found / "report.json")


def rms(values):
    return np.sqrt(np.nanmean(values**2))


def test_what_is_drawn_over_time_has_the_gaps_that_are_reported(found, page):
    gap = json.loads((found / "diagnosis.json").read_text(encoding="utf-8"))["gap"]
    graphs = blocks(page, TimeGraph)
    assert [graph.choices for graph in graphs] == [("inertia and friction", "+ unbalance")] * 2
    for graph, name in zip(graphs, ("identify", "holdout"), strict=True):
        assert graph.step == pytest.approx(1e-3)
        for panel, what in ((graph.panels[1], "velocity"), (graph.panels[3], "torque")):
            before, after = (unpacked(curve.samples)[0] for curve in panel.curves)
            assert rms(before) == pytest.approx(gap[what][name]["before"], rel=5e-3)
            # torque is stated over the rows of the balance, every one of which is drawn
            assert rms(after) == pytest.approx(gap[what][name]["after"], rel=0.01)


def test_the_measured_speed_is_that_of_the_recording(page):
    graph = blocks(page, TimeGraph)[0]
    measured, spread = unpacked(graph.panels[0].curves[0].samples)[0], graph.panels[0].curves[0].samples.scale
    np.testing.assert_allclose(measured, with_unbalance(run_of(duration=4.0))["velocity"], atol=spread)


def test_the_found_effect_is_drawn_into_the_gap(page):
    (chart,) = blocks(page, Chart)
    over = chart.panels[0]
    assert [panel.x_label for panel in chart.panels] == ["position", "velocity", "current", "time"]
    assert [panel.x_unit for panel in chart.panels] == ["rad", "rad/s", "A", "s"]
    series = {one.name: one for one in over.series}
    line, floor = series["unbalance, fitted"], series["noise floor"]
    # an eccentric mass: 0.12 N*m times the sine of the angle, less what inertia and friction took up of it
    wave = 0.12 * np.sin(np.array(line.x))
    assert np.corrcoef(wave, np.array(line.y))[0, 1] > 0.95
    assert np.max(np.abs(series["remaining residual"].y)) < floor.high[0] < np.max(np.abs(line.y))


def test_each_instant_has_the_bins_that_it_was_in(page):
    (chart,), graph = blocks(page, Chart), blocks(page, TimeGraph)[0]
    time, trace = graph.start + graph.step * np.arange(graph.count), with_unbalance(run_of(duration=4.0))
    true = {"position": np.mod(trace["position"], 2.0 * np.pi), "velocity": trace["velocity"], "time": trace.time}
    for panel in chart.panels:
        bins = np.frombuffer(base64.b64decode(panel.bins), "<i2")
        places = np.array(next(one for one in panel.series if one.name == "gap").x)
        assert bins.size == graph.count
        assert set(bins[bins >= 0]) == set(range(places.size))
        if panel.x_label in true:
            values = np.interp(time, trace.time, true[panel.x_label])[bins >= 0]
            np.testing.assert_allclose(places[bins[bins >= 0]], values, atol=np.diff(places).max())


def test_every_effect_is_reported_with_a_reason(diagnosed):
    assert {one.effect.name for one in diagnosed.considered} == set(catalogue())
    assert all(reason(one.reason) for one in diagnosed.considered)
    accepted = [one.effect.name for one in diagnosed.considered if one.accepted]
    assert accepted == [effect.name for effect in diagnosed.effects] == ["unbalance"]
    reasons = {one.effect.name: one for one in diagnosed.considered}
    assert reasons["torsion_spring"].reason.criterion == "excluded"
    assert reasons["unbalance"].of_gap > 0.9
    assert reasons["quadratic_drag"].of_gap < 0.2
    assert all(0.0 <= one.of_gap <= 1.0 for one in diagnosed.considered if one.of_gap is not None)


def test_profiles_and_time_series_agree_with_the_steps(diagnosed):
    (series,) = diagnosed.time_series
    assert len(series.velocity_residuals) == len(series.torque_residuals) == len(diagnosed.steps) == 2
    for k, step in enumerate(diagnosed.steps):
        assert rms(series.torque_residuals[k]) == pytest.approx(step.torque[0])
        assert rms(series.velocity_residuals[k].astype(float)) == pytest.approx(step.velocity[0])
    for one in diagnosed.where:
        assert one.centres.size == one.means.size
        assert [each.size for each in one.after] == ([] if one.coordinate == "frequency" else [one.means.size])
    shares = [one.share for one in diagnosed.where]
    assert shares == sorted(shares, reverse=True)


def test_the_picture_shows_a_wave_at_its_amplitude():
    """The filter takes half of the torque of 24 waves a turn at these speeds, bins of equal count the rest."""
    amplitude, harmonic = 0.05, 24
    trace = recording(np.random.default_rng(2), duration=6.0, position=True)
    current = trace["current"] + amplitude * np.sin(harmonic * trace["position"]) / 0.8
    trace = replace(trace, signals={**trace.signals, "current": current})
    found = diagnose(trace, {"motor": {"torque_constant": "0.8 N*m/A"}})
    gap = next(one for one in found.where if one.coordinate == "position")
    assert gap.curve is not None
    assert np.quantile(gap.curve[1], 0.98) == pytest.approx(amplitude, rel=0.05)
    assert np.quantile(gap.means, 0.98) == pytest.approx(amplitude, rel=0.1)
    assert np.abs(gap.after[0]).max() < 0.1 * amplitude


def test_the_verdict_fits_what_was_found(diagnosed):
    assert "was missing" in verdict_sentence(diagnosed)
    assert "the torque residual is noise" in verdict_sentence(diagnosed)
    unsure = replace(
        diagnosed, verdict="unexplained_remainder", objections=(Reason("stopped", {"reason": "something remains"}),)
    )
    assert verdict_sentence(unsure).endswith("but something remains.")
    page = diagnosis(unsure, "t")
    assert page.tone == "open"
    assert page.answers["Does it move like the axis now?"].startswith("Nearly: ")
    nothing = replace(diagnosed, effects=[], verdict="nothing_missing")
    assert verdict_sentence(nothing).startswith("No missing effect found")
    unknown = replace(unsure, effects=[])
    assert verdict_sentence(unknown).startswith("An unknown effect is likely: something remains")
    sensor = next(effect for effect in catalogue().values() if effect.of_measurement)
    wrong = replace(diagnosed, effects=[NamedEffect(sensor, {}, (), {})])
    assert "was wrong in the measurement" in verdict_sentence(wrong)


def test_the_picture_shows_the_recording_over_a_stretch_where_what_was_found_stands_out(diagnosed):
    """Measured, before and after are the recording's own; after follows what before does not."""
    stretch, over = diagnosis(diagnosed, "t").glance
    measured, before, after = (one for one in stretch.panels[0].series)
    (series,) = diagnosed.time_series
    kept = np.isin(series.time[series.rows], measured.x)
    assert kept.sum() == len(measured.x) >= 30
    np.testing.assert_allclose(series.torque[kept], measured.y)
    np.testing.assert_allclose(series.torque[kept] - series.torque_residuals[0][kept], before.y)
    off, left = (rms(np.subtract(measured.y, one.y)) for one in (before, after))
    assert off > 5.0 * left
    assert off > 0.1 * np.ptp(measured.y)
    assert over.panels[0].x_label == "position"


def test_a_recording_too_short_for_a_stretch_has_the_gap_alone(diagnosed):
    (series,) = diagnosed.time_series
    short = {name: getattr(series, name)[:50] for name in ("time", "velocity", "torque")}
    residuals = tuple(each[:50] for each in series.torque_residuals)
    few = replace(series, **short, velocity_residuals=(None, None), rows=np.arange(50), torque_residuals=residuals)
    assert len(diagnosis(replace(diagnosed, time_series=(few,)), "t").glance) == 1


def test_a_page_says_where_no_model_could_be_had(diagnosed):
    unknown = replace(
        diagnosed,
        velocity=replace(diagnosed.velocity, identify=None),
        time_series=tuple(replace(one, velocity_residuals=(None, None)) for one in diagnosed.time_series),
    )
    page = diagnosis(unknown, "t")
    assert page.answers["Does it move like the axis now?"].startswith("Not known")
    (graph,) = blocks(page, TimeGraph)
    assert [panel.label for panel in graph.panels] == ["speed", "torque", "torque, measured less modelled"]


def test_a_page_says_what_mujoco_lacks_of_the_model(diagnosed):
    question, model = "Does MuJoCo have all of it?", diagnosed.model.model
    assert question not in diagnosis(diagnosed, "t").answers
    ripple = Present.of("torque_ripple", {"relative_amplitude": 0.1, "harmonic": 4.0})
    more = replace(diagnosed.model, model=model.with_effects((*model.effects, ripple)))
    answer = diagnosis(replace(diagnosed, model=more), "t").answers[question]
    assert answer.startswith(f"No: model.xml lacks torque_ripple. To simulate them too: {LOADED} ")


def test_the_stretch_that_is_shown_moves():
    """Where an axis stands, steps of its sensor are all of the speed that the bare axis does not have."""
    time = np.arange(2000) * 1e-3
    stands = time < 1.0
    measured = np.where(stands, 0.01 * (np.sin(40.0 * time) > 0.9), 3.0 * np.sin(8.0 * (time - 1.0)))
    bare = np.where(stands, 0.0, measured + 0.3 * np.sin(25.0 * time))
    _, part = _telling(np.stack([measured, bare, bare]), [slice(0, time.size)])
    assert part is not None and not stands[part].any()


def test_a_suspect_that_was_added_leads_to_its_fit(found, page):
    (suspects,) = (section for section in page.sections if section.key == "suspects")
    table = suspects.blocks[0]
    led = {row[0]: link for row, link in zip(table.rows, table.links, strict=True) if link}
    assert set(led) == {row[0] for row in table.rows if row[1] == "yes"} == {"unbalance"}
    text = (found / "report.html").read_text(encoding="utf-8")
    for name, link in led.items():
        assert f'<a href="{link}">{name}</a>' in text
        _, _, fit = text.partition(f'id="{link.removeprefix("#")}"')
        assert fit.startswith(f' tabindex="0" role="region" aria-label="Parameters: {name.capitalize()}: ')
