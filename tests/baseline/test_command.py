"""`bench check` as a user has it: statuses, JUnit, annotations, and text from files that stays text."""

import contextlib
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.assets import asset
from bench.cli.common import WRITTEN
from bench.names import plain
from bench.report.continuous_integration import MOST, command, xml_text
from bench.trace.write import write
from tests.command import bench as run
from tests.diagnosis.command import RIG
from tests.fit.motions import Truth, recording
from tests.hostile import room_for

BASE = ("check", "--rig", "rig.toml", "--baseline", "base.toml")


AS_IT_WAS = Truth()


def again(seed, truth=AS_IT_WAS, cogging=0.0):
    """The same motion with other noise."""
    first = recording(np.random.default_rng(5), truth, position=True)
    rng, wave = np.random.default_rng(seed), cogging / 0.8 * np.sin(6.0 * first["position"])
    velocity = first["velocity"] + 0.02 * rng.normal(size=len(first))
    noisy = {"velocity": velocity, "current": first["current"] + 0.01 * rng.normal(size=len(first)) + wave}
    return replace(first, signals={**first.signals, **noisy})


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with a baseline, made of one recording without names."""
    folder = tmp_path_factory.mktemp("made")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
    with contextlib.chdir(folder):
        write(again(1), Path("before.csv"))
        assert run("check", "before.csv", *BASE[1:], "--update", "--without-names").status == 0
    return folder


@pytest.fixture
def axis(bench, made):
    """Runs `bench` in a copy of that folder."""
    shutil.copytree(made, Path.cwd(), dirs_exist_ok=True)
    return bench


#: An axis and its rig file, the status, and what is printed.
WORN = Truth(coulomb=0.069)
STATES = {
    "same": (AS_IT_WAS, str, 0, "The same"),
    "changed": (WORN, str, 3, "Changed: Coulomb friction torque rose from 0.0"),
    "another rig": (AS_IT_WAS, lambda rig: rig.replace("0.8 N", "0.9 N"), 1, "motor.torque_constant: 0.8 -> 0.9"),
    "a name and a margin": (
        Truth(coulomb=0.066),
        lambda rig: rig.replace('"axis"', '"x"') + '[check.margin]\ncoulomb_friction_torque = "20 %"\n',
        0,
        "The same",
    ),
}


@pytest.mark.parametrize("what", STATES)
def test_the_verdict_of_an_axis(axis, what):
    """What only the simulation and the check read is no other rig."""
    truth, changed, expected, words = STATES[what]
    Path("rig.toml").write_text(changed(Path("rig.toml").read_text()), encoding="utf-8")
    write(again(2, truth), Path("now.csv"))
    status, printed, _ = axis(*BASE, "now.csv")
    assert (status, words in printed) == (expected, True), printed


def test_an_update_on_a_full_disk_leaves_the_baseline_as_it_was(axis):
    before = Path("base.toml").read_bytes()
    write(again(2), Path("now.csv"))
    update = ("check", "now.csv", *BASE[1:], "--update", "--without-names")
    with room_for(len(before) // 2):
        status, _, text = axis(*update)
    assert (status, text.splitlines()[-1].split("; ")[0]) == (2, "bench: base.toml: cannot be written (File too large)")
    assert Path("base.toml").read_bytes() == before
    assert {path.name for path in Path.cwd().iterdir()} == {"base.toml", "before.csv", "now.csv", "rig.toml"}
    assert axis(*update)[0] == 0
    assert Path("base.toml").read_bytes() != before


def test_a_change_in_json_junit_and_a_page(axis):
    write(again(2, WORN), Path("now.csv"))
    status, printed, _ = axis(*BASE, "now.csv", "--json", "c.json", "--junit", "j.xml", "--report", "c.html")
    assert (status, "wrote c.html" in printed) == (3, True)
    page = Path("c.html").read_text(encoding="utf-8")
    assert ("Changed: " in page, "before.csv" in page) == (True, True)
    found = json.loads(Path("c.json").read_text(encoding="utf-8"))
    assert (found["schema"], found["result"], found["false_alarm_rate"]) == ("bench.check/1", "changed", 0.01)
    (friction,) = (one for one in found["quantities"] if one["name"] == "coulomb_friction_torque")
    assert friction["result"] == "changed"
    assert friction["difference95"][0] > friction["margin"] > 0.0
    assert {*found["provenance"], *found["provenance"]["baseline"]} >= {"version", "rig_sha256", "traces"}
    suite = ElementTree.parse("j.xml").getroot().find("testsuite")
    assert suite is not None
    assert (suite.get("tests"), suite.get("failures")) == (str(len(found["quantities"])), "1")
    assert suite.find("testcase[@name='coulomb_friction_torque']/failure") is not None


def test_a_new_effect_is_named(bench):
    write(again(1), Path("before.csv"))
    write(again(2, cogging=0.05), Path("now.csv"))
    assert bench("check", "before.csv", *BASE[1:], "--update")[0] == 0
    status, printed, _ = bench(*BASE, "now.csv", "--json", "c.json")
    found = json.loads(Path("c.json").read_text(encoding="utf-8"))
    assert (status, "Cogging torque (harmonic 6) appeared: amplitude 0.0" in printed) == (3, True)
    (effect,) = found["effects"]["appeared"]
    assert effect["parameters"]["amplitude"]["value"] == pytest.approx(0.05, rel=0.05)
    assert effect["evidence"]["torque"]["now"] > effect["evidence"]["torque"]["margin"]
    assert found["verdict"] == {"baseline": "nothing_missing", "now": "explained"}
    assert {one["name"] for one in found["quantities"] if one["result"] == "changed"} <= {"torque_gap"}
    assert bench("check", "now.csv", *BASE[1:], "--update")[0] == 0
    status, printed, _ = bench(*BASE, "before.csv")
    assert (status, "Cogging torque (harmonic 6) is gone" in printed) == (3, True)


WRONG = {
    "no baseline": (("check", "before.csv", "--rig", "rig.toml", "--baseline", "none.toml"), "--update"),
    "no recording": (BASE, "--simulated MODEL"),
    "no rig": (("check", "before.csv", "--baseline", "base.toml"), "--rig: missing"),
    "no model": (("check", "--simulated", "none.toml", "--baseline", "base.toml"), "found that of recordings"),
    "both": ((*BASE, "before.csv", "--simulated", "before.csv"), "found with recordings"),
    "names now": ((*BASE, "before.csv", "--without-names"), "when the baseline is made"),
    "a page of another ending": ((*BASE, "before.csv", "--report", "c.txt"), "allowed: .html"),
    "a page of an update": ((*BASE, "before.csv", "--update", "--report", "c.html"), "--report"),
    "an output that is the baseline": ((*BASE, "before.csv", "--junit", "base.toml"), "is an input"),
    "a baseline that is a recording": (
        ("check", "before.csv", "--rig", "rig.toml", "--baseline", "before.csv", "--update"),
        "is an input",
    ),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_one_line_and_status_2(what, axis):
    arguments, message = WRONG[what]
    before = Path("base.toml").read_bytes()
    status, _, error = axis(*arguments)
    assert (status, message in error, len(error.strip().splitlines())) == (2, True, 1), error
    assert Path("base.toml").read_bytes() == before


def test_github_gets_commands_of_its_own_alone(axis, monkeypatch):
    name = "now ::error::x ##[error]%0A<b>|`.csv"
    write(again(2, WORN), Path(name))
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", "summary.md")
    Path("summary.md").write_text("before\n", encoding="utf-8")
    status, printed, _ = axis(*BASE, name, "--format", "github")
    assert status == 3
    lines = printed.splitlines()
    stop = lines[0].removeprefix("::stop-commands::")
    outside = lines[lines.index(f"::{stop}::") + 1 :]
    assert len(stop) == 32
    assert 0 < len(outside) <= MOST
    assert all(line.startswith(("::error file=base.toml,line=", "::warning file=base.toml,line=")) for line in outside)
    assert "rose from" in outside[0]
    summary = Path("summary.md").read_text(encoding="utf-8")
    assert summary.startswith("before\n### bench check: ")
    assert "coulomb" in summary
    assert "<b>" not in summary


def test_a_workflow_command_is_escaped_as_github_does():
    line = command("error", "a\r\nb::c % \x1b", {"file": "a:b,c\n%.toml"})
    assert line == "::error file=a%3Ab%2Cc%0A%25.toml,title=bench check::a\\r%0Ab::c %25 \\x1b"


def test_gitlab_gets_a_code_quality_report(axis):
    write(again(2, WORN), Path("now.csv"))
    status, printed, _ = axis(*BASE, "now.csv", "--format", "gitlab")
    issues = json.loads(printed)
    assert status == 3
    assert issues[0]["severity"] == "major"
    assert {"description", "check_name", "fingerprint", "severity", "location"} <= issues[0].keys()
    line = issues[0]["location"]["lines"]["begin"]
    assert Path("base.toml").read_text().splitlines()[line - 1] == "[quantities.coulomb_friction_torque]"
    assert len({issue["fingerprint"] for issue in issues}) == len(issues)


def test_the_baseline_is_no_output_like_others():
    assert "baseline" not in WRITTEN  # it is read, and replaced where that is asked for


@pytest.fixture(scope="module")
def models(tmp_path_factory):
    """A folder with the models of two axes, of which one has cogging, and a baseline of the other."""
    folder = tmp_path_factory.mktemp("models")
    (folder / "rig.toml").write_text(RIG, encoding="utf-8")
    with contextlib.chdir(folder):
        for name, cogging in (("a", 0.0), ("b", 0.05)):
            write(again(1, cogging=cogging), Path(f"{name}.csv"))
            assert run("diagnose", f"{name}.csv", "--rig", "rig.toml", "--out", name).status == 0
        assert run("check", "--simulated", "a/model.toml", "--baseline", "m.toml", "--update").status == 0
    return folder


def test_no_other_file_is_replaced_by_a_baseline(models, monkeypatch):
    monkeypatch.chdir(models)
    before = Path("b/model.toml").read_bytes()
    status, _, error = run("check", "--simulated", "a/model.toml", "--baseline", "b/model.toml", "--update")
    assert (status, "b/model.toml: is no baseline, and would be lost" in error) == (2, True)
    assert Path("b/model.toml").read_bytes() == before


def test_models_are_held_against_each_other(models, monkeypatch):
    monkeypatch.chdir(models)

    def checked(model, baseline):
        status, printed, error = run("check", "--simulated", model, "--baseline", baseline)
        return status, printed + error

    assert checked("a/model.toml", "m.toml")[0] == checked("a/model.toml", "a/model.toml")[0] == 0
    status, printed = checked("b/model.toml", "m.toml")
    assert (status, "Cogging torque (harmonic 6) appeared" in printed) == (3, True)
    key = 'viscous_friction_coefficient = "'
    heavier = Path("a/model.toml").read_text(encoding="utf-8").replace(key, f"{key}1")
    Path("c.toml").write_text(heavier, encoding="utf-8")
    status, printed = checked("c.toml", "a/model.toml")
    assert (status, "c.toml" in printed) == (2, True)
    Path("c.toml").write_text(heavier.replace("same_parameters = true", "same_parameters = false"), encoding="utf-8")
    status, printed = checked("c.toml", "a/model.toml")
    assert (status, "Changed: Viscous friction coefficient rose" in printed) == (3, True)
    # a simulator that moves otherwise
    lines = Path("m.toml").read_text(encoding="utf-8").splitlines()
    at = lines.index("torque = [") + 5
    lines[at] = f"    {1.2 * float(lines[at].strip(' ,')) + 0.1!r},"
    Path("other.toml").write_text("\n".join(lines), encoding="utf-8")
    status, printed = checked("a/model.toml", "other.toml")
    assert (status, "response torque" in printed) == (3, True)


@given(st.text())
def test_any_text_comes_back_from_junit(said):
    """But for the two characters that XML has not, and such as are written out."""
    element = ElementTree.Element("failure", {"message": xml_text(said)})
    element.text = xml_text(said)
    again = ElementTree.fromstring(ElementTree.tostring(element, encoding="unicode").encode())
    expected = re.sub("[\ufffe\uffff]", "", plain(said))
    assert (again.text or "", again.get("message")) == (expected, expected)


@given(st.text(), st.text())
def test_any_text_comes_back_from_an_annotation(said, file):
    """Taken apart as a runner of GitHub's does."""
    line = command("error", said, {"file": file})
    assert "\n" not in line and "\r" not in line
    head, message = line.removeprefix("::error ").split("::", 1)
    properties = dict(one.split("=", 1) for one in head.split(","))
    unescaped = properties["file"].replace("%3A", ":").replace("%2C", ",")
    for coded, plainly in ((message, said), (unescaped, file)):
        assert coded.replace("%0D", "\r").replace("%0A", "\n").replace("%25", "%") == plain(plainly)


@pytest.mark.slow
def test_the_embedded_rig_is_what_it_was(bench):
    shutil.copy(asset("data", "rigs", "sh30701p.toml"), "lab.toml")
    baseline = asset("data", "baselines", "sh30701p.toml")
    bench("simulate", "lab.toml", "--out", "run.csv", "--profile", "speed_staircase", "--seed", "6")
    assert bench("check", "run.csv", "--rig", "lab.toml", "--baseline", baseline)[0] == 0
