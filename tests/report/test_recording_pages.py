"""Pages of a recording, inspected or simulated: what they say, and that a browser shows them."""

import numpy as np
import pytest

from bench.assets import asset
from bench.effects.present import Present
from bench.plant.simulate import simulate
from bench.report.document import TimeGraph
from bench.report.inspection import inspection
from bench.report.over_time import unpacked
from bench.report.publish import write_html
from bench.report.simulation import simulation
from bench.rig.rig import load_rig
from bench.trace.choose import GivenOptions
from bench.trace.inspect import inspect_recording
from bench.trace.read import read_recording
from bench.trace.trace import assemble
from bench.trace.write import write
from tests.diagnosis.conftest import bench
from tests.diagnosis.test_commands import run_of
from tests.report.conftest import TRACE_NAME
from tests.report.test_page import HOSTILE

__all__ = ["bench"]
NAME = HOSTILE


def graph_of(page):
    (graph,) = [block for section in page.sections for block in section.blocks if isinstance(block, TimeGraph)]
    return graph


def values(curve):
    low, high = unpacked(curve.samples)
    return (low + high) / 2.0


@pytest.fixture(scope="module")
def simulated():
    cogging = Present.of("cogging_torque", {"amplitude": 0.05, "harmonic": 6.0})
    return simulate(load_rig(asset("data", "rigs", "sh30701p.toml")), "slow_reversals", effects=[cogging])


@pytest.fixture
def inspected(tmp_path):
    """Page of a recording of a hostile name, as it was written and read again."""
    write(run_of(), tmp_path / TRACE_NAME)
    recording = read_recording(tmp_path / TRACE_NAME)
    trace = assemble(recording, GivenOptions())
    return inspection(inspect_recording(recording, GivenOptions()), (), trace), trace


def test_an_inspection_shows_every_signal_as_it_is_read(inspected):
    page, trace = inspected
    assert page.verdict.startswith("It contains 1.999")
    assert page.tone == "sure"
    curves = {curve.name: curve for panel in graph_of(page).panels for curve in panel.curves}
    assert set(curves) == set(trace.signals)
    for name, signal in trace.signals.items():
        np.testing.assert_allclose(values(curves[name]), signal, atol=1.1 * np.ptp(signal) / 65534)


def test_a_simulation_shows_the_truth_beside_what_was_recorded(simulated):
    page = simulation(simulated, NAME)
    speed, noise = graph_of(page).panels[:2]
    names = [curve.name for curve in speed.curves]
    assert names == ["recorded", "true"]
    recorded, true = map(values, speed.curves)
    sensors = simulated.truth.sensors
    assert np.std(recorded - true) == pytest.approx(sensors.velocity_noise, rel=0.1)
    assert np.std(values(noise.curves[0])) == pytest.approx(sensors.velocity_noise, rel=0.1)
    assert "cogging torque (amplitude 0.05" in list(page.answers.values())[1].replace("\N{NO-BREAK SPACE}", " ")
    assert simulated.truth.as_json() in page.sections[-1].blocks[0].files[0].content


ODD = "Speed [rpm];Iq\n1;2\n2;3\n3;5\n"


@pytest.mark.parametrize(
    ("text", "more", "words"),
    [
        (ODD, (), ("It cannot be read yet", 'class="refused"', "Iq")),
        (None, ("--rig", "rig.toml"), ("cannot be identified from: velocity is derivative of position",)),
    ],
    ids=["no recording yet", "a failed check"],
)
def test_what_is_wrong_with_a_recording_is_the_verdict(bench, tmp_path, text, more, words):
    trace = run_of()
    wrong = {**trace.signals, "velocity": 3.0 * trace["velocity"]}
    write(type(trace)(trace.time, wrong, trace.units, trace.origin), tmp_path / "run.csv")
    if text is not None:
        (tmp_path / "run.csv").write_text(text, encoding="utf-8")
    status, out, _ = bench("inspect", "run.csv", *more, "--report", "run.html")
    assert (status, out.splitlines()[-1]) == (0, "wrote run.html")
    page = (tmp_path / "run.html").read_text(encoding="utf-8")
    assert not [word for word in words if word not in page]


def test_simulate_writes_its_page_beside_the_trace(bench, tmp_path):
    (tmp_path / "rig.toml").write_bytes(asset("data", "rigs", "sh30701p.toml").read_bytes())
    asked = ("simulate", "rig.toml", "--profile", "slow_reversals", "--out", "run.csv", "--report", "run.html")
    status, out, _ = bench(*asked)
    assert (status, out.splitlines()[-1]) == (0, "wrote run.html")
    assert "slow reversals were simulated." in (tmp_path / "run.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["inspection", "simulation"])
def test_a_page_opens(sound, inspected, simulated, tmp_path, name):
    write_html(tmp_path / "page.html", inspected[0] if name == "inspection" else simulation(simulated, NAME))
    page = sound(tmp_path / "page.html")
    assert page.locator("script:not([type])").count() == 1
    assert "alert(1)" in page.locator("header").inner_text()
