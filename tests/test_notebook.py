"""What a person writes in a notebook, line by line: each works, or says of which argument it does not."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

import bench
from bench.assets import asset
from bench.baseline.observe import observe
from bench.baseline.state import write_baseline
from bench.trace.write import write
from tests.fit.motions import recording

mpl.use("agg")

RIG = 'name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\nrotor_inertia = "2 kg*cm**2"\n'
AMPLITUDE, HARMONIC = 0.05, 6


def with_cogging(seed):
    trace = recording(np.random.default_rng(seed), duration=3.0, position=True)
    torque = AMPLITUDE * np.sin(HARMONIC * trace["position"])
    return replace(trace, signals={**trace.signals, "current": trace["current"] + torque / 0.8})


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    """The folder and the names that the lines find."""
    folder = tmp_path_factory.mktemp("notebook")
    (folder / "rig.toml").write_text(RIG)
    shutil.copy(asset("data", "rigs", "sh30701p.toml"), folder / "lab.toml")
    for number in (1, 2):
        write(with_cogging(number), folder / f"run{number}.csv")
    rig, lab = bench.load_rig(folder / "rig.toml"), bench.load_rig(folder / "lab.toml")
    trace = bench.read(folder / "run1.csv")
    write_baseline(folder / "axis.toml", observe(trace, rig, names=False).state)
    simulated = bench.simulate(lab, "fast_reversals")
    arrays = {"time [s]": trace.time} | {f"{name} [{unit}]": trace[name] for name, unit in trace.units.items()}
    found = bench.diagnose(trace, rig)
    known = {"bench": bench, "np": np, "pd": pd, "pytest": pytest, "json": json, "Path": Path, "re": re}
    known |= {"rig": rig, "lab": lab, "trace": trace, "simulated": simulated, "arrays": arrays, "found": found}
    return folder, known | {"estimate": bench.identify(trace, rig), "bare": bench.identify(with_cogging(1), rig)}


LINES = """
bench.identify("run1.csv", "rig.toml")["moment_of_inertia"].value == pytest.approx(1.5e-3, rel=0.02)
bench.identify(Path("run1.csv"), rig).parameters == estimate.parameters
bench.identify(["run1.csv", "run2.csv"], "rig.toml").recordings[1].origin == "run2.csv"
bench.identify(arrays, rig)["moment_of_inertia"].value == pytest.approx(float(estimate["moment_of_inertia"]))
float(bench.identify(pd.DataFrame(arrays), rig)["moment_of_inertia"]) == float(estimate["moment_of_inertia"])
bench.load_rig("emps").kind == "linear"
float(estimate["moment_of_inertia"]) == estimate["moment_of_inertia"].value
np.array([float(estimate[name]) for name in estimate]).shape == (len(estimate),)
f"{estimate['moment_of_inertia']:.3g}" == f"{estimate['moment_of_inertia'].value:.3g}"
re.fullmatch(r"0.0015\\d* ± \\S+ kg\\*m\\*\\*2", f"{estimate['moment_of_inertia']}")
str(estimate["coulomb_friction_torque"]).endswith("N*m")
"moment_of_inertia" in estimate and "mass" not in estimate
[*estimate][0] == "moment_of_inertia"
dict(estimate)["moment_of_inertia"] is estimate["moment_of_inertia"]
"did you mean 'moment_of_inertia'" in str(pytest.raises(KeyError, estimate.__getitem__, "moment_of_inertai").value)
len(repr(estimate).splitlines()) <= 25 and "moment of inertia" in repr(estimate)
estimate._repr_html_().startswith("<div><p><strong>The moment of inertia is ") and "<table>" in estimate._repr_html_()
estimate.plot().get_xlabel() == "time / s"
[line.get_label() for line in estimate.plot().lines] == ["measured", "modelled"]
estimate.to_dict()["schema"] == "bench.identify/1" and json.dumps(estimate.to_dict())
estimate.to_frame().set_index("quantity").loc["moment_of_inertia", "value"] == float(estimate["moment_of_inertia"])
estimate.save("estimate.json") is None and json.loads(Path("estimate.json").read_text()) == estimate.to_dict()
bench.Estimate.load("estimate.json") == estimate
repr(bench.Estimate.load("estimate.json")) == repr(estimate)
bench.diagnose("run1.csv", "rig.toml", holdout="run2.csv").torque.holdout[1] < 0.5 * found.torque.identify[0]
"cogging_torque" not in bench.diagnose(trace, rig, excluded="cogging_torque")
"cogging_torque" in found and "backlash" not in found
[effect.name for effect in found] == ["cogging_torque"]
float(found["cogging_torque"]["amplitude"]) == pytest.approx(0.05, rel=0.05)
len(repr(found).splitlines()) <= 25 and "ogging torque" in repr(found)
"data:image/png;base64," in found._repr_html_() and "<strong>" in found._repr_html_()
"position" in found.plot().get_xlabel()
found.to_dict()["verdict"] == found.verdict
set(found.to_frame()["of"]) == {"axis", "cogging_torque"}
found.save("kept") is None and {p.name for p in Path("kept").iterdir()} >= {"report.html", "model.toml", "model.xml"}
bench.Diagnosis.load("kept").to_dict() == found.to_dict()
repr(bench.Diagnosis.load("kept")) == repr(found) and len(bench.Diagnosis.load("kept").plot().lines) > 0
found.mjspec.compile().njnt == 1
bench.replay(found, "run2.csv", "rig.toml").summary == bench.replay("kept/model.toml", "run2.csv", rig).summary
len(repr(bench.replay(found, trace, rig))) < 300
[*bench.Effects(found, "elbow").models] == ["elbow"]
bench.simulate(lab, simulated.trace).trace["velocity"].max() == pytest.approx(154.0, rel=0.02)
bench.simulate("lab.toml", 20 * np.sin(np.linspace(0, 6.28, 1000))).trace["velocity"].max() == pytest.approx(20, 0.02)
bench.simulate(lab, "fast_reversals", effects="unbalance:amplitude=0.1").truth.effects[0].name == "unbalance"
len(repr(simulated)) < 400 and len(repr(trace)) < 300
bench.check("run2.csv", "rig.toml", "axis.toml").result in ("same", "changed", "undecided")
len(repr(bench.check("run1.csv", rig, "axis.toml")).splitlines()) <= 25
bench.Rig(name="x", kind="linear", motor={"force_constant": "2 N/A"}).motor.force_constant == 2.0
""".strip().splitlines()

#: What is refused, and what is said of which argument.
REFUSED = {
    'bench.simulate(lab, "fast_reversal")': r"profile: found 'fast_reversal', did you mean 'fast_reversals'",
    "bench.simulate(lab, np.zeros((3, 2)))": r"profile: found an array of shape \(3, 2\)",
    'bench.simulate(lab, effects="unbalanc:amplitude=1")': r"effect unbalanc.*did you mean 'unbalance'",
    'bench.diagnose(trace, rig, excluded=["coging_torque"])': r"excluded.*did you mean 'cogging_torque'",
    "bench.diagnose(trace, rig, holdout=trace)": r"^holdout: found the recording itself",
    'bench.Rig(name="x", kind="rotary", motor={"torque_constant": "2 kg"})': r"motor.torque_constant: ",
    'bench.Rig(name="x", kind="rotary", motr={})': r"motr: unknown key, did you mean 'motor'",
    "bench.identify(5, rig)": r"found int; allowed: arrays by their names, or a data frame",
    "bench.identify(trace, 5)": r"rig: found 5; allowed: a Rig, a rig file",
    'bench.load_rig("emp")': r"no shipped rig, did you mean 'emps'",
    'bench.Diagnosis.load("estimate")': r"estimate/diagnosis.npz: no such file",
    'bench.Estimate.load("estimate.json").plot()': r"plot\(\), residuals: found an estimate without its recording",
    'bench.Estimate.load("kept/diagnosis.json")': r"kept/diagnosis.json: contains no estimate",
}


def test_every_line_of_a_notebook_works(names, monkeypatch):
    folder, known = names
    monkeypatch.chdir(folder)
    for line in LINES:
        assert eval(line, dict(known)), line
    for line, says in REFUSED.items():
        with pytest.raises(bench.InputError, match=says) as refused:
            eval(line, dict(known))
        assert "--" not in str(refused.value), line
        assert "\n" not in str(refused.value), line
    mpl.pyplot.close("all")


def test_the_lines_are_at_least_those_that_were_asked_for():
    assert len(LINES) + len(REFUSED) >= 42
