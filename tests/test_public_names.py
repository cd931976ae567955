"""`import bench`: its names hold in every order of imports, load only what they need, and do what docs/api.md shows."""

import ast
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import bench
from bench.assets import asset
from bench.trace.write import write
from tests.export.two_links import HIDDEN, MJCF, log, write_log
from tests.fit.motions import Truth, recording
from tests.studies.servos import Truth as Servo
from tests.studies.servos import log as of_servo

ROOT = Path(__file__).resolve().parents[1]
EXAMPLES = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "api.md").read_text(encoding="utf-8"), re.DOTALL)
COGGING, HARMONIC = 0.05, 6
RIG = 'name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\nrotor_inertia = "2 kg*cm**2"\n'


def fresh(script, *arguments):
    """Standard output of a script in an interpreter of its own."""
    command = [sys.executable, "-c", script, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stderr == ""
    return done.stdout


def imported_for_type_checkers():
    """Name -> module of every import that only type checkers see."""
    tree = ast.parse((ROOT / "bench" / "__init__.py").read_text(encoding="utf-8"))
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    return {alias.name: node.module for node in block.body for alias in node.names}


def test_every_name_is_what_type_checkers_think_it_is():
    declared = imported_for_type_checkers()
    assert {*declared, "BenchError", "InputError", "UndeterminedError", "__version__"} == set(bench.__all__)
    for name, module in declared.items():
        found = getattr(bench, name)
        assert (found.__name__, found.__module__) == (name, module)
    assert set(bench.__all__) <= set(dir(bench))


def test_a_name_it_does_not_have_is_an_error():
    with pytest.raises(AttributeError, match="bench has no 'identfy', did you mean 'identify'"):
        bench.identfy  # noqa: B018


def test_a_function_is_no_package_and_it_is_typed():
    """A package of a function's name would hide the function after its import."""
    for name in ("identify", "diagnose", "check", "simulate", "replay"):
        assert not [*(ROOT / "bench").glob(name), *(ROOT / "bench").glob(f"{name}.py")]
    assert (ROOT / "bench" / "py.typed").exists()


LOADED = """
import sys
from bench.__main__ import main
try:
    main()
except SystemExit as stop:
    assert not stop.code, stop.code
print("loaded", *sys.modules)
"""


def loaded(script, *arguments):
    """Modules that were loaded when a script was done."""
    printed, _, modules = fresh(script, *arguments).rpartition("loaded ")
    return printed, set(modules.split())


def test_import_bench_loads_none_of_its_libraries():
    _, modules = loaded("import bench, sys; print('loaded', *sys.modules)")
    assert not modules & {"numpy", "scipy", "mujoco", "matplotlib", "pint", "pyarrow", "pydantic", "typer", "rich"}


@pytest.mark.parametrize(("option", "words"), [("--version", bench.__version__), ("--help", "identify")])
def test_the_command_answers_without_the_libraries_of_its_work(option, words):
    printed, modules = loaded(LOADED, option)
    assert words in printed
    assert not modules & {"mujoco", "matplotlib", "scipy", "pint", "pyarrow", "numpy"}


def test_the_function_identify_loads_neither_a_simulation_nor_a_reader():
    _, modules = loaded("import bench, sys; bench.identify; print('loaded', *sys.modules)")
    assert not modules & {"scipy.special", "mujoco", "matplotlib", "pint", "pyarrow", "typer", "rich"}
    assert not modules & {"bench.trace.read", "bench.plant.run", "bench.report.document"}


@pytest.mark.parametrize(("command", "needed"), [("identify", set()), ("diagnose", {"mujoco"})])
def test_a_command_on_a_table_loads_only_what_it_needs(tmp_path, command, needed):
    (tmp_path / "rig.toml").write_text(RIG, encoding="utf-8")
    write(recording(np.random.default_rng(0), duration=4.0), tmp_path / "run.csv", {"velocity": "deg/s"})
    printed, modules = loaded(LOADED, command, tmp_path / "run.csv", "--rig", tmp_path / "rig.toml")
    assert "moment of inertia" in printed
    heavy = {"mujoco", "glfw", "matplotlib", "jinja2", "pint", "scipy.stats", "scipy.signal", "pandas", "psutil"}
    assert modules & heavy <= needed
    assert not modules & {"pyarrow.parquet", "pyarrow.fs", "rich.progress"}


def with_cogging(seed):
    trace = recording(np.random.default_rng(seed), duration=4.0, position=True)
    torque = COGGING * np.sin(HARMONIC * trace["position"])
    return replace(trace, signals={**trace.signals, "current": trace["current"] + torque / 0.8})


def test_the_examples_of_the_manual_run_and_find_the_truth(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("rig.toml").write_text(RIG, encoding="utf-8")
    shutil.copy(asset("data", "rigs", "sh30701p.toml"), "lab.toml")
    for number in (1, 2):
        write(with_cogging(number), f"run{number}.csv.gz")
    Path("robot.xml").write_text(MJCF)
    write_log("log.csv", log())
    write(of_servo(Servo(rate=100.0), np.random.default_rng(5), 12.0), Path("goals.csv"))
    names = {}
    for block in EXAMPLES:
        exec(compile(block, "docs/api.md", "exec"), names)
    assert names["inertia"].value == pytest.approx(Truth().inertia, rel=0.01)
    assert names["elbow"].parameters["armature"].value == pytest.approx(HIDDEN.armature, rel=0.01)
    assert names["mine"].units["velocity"] == "rad/s"
    assert [effect.name for effect in names["found"].effects] == ["cogging_torque"]
    assert names["found"].effects[0].parameters["amplitude"].value == pytest.approx(COGGING, rel=0.05)
    assert np.nanstd(names["difference"]) < 0.01 * np.std(names["speed"])
    assert names["simulated"].trace["velocity"].size == bench.read("simulated.parquet")["velocity"].size
    assert "the axis moves backward only" in capsys.readouterr().out.splitlines()[-1]


def test_the_manual_shows_every_function():
    code = "".join(EXAMPLES)
    assert all(f"bench.{name}" in code for name in bench.__all__ if name.islower() and name != "__version__")
    assert "bench.Trace.from_arrays(" in code
