"""The page that shows a model moving: its numbers, and what it does in a browser without a network."""

import base64
import re

import numpy as np
import pytest

from bench.axis_kind import LINEAR, ROTARY
from bench.report.document import Samples
from bench.report.over_time import unpacked
from bench.report.publish import write_html
from bench.report.simulation import MOST, motion_of, view
from tests.report.test_page import HOSTILE
from tests.view.motions import AHEAD, SPEED, shown


def floats(packed):
    """Values of a motion in a page, whole or in 16 bits."""
    if isinstance(packed, dict):
        return unpacked(Samples.model_validate(packed))[0]
    return np.frombuffer(base64.b64decode(packed), dtype="<f4").astype(float)


def instants(motion):
    return motion.start + motion.step * np.arange(motion.count)


def test_a_motion_holds_every_sample_and_its_difference_apart():
    motion = motion_of(shown())
    assert (motion.count, motion.step) == (2001, pytest.approx(1e-3))
    np.testing.assert_allclose(floats(motion.position), SPEED * instants(motion), rtol=1e-6)
    np.testing.assert_allclose(unpacked(motion.runs[0].apart)[0], AHEAD, rtol=1e-5)


def test_a_hole_stays_one():
    motion = motion_of(shown(hole=(0.5, 0.8)))
    inside = (instants(motion) > 0.5015) & (instants(motion) < 0.7985)
    assert np.isnan(floats(motion.position)[inside]).all()
    assert np.isfinite(floats(motion.position)[~inside]).mean() > 0.99


def test_a_long_motion_is_thinned_and_stays_small():
    motion = motion_of(shown(duration=200.0))
    assert motion.count == MOST
    np.testing.assert_allclose(floats(motion.position), SPEED * instants(motion), atol=SPEED * 0.51e-3 + 1e-4)
    assert len(motion.model_dump_json()) < 500_000


@pytest.mark.parametrize(("speed", "slowed"), [(1.0, 1), (10.0, 2), (150.0, 50), (1e4, 100)])
def test_what_turns_plays_at_first_as_slow_as_eyes_can_follow(speed, slowed):
    slow = shown()
    assert (
        motion_of(type(slow)(**{**vars(slow), "ghost_velocity": slow.ghost_velocity * speed / SPEED})).slowed == slowed
    )


@pytest.fixture
def player(opened, tmp_path):
    """Opens the page of a motion."""

    def play(*arguments, width=1280, scheme="light", title="model along run", **options):
        (tmp_path / "model.toml").touch()
        write_html(tmp_path / "view.html", view(shown(*arguments, **options), tmp_path / "model.toml", title))
        return opened(tmp_path / "view.html", width, color_scheme=scheme, bypass_csp=True)

    return play


def readout(page):
    """Time, ghost, simulated and their difference as the page tells them."""
    texts = page.locator(".moving .readout span").all_inner_texts()
    return [float(text.replace("−", "-").split(" (")[0].rsplit(" ", 2)[-2]) for text in texts]


def angle(page, part):
    return float(page.locator(f".stage .{part}").first.get_attribute("transform")[7:-1])


@pytest.mark.parametrize(("kind", "width", "scheme"), [(ROTARY, 1280, "light"), (LINEAR, 390, "dark")])
def test_a_page_opens_and_axe_finds_nothing(player, kind, width, scheme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="needs axe-playwright-python")
    page = player(kind, HOSTILE, width=width, scheme=scheme, title=HOSTILE)
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert "alert(1)" in page.locator("h1").inner_text()
    assert page.locator("img").count() == 0
    violations = axe.Axe().run(page).response["violations"]
    assert [(one["id"], [node["html"] for node in one["nodes"]][:3]) for one in violations] == []


def test_keys_step_leap_slow_and_return(player):
    page = player()
    page.locator(".stage").focus()
    for key, time in (("ArrowRight", 0.001), ("Shift+ArrowRight", 0.101), ("ArrowLeft", 0.1), ("0", 0.0)):
        page.keyboard.press(key)
        assert readout(page)[0] == pytest.approx(time, abs=1e-9)
    slowed = [page.locator("output.slowed").inner_text()]
    for key in "-+":
        page.keyboard.press(key)
        slowed.append(page.locator("output.slowed").inner_text())
    assert slowed == ["real time", "2 times slower", "real time"]


def test_a_disk_and_its_ghost_stand_where_the_signals_say(player):
    page = player()
    page.get_by_label("time", exact=True).fill("500")
    for one in page.locator(".time .readout").all_inner_texts():  # of the graphs
        (at,) = re.findall(r"at ([\d.]+) s", one)
        assert float(at) == pytest.approx(0.5, abs=2e-3)
    time, ghost, simulated, apart = readout(page)
    assert (time, ghost, apart) == pytest.approx((0.5, 1.5, AHEAD))
    assert simulated == pytest.approx(1.52)
    assert angle(page, "ghost") == pytest.approx(-np.degrees(1.5), abs=1e-3)  # counter-clockwise on the screen
    assert angle(page, "simulated") == pytest.approx(-np.degrees(1.52), abs=1e-3)
    page.get_by_label("10 times", exact=True).check()
    assert angle(page, "simulated") == pytest.approx(-np.degrees(1.7), abs=1e-3)
    assert angle(page, "ghost") == pytest.approx(-np.degrees(1.5), abs=1e-3)


def test_a_slide_stands_over_its_place_on_the_ruler(player):
    page = player(LINEAR)
    ticks = page.locator(".slide text:not(.label)").all()
    places = {float(one.text_content()): float(one.get_attribute("x")) for one in ticks}
    page.get_by_label("time", exact=True).fill("1000")  # the ghost is at 3 m
    (x,) = [float(page.locator(".stage .ghost").get_attribute("transform")[10:-1])]
    assert x == pytest.approx(np.interp(3.0, sorted(places), sorted(places.values())), abs=0.2)


def test_in_a_hole_nothing_is_drawn_or_stated(player):
    page = player(hole=(0.5, 0.8))
    page.get_by_label("time", exact=True).fill("650")
    assert page.locator(".stage .unknown").count() == 2
    assert "measured not known" in page.locator(".moving .readout").inner_text()
    page.get_by_label("time", exact=True).fill("100")
    assert page.locator(".stage .unknown").count() == 0


def test_it_plays_as_slow_as_it_says_and_halts_at_the_end(player):
    page = player()
    page.evaluate("""() => { // a clock of our own: how busy the machine is does not matter
        let now = 0; const waiting = [];
        performance.now = () => now;
        window.requestAnimationFrame = (then) => waiting.push(then);
        window.pass = (ms) => { now += ms; waiting.splice(0).forEach((then) => then(now)); };
    }""")
    page.get_by_role("button", name="play", exact=True).click()
    page.evaluate("pass(250)")
    assert readout(page)[0] == pytest.approx(0.25)
    page.locator(".stage").focus()
    page.keyboard.press("-")
    page.keyboard.press("-")
    page.evaluate("pass(500)")
    assert page.locator("output.slowed").inner_text() == "5 times slower"
    assert readout(page)[0] == pytest.approx(0.35)
    page.keyboard.press("Space")
    page.evaluate("pass(500)")
    assert readout(page)[0] == pytest.approx(0.35)
    page.keyboard.press("Space")
    page.evaluate("pass(60000)")
    assert readout(page)[0] == pytest.approx(2.0)
    assert page.get_by_role("button", name="play", exact=True).is_visible()
