"""Sliders of the report's page: at their start its own figures, elsewhere what the course's Python makes of them."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from bench.course import peak_torque
from bench.course.answers import Worked
from bench.course.axis import KG_CM2, RPM, lab_rig, torque_constant
from bench.course.friction import CLOSE, DELAY, WIDTH, EquationOfMotion, filtered_acceleration, lateness, steepest
from bench.course.power import PowerOfRun, balanced_winding, circuits, speed_of_current
from bench.course.recordings import LabRecordings
from bench.course.report import Cover, lab_document
from bench.course.sliders import REDRAWN, sliders
from bench.course.winding import WindingModel, full_speed, run_winding
from bench.fit.lab import least_squares
from bench.plant.axis_model import AxisParameters
from bench.report.html import html

MOVE = """([key, steps]) => {
    const input = document.querySelector(`form.live input[name=${key}]`);
    input.value = steps;
    input.dispatchEvent(new Event("input"));
    return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
}"""
CELLS = """(key) => [...document.querySelectorAll(`#task-${key} table`)].at(-1).innerText && Object.fromEntries(
    [...[...document.querySelectorAll(`#task-${key} table`)].at(-1).rows].slice(1)
        .map((row) => [row.cells[0].textContent, [row.cells[1].textContent, row.cells[2].textContent]]))"""
DRAWN = "(key) => [...document.querySelectorAll(`#task-${key} .panels svg`)].map((svg) => svg.innerHTML)"


@pytest.fixture(scope="module")
def report(lab, browser):
    """The page, opened once for all tests; whatever it complains of is a failure."""
    page, complaints = browser.new_page(offline=True), []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto((lab.folder / "here" / "lab.html").as_uri())
    yield page
    page.close()
    assert complaints == []


@pytest.fixture
def page(report):
    yield report
    back(report)


def back(page):
    page.evaluate("document.querySelector('form.live button').click()")
    page.evaluate(MOVE, ["T", 0])


def moved(page, **steps):
    for key, count in steps.items():
        page.evaluate(MOVE, [key, count])


def shown(page, key):
    """Numbers of a task beside which the sliders' stand: as the page prints the report's, and theirs."""
    return {name: cells for name, cells in page.evaluate(CELLS, key).items() if cells[1]}


def test_at_their_start_sliders_show_the_reports_own_figures(page):
    found = {key: shown(page, key) for key in REDRAWN}
    assert {key: len(cells) for key, cells in found.items()} == {"8": 3, "9": 6, "10": 2, "11": 25}
    for cells in found.values():
        assert {name: theirs for name, (_, theirs) in cells.items()} == {name: own for name, (own, _) in cells.items()}


def printed(values):
    return {name: f"{value:.5g}" for name, value in values.items()}


def at(run, late, least, factor):
    """Fast samples with alpha late, and torque by so many times kT: by the course's filter, or between two of it."""
    whole, more = int(late), late - int(late)
    both = []
    for behind in (whole, whole + 1) if more else (whole,):
        mean, samples = filtered_acceleration(run, WIDTH, DELAY - behind)
        padded = np.full(run.time.size + WIDTH, np.nan)
        padded[samples.start : samples.start + mean.size] = mean
        both.append(padded[: run.time.size])
    alpha = both[0] if not more else (1.0 - more) * both[0] + more * both[1]
    fast = np.isfinite(alpha) & (np.abs(run.velocity) >= least)
    return alpha, fast, replace(run, torque=factor * run.torque)


@pytest.mark.parametrize(
    ("steps", "values"), [({"late": 2, "least": 20, "kT": -4}, (1.0, 40.0, 0.96)), ({"late": 3}, (1.5, 20.0, 1.0))]
)
def test_acceleration_that_is_late_and_another_threshold(page, steps, values):
    moved(page, **steps)
    run = LabRecordings.in_folder(None).with_friction
    alpha, fast, seen = at(run, *values)
    theta, _, error = least_squares(alpha[fast], seen.velocity[fast], seen.torque[fast])
    every = replace(
        seen, acceleration=np.where(np.isfinite(alpha), alpha, np.gradient(run.velocity, run.sample_period))
    )
    left = seen.torque - EquationOfMotion(*theta, error=error, halves=(0.0, 0.0, 0.0)).torque(every)
    expected = printed(
        {
            "J": theta[0] * KG_CM2,
            "K_fric_w": theta[1],
            "K_fric_0": theta[2],
            "E": error,
            "J_load": (theta[0] - lab_rig().motor.rotor_inertia) * KG_CM2,
            "RMS of M - M_est, all samples": np.sqrt(np.mean(left**2)),
        }
    )
    assert {name: theirs for name, (_, theirs) in shown(page, "9").items()} == expected
    remaining = shown(page, "8")
    assert remaining["samples remaining"][1] == f"{fast.sum():.5g}"
    assert remaining["samples removed"][1] == f"{run.time.size - fast.sum():.5g}"
    late = float(remaining["alpha_filt late, on t_sync"][1])
    assert late == (round(lateness(run, 1), 3) if values[0] == 1.0 else pytest.approx(1.5, abs=0.03))


def test_run_up_with_another_winding(page):
    """Torque constant 3 % up, the winding at 60 degC with twice the inductance, and the axis that task 9 finds then."""
    moved(page, kT=3, T=8, L=6, least=10)
    recordings = LabRecordings.in_folder(None)
    rig, run = recordings.rig, recordings.with_friction
    alpha, fast, seen = at(run, 0, 30.0, 1.03)
    theta, _, _ = least_squares(alpha[fast], seen.velocity[fast], seen.torque[fast])
    axis, constant = AxisParameters(*theta.tolist()), torque_constant(rig)
    constant = replace(constant, constant=1.03 * constant.constant, curvature=1.03 * constant.curvature)
    own = WindingModel.of(rig, 60.0, False)
    slow = replace(own.circuit, time_constant=2.0 * own.circuit.time_constant)
    demand = full_speed(rig, replace(axis, inertia=axis.inertia / 1.03))[1]
    still = replace(own, torque_constant=constant)
    inductive = replace(still, inductive=True, circuit=slow)
    without, late = (run_winding(winding, axis, demand) for winding in (still, inductive))
    power = PowerOfRun.of(late, inductive, axis)
    found = {name: theirs for name, (_, theirs) in shown(page, "11").items()}
    expected = {
        "corner, cold, quasi-static": without.corner * RPM,
        "corner, cold, with inductance": late.corner * RPM,
        "shift by inductance": (late.corner - without.corner) * RPM,
        "with inductance faster at 90% of the torque by": (late.speed_at(0.9) - without.speed_at(0.9)) * RPM,
        "power left over at most, course's circuit": power.lost,
    }
    assert {name: found[name] for name in expected} == printed(expected)
    peak = shown(page, "10")
    assert peak["peak torque"][1] == f"{1.03 * Worked(recordings).answers()['M_max']:.5g}"
    circuit = still.circuit
    corner = (circuit.voltage - circuit.resistance_at(60.0) * 5.7) / circuit.back_emf_constant
    assert peak["corner of the cold circuit"][1] == f"{corner * RPM:.5g}"


def test_winding_whose_power_balances(page):
    moved(page, T=6, L=3)
    rig = lab_rig()
    figures = circuits(rig, rig.motor.peak_curves[1])[3]
    winding = balanced_winding(rig, figures, 50.0)
    winding = replace(winding, circuit=replace(winding.circuit, time_constant=1.5 * winding.circuit.time_constant))
    found = shown(page, "9")
    theta = [float(found[name][1]) for name in ("J", "K_fric_w", "K_fric_0")]
    axis = AxisParameters(theta[0] / KG_CM2, *theta[1:])
    run = run_winding(winding, axis, full_speed(rig, axis)[1])
    corner = float(shown(page, "11")["power balances: cold"][1])
    assert corner == pytest.approx(run.corner * RPM, abs=0.1)  # the axis is known to five digits here
    lost = float(shown(page, "11")["power left over at most, power balances"][1])
    assert lost == pytest.approx(PowerOfRun.of(run, winding, axis).lost, rel=0.01)


def points_of(svg):
    """All numbers of the first line in a drawing."""
    return [float(number) for number in re.split("[, ]", re.search('points="([^"]+)"', svg)[1])]


TICK = re.compile(r'class="tick" x="([^"]+)" y="([^"]+)" text-anchor="(\w+)">([^<]+)<')
LINES = re.compile(r'(?: points="([^"]+)"| d="([^"]+)")')


def drawn(svg):
    """Series of a drawing that sliders made - (n, 2) each - in the units of its axes."""
    ticks = [
        (anchor, float(x) if anchor == "middle" else float(y) - 4.0, value) for x, y, anchor, value in TICK.findall(svg)
    ]
    scales = []
    for anchor in ("middle", "end"):
        places, values = zip(
            *((at, float(value.replace("−", "-"))) for one, at, value in ticks if one == anchor), strict=True
        )
        scales.append(np.polyfit(places, values, 1))
    series = [re.findall(r"-?[\d.]+,-?[\d.]+", line or path) for line, path in LINES.findall(svg)]
    places = [np.array([[float(number) for number in point.split(",")] for point in points]) for points in series]
    return [np.column_stack([np.polyval(scale, at[:, k]) for k, scale in enumerate(scales)]) for at in places]


def test_half_a_sample_is_seen_wherever_the_slider_puts_it(page):
    moved(page, late=1)
    in_step, mean, later = drawn(page.evaluate(DRAWN, "8")[5])
    run = LabRecordings.in_folder(None).with_friction
    alpha, _, _ = at(run, 0.5, 20.0, 1.0)
    near = slice(steepest(run) - CLOSE, steepest(run) + CLOSE)
    assert mean[:, 1] == pytest.approx(alpha[near], abs=5.0)
    assert mean[:, 0] == pytest.approx(run.time[near], abs=2e-5)
    assert later - mean == pytest.approx(np.tile([0.5e-3, 0.0], (2 * CLOSE, 1)), abs=2e-5)
    assert in_step[:, 1] == pytest.approx(np.gradient(run.velocity, run.sample_period)[near], abs=60.0)
    assert "set back by 1.5 samples" in page.locator("#task-8").inner_text()


def balances(constant):
    """The circuit whose power balances and that meets both peak curves, with another torque constant."""
    rig = lab_rig()
    ke, (low, high) = float(constant(np.asarray(5.7))), rig.motor.peak_curves
    figures = circuits(rig, high)[3]
    # by root finding, where the report solves a quadratic: R*I so that w*p*L*I is the same at both corners
    volts = figures.voltage * np.array([1.0, high.mains_voltage / low.mains_voltage])
    corners = np.array([low.corner_speed, high.corner_speed])

    def squared(drop):
        return (volts**2 - (drop + ke * corners) ** 2) / corners**2

    drop = brentq(lambda drop: np.diff(squared(drop))[0], 0.0, figures.voltage)
    return replace(figures, ke=ke, drop=drop, across=float(np.sqrt(squared(drop)[0])))


def test_peak_curves_of_both_mains_voltages_with_another_torque_constant(page):
    moved(page, kT=-10)
    rig, shown = lab_rig(), page.evaluate(DRAWN, "11")[4:]
    constant = torque_constant(rig)
    weaker = replace(constant, constant=0.9 * constant.constant, curvature=0.9 * constant.curvature)
    for svg, sheet in zip(shown, rig.motor.peak_curves, strict=True):
        datasheet, course, balanced = drawn(svg)
        assert datasheet[:, 1] == pytest.approx([3.5, 3.5, 0.0], abs=0.02)
        assert datasheet[1:, 0] == pytest.approx(np.array([sheet.corner_speed, sheet.no_load_speed]) * RPM, abs=15.0)
        for figures, curve in ((circuits(rig, rig.motor.peak_curves[1])[0], course), (balances(weaker), balanced)):
            speed, current = speed_of_current(figures, 5.7, weaker, sheet.mains_voltage / 230.0)
            assert curve[1:, 0] == pytest.approx(speed * RPM, abs=15.0)
            assert curve[1:, 1] == pytest.approx(weaker.torque(current), abs=0.02)


def test_the_table_at_the_drawings_speeds_has_a_line_for_the_sliders(page):
    line = "() => [...[...document.querySelector('#task-10 table').rows].at(-1).cells].map((cell) => cell.innerText)"
    assert page.evaluate(line)[1:] == ["3.49", "3.5", "3.5", "3.5", "3.49", "2.14", "-"]
    moved(page, kT=5)
    recordings = LabRecordings.in_folder(None)
    stronger = replace(recordings.fastest, torque=1.05 * recordings.fastest.torque)
    kept = peak_torque.run_up(stronger, recordings.rig)
    measured = peak_torque.measured_at_speeds(kept.velocity, kept.torque)
    assert page.evaluate(line)[1:] == [f"{value:.3g}" for value in measured[:-1]] + ["-"]


def test_diagrams_follow_and_come_back(page):
    before = {key: page.evaluate(DRAWN, key) for key in REDRAWN}
    moved(page, least=1)
    places = [points_of(svg) for svg in (before["9"][0], page.evaluate(DRAWN, "9")[0])]
    assert places[1] == pytest.approx(places[0], abs=0.5)  # the measured torque of task 9 stays where the report has it
    moved(page, T=4, L=-2, kT=2, late=1, least=10)
    after = {key: page.evaluate(DRAWN, key) for key in REDRAWN}
    unmoved = {key: [k for k, svg in enumerate(before[key]) if svg == after[key][k]] for key in REDRAWN}
    assert unmoved == {"8": [], "9": [], "10": [], "11": []}
    assert "40 °C, with inductance" in page.locator("#task-11").inner_text()
    assert not any("NaN" in svg for drawn in after.values() for svg in drawn)
    back(page)
    assert {key: page.evaluate(DRAWN, key) for key in REDRAWN} == before


def test_a_phone_and_a_page_without_scripts(lab, opened):
    phone = opened(lab.folder / "here" / "lab.html", width=400, color_scheme="dark")
    assert phone.locator("form.live").count() == 4
    assert phone.evaluate("document.documentElement.scrollWidth") <= 400
    still = opened(lab.folder / "here" / "lab.html", java_script_enabled=False)
    assert still.locator("form.live, .live").count() == 0
    assert still.locator("#task-11 .panels svg").count() == 6


def test_only_what_was_done_has_sliders(done, opened, tmp_path):
    recordings = LabRecordings.in_folder(None)
    assert sliders([done["2"]], recordings) is None
    results = [done["8"], done["10"]]
    text = html(lab_document(results, recordings, Cover()), own=sliders(results, recordings))
    (tmp_path / "page.html").write_text(text, encoding="utf-8")
    page = opened(tmp_path / "page.html")
    names = "[...document.querySelectorAll('form.live input')].map((input) => input.name)"
    assert page.evaluate(names) == ["kT", "late", "least", "kT"]
    moved(page, kT=5)
    assert shown(page, "10")["peak torque"][1] == f"{1.05 * done['10']['peak torque'].value:.5g}"
