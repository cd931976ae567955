"""Calls as somebody writes them who knows pandas and scikit-learn and has not read the manual.

Each gives the right number, or one line that names the argument, what was found and what is allowed.
"""

import inspect
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot

import bench
from bench.assets import asset
from bench.baseline.observe import observe
from bench.baseline.state import write_baseline
from bench.friction_map import friction_map
from bench.trace.write import write
from tests.command import bench as command
from tests.fit.motions import Truth, recording

INERTIA, COULOMB, AMPLITUDE, HARMONIC, K_T = Truth.inertia, Truth.coulomb, 0.05, 6, 0.8
TABLES = {"motor": {"torque_constant": "0.8 N*m/A", "rotor_inertia": "2 kg*cm**2"}}
NUMBERS = {"motor": {"torque_constant": 0.8, "rotor_inertia": 2e-4}}
RIG = 'name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\nrotor_inertia = "2 kg*cm**2"\n'


def of_axis(seed, cogging=0.0):
    trace = recording(np.random.default_rng(seed), duration=3.0, position=True)
    torque = cogging * np.sin(HARMONIC * trace["position"])
    return replace(trace, signals={**trace.signals, "current": trace["current"] + torque / K_T})


def steady(speed):
    """The axis at one speed."""
    rng, time = np.random.default_rng(int(10 * abs(speed))), 1e-3 * np.arange(2000)
    torque = Truth.viscous * speed + COULOMB * np.sign(speed) + 0.004 * rng.normal(size=time.size)
    return {"time": time, "velocity": speed + 0.01 * rng.normal(size=time.size), "torque": torque}


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    folder = tmp_path_factory.mktemp("calls")
    (folder / "rig.toml").write_text(RIG)
    shutil.copy(asset("data", "rigs", "sh30701p.toml"), folder / "lab.toml")
    plain, bumpy = of_axis(1), of_axis(2, AMPLITUDE)
    si = {"time": plain.time, **{name: np.array(plain[name]) for name in plain.units}}
    df = pd.DataFrame(si)
    df.to_csv(folder / "bare.csv", index=False)
    df.add_suffix("_of_axis").to_csv(folder / "named.csv", index=False)
    cogged = pd.DataFrame({"time": bumpy.time, **{name: np.array(bumpy[name]) for name in bumpy.units}})
    write(bumpy, folder / "cogged.csv")
    rpm = df.assign(velocity=df.velocity * 30 / np.pi, current=1e3 * df.current).drop(columns="position")
    si_units = {"time": "s", "velocity": "rad/s", "current": "A", "position": "rad"}
    mm = {name: 0.1 * si[name] for name in ("position", "velocity")}
    mm |= {"time": plain.time, "force": 8 * si["current"]}
    write(of_axis(3, AMPLITUDE), folder / "cogged2.csv")
    write_baseline(folder / "axis.toml", observe(plain, bench.load_rig(folder / "rig.toml"), names=False).state)
    known = {
        "bench": bench, "np": np, "pd": pd, "Path": Path, "df": df, "si": si, "rpm": rpm, "cogged": cogged, "mm": mm,
        "tables": TABLES, "numbers": NUMBERS, "si_units": si_units, "friction_map": friction_map, "steady": steady,
        "rpm_units": {"time": "s", "velocity": "rpm", "current": "mA"}, "rig": bench.load_rig(folder / "rig.toml"),
        "structured": df.to_records(index=False), "indexed": df.set_index("time"), "plain": plain,
        "unnamed": pd.DataFrame({k: v for k, v in si.items() if k != "time"}, index=si["time"]),
        "moments": df.assign(time=pd.Timestamp("2026-03-01") + pd.to_timedelta(df.time, "s")),
        "inertia": lambda found: float(found["moment_of_inertia"]), "K_T": K_T,
        "kept": lambda replayed: np.nanstd(replayed.torque_simulated) / np.nanstd(replayed.torque),
        "speeds": [sign * speed for sign in (-1, 1) for speed in (4, 8, 15, 20, 30, 40, 50, 60)],
        "added": lambda simulated: simulated.truth.effects[0].values[0][1],
    }  # fmt: skip
    with pytest.MonkeyPatch.context() as here:
        here.chdir(folder)
        done = command("diagnose", "cogged.csv", "--rig", "rig.toml", "--out", "out")
        assert (done.status, "wrote out/diagnosis.npz" in done.out) == (0, True), done.err
        assert command("identify", "cogged.csv", "--rig", "rig.toml", "--out", "estimated").status == 0
    known["found"] = bench.Diagnosis.load(folder / "out")
    known["est"], known["trace"] = bench.identify(df, TABLES), plain
    known["rep"] = bench.replay(known["found"], cogged, TABLES)
    known["chk"] = bench.check(df, NUMBERS, folder / "axis.toml")
    known["sim"] = bench.simulate(folder / "lab.toml", "fast_reversals")
    known["ax"] = pyplot.figure().subplots()
    return folder, known


#: Calls, and the true value that each gives within 3 %, or what it is equal to.
RIGHT = {
    "inertia(bench.identify(df, tables))": INERTIA,
    "inertia(bench.identify(df, rig=numbers))": INERTIA,
    'inertia(bench.identify(si, rig="rig.toml"))': INERTIA,
    'inertia(bench.identify("bare.csv", rig="rig.toml"))': INERTIA,
    'inertia(bench.identify(Path("bare.csv"), Path("rig.toml")))': INERTIA,
    'inertia(bench.identify("bare.csv", tables, units=si_units))': INERTIA,
    "inertia(bench.identify(df, tables, units=si_units))": INERTIA,
    "inertia(bench.identify(rpm, tables, units=rpm_units))": INERTIA,
    "inertia(bench.identify([df, df.iloc[:2500]], tables, units=si_units))": INERTIA,
    "inertia(bench.identify(df))": INERTIA / K_T,
    'inertia(bench.identify("cogged.csv"))': INERTIA / K_T,
    "inertia(bench.identify(plain))": INERTIA / K_T,
    "inertia(bench.identify(structured, tables))": INERTIA,
    "inertia(bench.identify(indexed, tables))": INERTIA,
    "inertia(bench.identify(unnamed, tables))": INERTIA,
    "inertia(bench.identify(moments, tables))": INERTIA,
    "inertia(bench.identify(df.iloc[5:], tables))": INERTIA,
    'inertia(bench.identify(df, tables, cutoff="50 Hz"))': INERTIA,
    "inertia(bench.identify(df, tables, cutoff=50))": INERTIA,
    'inertia(bench.identify(df.drop(columns="time"), {**tables, "trace": {"sample_period": "1 ms"}}))': INERTIA,
    'inertia(bench.identify(df.drop(columns="time"), {**numbers, "trace": {"sample_period": 1e-3}}))': INERTIA,
    "inertia(bench.identify(df.rename(columns=str.title), tables))": INERTIA,
    'float(bench.identify(mm)["moving_mass"])': 100 * INERTIA,
    'float(bench.identify(mm, {"kind": "linear"})["moving_mass"])': 100 * INERTIA,
    'float(bench.identify(mm, {"motor": {"moving_mass": 0.01}})["moving_mass"])': 100 * INERTIA,
    'bench.read("bare.csv", units=si_units)["velocity"].max() / df.velocity.max()': 1.0,
    'bench.Trace.from_arrays(df)["velocity"].max() / df.velocity.max()': 1.0,
    'bench.Trace.from_arrays(rpm, units=rpm_units)["velocity"].max() / df.velocity.max()': 1.0,
    'float(bench.diagnose(cogged, tables, units=si_units)["cogging_torque"]["amplitude"])': AMPLITUDE,
    'float(found["cogging_torque"]["amplitude"])': AMPLITUDE,
    'float(bench.Diagnosis.load("out/diagnosis.json")["cogging_torque"]["amplitude"])': AMPLITUDE,
    'inertia(bench.Estimate.load("estimated"))': INERTIA,
    "kept(bench.replay(found, cogged, tables))": 1.0,
    'kept(bench.replay("out", "cogged.csv", numbers))': 1.0,
    "kept(bench.replay(found, cogged, tables, units=si_units))": 1.0,
    'bench.check(df, tables, "axis.toml", units=si_units).result': "same",
    'bench.check("bare.csv", rig=numbers, baseline="axis.toml").result': "same",
    'added(bench.simulate("lab.toml", "fast_reversals", effects={"unbalance": {"amplitude": 0.1}}))': 0.1,
    'added(bench.simulate("lab.toml", "fast_reversals", effects={"unbalance": {"amplitude": "100 mN*m"}}))': 0.1,
    'added(bench.simulate("lab.toml", "fast_reversals", effects={"unbalance": {"amplitude": np.float32(0.1)}}))': 0.1,
    'friction_map([steady(w) for w in speeds], {"kind": "rotary"}).plain.theta[1]': COULOMB,
}


@pytest.mark.parametrize("call", RIGHT)
def test_a_natural_call_gives_the_right_number(names, monkeypatch, call):
    folder, known = names
    monkeypatch.chdir(folder)
    found = eval(call, dict(known))
    assert found == (RIGHT[call] if isinstance(RIGHT[call], str) else pytest.approx(RIGHT[call], rel=0.03))


#: What a person does with a result who knows pandas, scikit-learn and matplotlib, and what of it is true.
OF_RESULTS = """
est["inertia"] == est["J"] == est.inertia == est.moment_of_inertia == est["moment_of_inertia"]
float(est.K_w) == est["viscous_friction"].value
2 * est.inertia == est.inertia * 2 == est.inertia + est.inertia
est.inertia / 2e-4 == float(est.inertia) / 2e-4
1e4 * est.inertia > 1 > est.inertia > 0
-est["coulomb_friction"] < 0 < est["coulomb_friction"] ** 2
np.isclose(est.inertia, INERTIA, rtol=0.03)
np.sqrt(est.inertia) == np.sqrt(est.inertia.value)
abs(est.inertia) == est.inertia.value == round(est.inertia, 12) or abs(round(est.inertia, 6) - 1.5e-3) < 1e-6
np.array([*est.values()]).dtype == float
dict(est.items()) == dict(est)
est.get("no_such") is None and est.get("inertia") is est.inertia
"inertia" in est and "mass" not in est
pd.Series(est).astype(float)["moment_of_inertia"] == est.inertia.value
json.loads(est.to_json()) == est.to_dict()
est.plot(ax=ax) is ax and est.plot(figsize=(6, 4)).figure.get_size_inches().tolist() == [6.0, 4.0]
abs(est.residuals.std() / est.residual.rms - 1) < 0.1
trace.velocity is trace["velocity"] and [*trace] == [*trace.keys()] == ["velocity", "current", "position"]
len(trace.plot()) == 3 and trace.plot("velocity", ax=ax) is ax
trace.to_frame().velocity.mean() == trace["velocity"].mean()
len(trace[100:2000]) == 1900 and trace[100:2000].time[0] == trace.time[100]
(round(trace.sample_rate), round(trace.duration, 3)) == (1000, 2.999)
trace.save("t.csv") is None and len(bench.read("t.csv")) == len(trace)
found.names == ["cogging_torque"] and len(found) == 1 and bool(found)
float(found.cogging_torque.amplitude) == float(found["cogging_torque"]["amplitude"])
found.probabilities["cogging_torque"] > 0.9
found.residuals.std() < 0.3 * found.torque.identify[0]
found.plot(ax=ax) is ax and found.plot(figsize=(8, 3)) is not ax
len(rep.plot()) == 2 and rep.plot("torque", ax=ax) is ax
len(rep.to_frame()) == len(rep.time) == rep.torque_residuals.size == rep.velocity_residuals.size
chk.plot().get_xlabel() and set(chk.to_frame().result) == {"same"}
sim["velocity"] is sim.velocity is sim.trace["velocity"] and len(sim.plot()) == len([*sim.trace])
bench.identify(sim, "lab.toml").inertia > 0 and len(sim.to_frame()) == len(sim.trace)
set(dir(bench)) == set(bench.__all__)
est.inertia.ci == est.inertia.ci95 and est.inertia.stderr == est.inertia.std == est.inertia.std_error
est.params == est.parameters and est.r2 == est.explained and est.to_dataframe().equals(est.to_frame())
str(est) == est.summary() and est.to_html("e.html") == Path("e.html").read_text()
est.to_csv("e.csv") is None and pd.read_csv("e.csv").value[0] == est.inertia.value
trace.fs == trace.sampling_rate == trace.sample_rate and trace.dt == trace.sample_period and trace.t is trace.time
trace.columns == [*trace] and trace.to_csv("u.csv") is None and len(bench.read_csv("u.csv")) == len(trace)
found.probability is found.probabilities and found.residual is found.residuals and found.summary() == repr(found)
found.save("f.csv") is None and {"axis", "cogging_torque"} == set(pd.read_csv("f.csv")["of"])
rep["velocity"] is rep.velocity and rig["motor"]["torque_constant"] == rig.motor.torque_constant == K_T
bench.version == bench.__version__
est.fitted_values.size == est.residuals.size and np.isclose(np.var(est.fitted_values), np.var(0.8 * df.current), 0.2)
np.nanstd(est.predict(cogged) - 0.8 * bench.Trace.from_arrays(cogged)["current"]) < 1.5 * AMPLITUDE
est.score == est.r2 == est.rsquared and np.allclose(np.diag(est.corr)[:3], 1)
np.allclose(np.sqrt(np.diag(est.cov))[:3], [est[name].std_error for name in list(est)[:3]])
len(trace.head()) == 5 and trace.describe().loc["max", "velocity"] == trace["velocity"].max() and len(est.tail(2)) == 2
abs(trace[::5].sample_rate - 200) < 0.1 and len(trace.resample(200)) == len(trace[::5])
np.allclose(trace.resample(200)["velocity"], trace[::5]["velocity"])
found.effects["cogging_torque"] is found.effects[0] is found["cogging_torque"] and found.effects[:1] == [*found]
float(found["inertia"]) == float(found.moment_of_inertia) == found.parameters["moment_of_inertia"].value
found.gap["torque"] is found.torque and found.report() == found.summary()
found.considered["cogging_torque"].accepted and found.considered["backlash"].probability < 0.01
found.steps["cogging_torque"] is found.steps[1] and found.time_series["recording"] is found.time_series[0]
est.parameters["inertia"] is est.inertia and chk.comparisons["inertia"].result == "same"
found.where["position"].after is found.where[[one.coordinate for one in found.where].index("position")].after
trace.plot(["velocity", "current"]).size == 2 and found.gap["torque"].identify == found.torque.identify
found.plot("where").size >= 3 and "position" in found.plot("position").get_xlabel()
rep.residual.size == rep.time.size and np.isclose(rep.rmse["torque"], np.sqrt(np.nanmean(rep.residuals**2)))
bench.Rig(**rig.to_dict()).motor == rig.motor and bench.Rig(motor={"force_constant": 2.0}).kind == "linear"
"cogging_torque" in bench.list_effects() and len(bench.load("bare.csv")) == len(df)
bench.diagnose(cogged, tables, effects=["quadratic_drag"]).names == []
bench.simulate("lab.toml", "fast_reversals", duration=2.0).trace.duration == 2.0
bench.Trace.from_dataframe(df)["velocity"].max() == bench.Trace.from_dict(si)["velocity"].max() == df.velocity.max()
bench.Rig.from_dict({"name": "x", "kind": "rotary", **tables}).motor == rig.motor
est.coef_ == est.parameters and np.array_equal(est.resid, est.residuals)
json.loads(Path("e.json").read_text()) == est.to_dict() if est.to_json("e.json") else False
bench.identify(["cogged.csv", "cogged2.csv"], "rig.toml").recordings[1].origin == "cogged2.csv"
bench.load_rig("emps").kind == "linear" and [*est][0] == "moment_of_inertia"
f"{est.inertia:.3g}" == f"{est.inertia.value:.3g}" and re.fullmatch(r"0.001[45]\\d* ± \\S+ kg.m..2", f"{est.inertia}")
all(len(repr(one).splitlines()) <= 25 for one in (est, found, chk)) and "moment of inertia" in repr(est)
max(len(repr(rep)), len(repr(trace)), len(repr(sim)) - 100) < 300
est._repr_html_().startswith("<div><p><strong>The moment of inertia is ") and "<table>" in est._repr_html_()
[line.get_label() for line in est.plot().lines] == ["measured", "modelled"] and est.plot().get_xlabel() == "time / s"
est.to_dict()["schema"] == "bench.identify/1" and found.to_dict()["verdict"] == found.verdict
est.to_frame().set_index("quantity").loc["moment_of_inertia", "value"] == float(est.inertia)
est.save("s.json") is None and json.loads(Path("s.json").read_text()) == est.to_dict()
est.save("l.json") is None and bench.Estimate.load("l.json") == est and repr(bench.Estimate.load("l.json")) == repr(est)
"backlash" not in found and "data:image/png;base64," in found._repr_html_() and "<strong>" in found._repr_html_()
found.save("k") is None and {p.name for p in Path("k").iterdir()} >= {"report.html", "model.toml", "model.xml"}
repr(bench.Diagnosis.load("out")) == repr(found) and bench.Diagnosis.load("out").to_dict() == found.to_dict()
found.mjspec.compile().njnt == 1 and [*bench.Effects(found, "elbow").models] == ["elbow"]
rep.summary == bench.replay("out/model.toml", "cogged.csv", rig).summary
bench.simulate("lab.toml", sim.trace).trace["velocity"].max() == pytest.approx(154.0, rel=0.02)
bench.simulate("lab.toml", 20 * np.sin(np.linspace(0, 6.28, 1000))).trace["velocity"].max() == pytest.approx(20, 0.02)
bench.simulate("lab.toml", "fast_reversals", effects="unbalance:amplitude=0.1").truth.effects[0].name == "unbalance"
"cogging_torque" not in bench.diagnose(cogged, tables, excluded="cogging_torque")
bench.diagnose(cogged, numbers, holdout="cogged2.csv").torque.holdout[1] < 0.5 * found.torque.identify[0]
"lambda" not in help_of(bench.diagnose) and "chance=" not in help_of(bench.diagnose)
""".strip().splitlines()


@pytest.mark.parametrize("line", OF_RESULTS)
def test_results_behave_as_numbers_tables_and_pictures(names, monkeypatch, line):
    folder, known = names
    monkeypatch.chdir(folder)
    more = {"INERTIA": INERTIA, "AMPLITUDE": AMPLITUDE, "json": json, "pytest": pytest, "re": re}
    assert eval(line, {**known, **more, "help_of": lambda of: str(inspect.signature(of))})
    pyplot.close("all")


#: What a result does not have, and what the one line proposes.
ABSENT = {
    "est.covarianc": r"Estimate has no 'covarianc', did you mean 'covariance'\?; allowed: between, ",
    "rig.to_list()": r"Rig has no 'to_list', did you mean 'to_dict'\?; allowed: assumed, axis_kind, check, .*motor",
    "rep['speed']": r"speed: found none.*allowed: time, position",
    "est.inertia.half_widht": r"Parameter has no 'half_widht', did you mean 'half_width'",
    "trace.sample_rat": r"Trace has no 'sample_rat', did you mean 'sample_rate'",
    "found['moment_of_inerta']": r"found none, did you mean 'moment_of_inertia'\?; allowed: .*cogging_torque",
    "found.effects['friction']": r"friction: found none.*; allowed: cogging_torque",
    "bench.load_rigs": r"bench has no 'load_rigs', did you mean 'load_rig'",
    "trace.plot('speed')": r"plot\(\) of Trace: found 'speed'; allowed: velocity, current, position",
    "found.plot('speed')": r"plot\(\) of Diagnosis: found 'speed'; allowed: gap, position, .*velocity",
    "found.replay(trace)": r"Diagnosis has no 'replay'; instead: bench\.replay\(found, recording, rig\); allowed",
    "rep.error": r"Replay has no 'error'; instead: \.velocity_residuals and \.torque_residuals; allowed",
    "bench.plot(est)": r"bench has no 'plot'; instead: \.plot\(\) of a trace or a result; allowed",
    "bench.identify(trace, kt=0.8)": r"no argument 'kt'; instead: rig=.*torque_constant.*; allowed: trace, rig",
    "bench.diagnose(trace, rig, exclude=[])": r"no argument 'exclude', did you mean 'excluded'\?; allowed: trace, rig",
    "bench.simulate('lab.toml', duration=1e9)": r"duration: found 1e\+09 s; allowed: 0\.00025 s to ",
    "trace.resample(0)": r"resample\(rate\): found 0 Hz; allowed: above 0 Hz",
    "bench.Estimate.load('estimated').covariance": r"correlation: found an estimate from a file; allowed",
    "bench.Rig.load('rig.toml')": r"^Rig has no 'load'; instead: .*bench\.load_rig\(path\) of a rig; allowed: of$",
    "bench.Trace.from_csv('bare.csv')": r"^Trace has no 'from_csv'; instead: bench\.read\(path\); allowed: from_arrays",
    "bench.Estimate.from_file('estimated')": r"^Estimate has no 'from_file'; allowed: load",
    "bench.effects()": r"bench\.effects is a package; instead: bench\.list_effects\(\)",
    "est.effects": r"instead: bench\.list_effects\(\) of the catalogue, bench\.diagnose",
    "est.conf_int()": r"Estimate has no 'conf_int'; instead: \.to_frame\(\) has low and high",
    "est.plot(ax=ax, color='red')": r"plot\(\) has no argument 'color'; instead: the axes.*; allowed: names, ax",
    "trace.plot(x='time', y='velocity')": r"plot\(\) has no argument 'x'; instead: plot\(\"velocity\"\)",
    "trace.loc[0.5:1.0]": r"Trace has no 'loc'; instead: \.between\(start, stop\)",
    "trace.iloc[:100]": r"Trace has no 'iloc'; instead: \[first:last\]",
    "rig.to_toml('r.toml')": r"Rig has no 'to_toml'; instead: \.to_dict\(\)",
    "bench.plot_forest([est, est])": r"instead: bench\.check\(recording, rig, baseline\)\.plot\(\)",
    "found.report('x')": r"^summary\(\): too many positional arguments; allowed: no argument$",
    "found.report(format='html')": r"^summary\(\) has no argument 'format'; allowed: no argument$",
    "found.plot(kind='bar')": r"^plot\(\) has no argument 'kind'; allowed: names, ax, figsize",
    "est.plot(ax=3)": r"^plot\(\): ax: found 3; allowed: axes of matplotlib",
    "est.plot(figsize=3)": r"^plot\(\): figsize: found 3; allowed: width and height in inch.* or None",
    "est[0]": r"found 0; allowed: one of moment_of_inertia",
    "est[['inertia', 'J']]": r"found \['inertia', 'J'\]; allowed: one of moment_of_inertia",
    "est.parameters['mas']": r"mas: found none; allowed: moment_of_inertia",
    "found.parameters['x']": r"x: found none; allowed: moment_of_inertia",
    "found.considered['x']": r"x: found none; allowed: cogging_torque, ",
    "found.gap['speed']": r"speed: found none; allowed: torque, velocity",
    "est.inertia > '1'": r"^greater of a parameter: found '1'; allowed: numbers and arrays in kg\*m\*\*2",
    "est.inertia + None": r"^add of a parameter: found None; allowed: numbers",
    "est.save()": r"^save\(\): missing a required argument: 'path'; allowed: path",
    "est.save(3)": r"^save\(\): path: found 3; allowed: a text or a path",
    "est.to_json(indent=2)": r"^to_json\(\) has no argument 'indent'; allowed: path",
    "est.to_dict(orient='records')": r"^to_dict\(\) has no argument 'orient'",
    "est.predict()": r"^predict\(\): missing a required argument: 'recording'",
    "chk['mass']": r"mass: found none; allowed: ",
    "rep.rmse['speed']": r"speed: found none; allowed: torque, velocity",
    "trace[['velocity', 'current']]": r"found \['velocity', 'current'\]; allowed: one of velocity, current, pos",
    "trace[0.5:1.0]": r"found \[0\.5:1\.0\]; allowed: whole numbers.*\.between\(start, stop\)",
    "trace.resample('10ms')": r"^resample\(\): rate: found '10ms'; allowed: a number",
    "trace.between(0)": r"^between\(\): missing a required argument: 'stop'; allowed: start, stop",
    "bench.Trace(3)": r"^Trace\(\): missing a required argument: 'signals'; allowed: time, signals, ",
    "bench.identify()": r"^identify\(\): missing a required argument: 'trace'; allowed: trace, rig",
    "bench.load_rig(3)": r"^load_rig\(\): path: found 3; allowed: a text or a path",
    "bench.Estimate.load(3)": r"^load\(\): path: found 3; allowed: a text or a path",
    "bench.simulate('lab.toml', seed='x')": r"^simulate\(\): seed: found 'x'; allowed: a whole number",
    "bench.diagnose(trace, rig, excluded=3)": r"^diagnose\(\): excluded: found 3; allowed: .*several in a list",
    "bench.list_effects('x')": r"^list_effects\(\): too many positional arguments; allowed: no argument",
    "bench.list_effects()['backlas']": r"found none, did you mean 'backlash'\?; allowed: ",
    "bench.load('rig.toml')": r"rig\.toml: found a TOML file; allowed: a recording; .* bench\.load_rig take a rig",
}


#: Calls, and what the one line says.
REFUSED = {
    "bench.identify(df, {'motor': {'torque_constant': '0.8 kg'}})": r"rig: motor\.torque_constant: found .*N\*m/A",
    "bench.identify(df, {'motor': {'torque_constnt': 0.8}})": r"motor\.torque_constnt: unknown key, did you mean",
    "bench.identify(df, {'motor': 0.8})": r"^rig: motor: found 0\.8; allowed",
    "bench.identify(df, {'torque_constant': 0.8})": r"^rig: torque_constant: unknown key",
    "bench.identify(df, 0.8)": r"^rig: found 0\.8; allowed: a Rig, a rig file, .*torque_constant",
    "bench.identify(si['time'], si['velocity'], si['current'])": r"^rig: found ndarray; .*go into the first argument",
    "bench.identify(df, tables, units={'speed': 'rpm'})": r"unit of speed: no such column; found: time, velocity",
    "bench.identify(rpm, tables, units={**rpm_units, 'velocity': 'A'})": r"velocity.*found unit 'A'; allowed: .*rad/s",
    "bench.identify(df, tables, units={'velocity': 'rad/s'})": r'allowed: .*units=\{"\w+": "\w+"\}',
    "bench.identify(plain, tables, units=si_units)": r"^units: found with a Trace",
    "bench.identify(df.to_numpy(), tables)": r"found ndarray; allowed: arrays by their names, or a data frame",
    "bench.identify(None, tables)": r"found NoneType; allowed: arrays by their names, or a data frame",
    "bench.identify(df.drop(columns='time'), tables)": r"column 'time': not in the file.*sample_period",
    "bench.identify(df, tables, cutoff='50 rad')": r"^cutoff: found '50 rad'; allowed: .*Hz",
    "bench.identify(df, tables, cutoff='fast')": r"^cutoff: found 'fast'; allowed: .*Hz",
    "bench.replay(found.model, cogged, tables)": r"^model: found StoredModel.*replay\(found",
    "bench.replay('nowhere', cogged, tables)": r"nowhere: no such file",
    "bench.simulate('lab.toml', effects={'unbalance': 0.1})": r"^effects: unbalance: found 0\.1; allowed: .*amplitude",
    "bench.simulate('lab.toml', effects={'unbalanc': {}})": r"^effects: found 'unbalanc', did you mean 'unbalance'",
    "bench.simulate('lab.toml', effects={'unbalance': {'amplitud': 1}})": r"did you mean 'amplitude'",
    "bench.simulate('lab.toml', effects={'unbalance': {'amplitude': '1 A'}})": r"amplitude: found '1 A'; allowed",
    "bench.simulate('lab.toml', 'fast_reversal')": r"profile: found 'fast_reversal', did you mean 'fast_reversals'",
    "bench.simulate('lab.toml', np.zeros((3, 2)))": r"profile: found an array of shape \(3, 2\)",
    "bench.simulate('lab.toml', effects='unbalanc:amplitude=1')": r"effect unbalanc.*did you mean 'unbalance'",
    "bench.diagnose(df, rig, excluded=['coging_torque'])": r"excluded.*did you mean 'cogging_torque'",
    "bench.diagnose(plain, rig, holdout=plain)": r"^holdout: found the recording itself",
    "bench.Rig(name='x', kind='rotary', motr={})": r"motr: unknown key, did you mean 'motor'",
    "bench.load_rig('emp')": r"no shipped rig, did you mean 'emps'",
    "bench.Estimate.load('estimated').plot()": r"plot\(\), residuals: found an estimate without its recording",
    "bench.Estimate.load('out/diagnosis.json')": r"out/diagnosis.json: contains no estimate",
    "bench.Diagnosis.load('estimated')": r"estimated/diagnosis\.npz: no such file",
    "bench.robot(df, 'robot.xml')": r"^logs: found DataFrame; allowed: paths of files",
    "bench.robot([], 'robot.xml')": r"^logs: found none",
}


def refused_in_one_line(names, monkeypatch, call, words, *kinds):
    monkeypatch.chdir(names[0])
    with pytest.raises(kinds) as refused:
        eval(call, dict(names[1]))
    said = str(refused.value)
    assert re.search(words, said) and "\n" not in said, said
    return said


@pytest.mark.parametrize("call", ABSENT)
def test_what_a_result_does_not_have_is_one_helpful_line(names, monkeypatch, call):
    refused_in_one_line(names, monkeypatch, call, ABSENT[call], AttributeError, KeyError, TypeError, bench.InputError)


@pytest.mark.parametrize("call", REFUSED)
def test_what_cannot_be_is_one_line_that_names_the_argument(names, monkeypatch, call):
    assert "--" not in refused_in_one_line(names, monkeypatch, call, REFUSED[call], bench.BenchError)


def test_what_is_assumed_is_said(names):
    """Units that neither a frame nor a dictionary has, and a rig that was drafted."""
    _, known = names
    said = " ".join(repr(bench.identify(known["df"], NUMBERS)).split())
    assert "velocity taken as rad/s" in said and 'units={"' in said
    assert "without a unit are taken in SI: rotor_inertia in kg*m**2, torque_constant in N*m/A" in said
    assert "taken" not in repr(bench.identify(known["df"], TABLES, units=known["si_units"]))
    assert "no rig was given" in repr(bench.identify(known["df"]))
    found = bench.diagnose(known["df"], NUMBERS)
    assert [check.status for check in found.checks if check.name == "units"] == ["warn"]


def test_a_rig_file_still_has_units(tmp_path):
    (tmp_path / "rig.toml").write_text(RIG.replace('"0.8 N*m/A"', "0.8"))
    with pytest.raises(bench.InputError, match=r"motor\.torque_constant: found 0\.8; allowed: a number with a unit"):
        bench.load_rig(tmp_path / "rig.toml")


def test_numbers_and_texts_make_the_same_rig():
    one, other = bench.Rig(name="x", kind="rotary", **TABLES), bench.Rig(name="x", kind="rotary", **NUMBERS)
    assert one.motor == other.motor
    assert (one.assumed, len(other.assumed)) == ((), 1)
    force = bench.Rig(name="x", kind="linear", motor={"force_constant": 2})
    assert force.motor.force_constant == 2.0
    assert force.assumed == ("numbers of the rig without a unit are taken in SI: force_constant in N/A",)
