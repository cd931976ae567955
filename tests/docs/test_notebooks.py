"""The notebooks run from the first cell to the last, and find what was hidden from them."""

import re

import matplotlib.pyplot as plt
import pytest

from tests.docs.pages import DOCS, run_commands

#: The one that runs in Jupyter each time.
JUPYTER = "first_model"
#: What has to hold in each notebook once it has run, as a cell of its own.
HOLDS = {
    "first_model": """
assert abs(estimate["moment_of_inertia"].value / truth.inertia - 1.0) < 0.002
for name, true in (("viscous_friction_coefficient", 1.1e-3), ("coulomb_friction_torque", 0.085)):
    assert abs(estimate[name].value / true - 1.0) < 0.03
assert found.verdict == "nothing_missing" and after < 1.2 * found.torque.noise_floor
assert abs(mass[0, 0] / truth.inertia - 1.0) < 0.002
assert np.nanstd(off) < 0.003 * np.nanstd(moved.velocity)
""",
    "hidden_effect": """
assert found.verdict == "explained"
values = {effect.name: effect.values for effect in found.effects}
assert set(values) == {one.name for one in hidden}
assert abs(values["cogging_torque"]["amplitude"] / 0.05 - 1.0) < 0.03
assert abs(values["stribeck_friction"]["static_friction"] / 0.16 - 1.0) < 0.1
elbow = mujoco.MjModel.from_xml_path("robot_id.xml")
level = elbow.dof_frictionloss[elbow.joint("elbow").dofadr[0]]
assert abs(level / 0.085 - 1.0) < 0.03
assert elbow.actuator("elbow cogging_torque 0") is not None
assert np.std(identified[2000:]) > 5.0 * np.std(as_written[2000:])
""",
    "servo": """
values = {name: one["value"] for name, one in found["parameters"].items()}
for name, true in (("kp", 12.0), ("kv", 0.35 + 0.02), ("armature", 0.006)):
    low, high = found["parameters"][name]["ci95"]
    assert low <= true <= high, name
assert abs(values["dead_time"] - 0.012) < 5e-4  # a step of the simulation
assert np.std(simulated - measured) < 0.2 * np.std(guessed - measured)
""",
    "fleet": """
changed = {one.axis: one for one in found.summary.changed}
assert set(changed) == set(truth)
assert [changed[axis].since[:10] for axis in truth] == ["2026-03-07", "2026-03-09"]
for axis, factor in (("press 03", 1.25), ("press 08", 1.04)):
    step = changed[axis].step
    assert abs(step.after - factor * step.before) < step.reach
assert [(one.axis, one.kind) for one in found.summary.concerns] == [("press 10", "missing"), ("press 05", "refused")]
""",
}


OTHERS = sorted({*HOLDS} - {JUPYTER})


def test_every_notebook_is_tried():
    assert {path.stem for path in (DOCS / "notebooks").glob("*.md")} == set(HOLDS)


def read(name):
    """A notebook with what has to hold, and its cells of code."""
    of_myst = pytest.importorskip("myst_nb.core.read", reason="needs myst-nb (pip install -e '.[docs]')")
    from nbformat.v4 import new_code_cell

    path = DOCS / "notebooks" / f"{name}.md"
    notebook = of_myst.read_myst_markdown_notebook(path.read_text(encoding="utf-8"), path=path)
    notebook.cells.append(new_code_cell(HOLDS[name]))
    return notebook, [cell for cell in notebook.cells if cell.cell_type == "code"]


@pytest.mark.parametrize("name", OTHERS)
def test_it_runs_and_finds_the_truth(name, tmp_path, monkeypatch):
    """In this process, with its commands: a kernel takes as long to start as a notebook to run."""
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "__main__", "run_commands": run_commands}
    for cell in read(name)[1]:
        code = re.sub(r"^!\{sys\.executable\} -m (bench .*)", r"run_commands(['\1'])", cell.source, flags=re.MULTILINE)
        exec(compile(code, name, "exec"), names)
    assert plt.get_fignums()
    plt.close("all")


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of the libraries that run notebooks
@pytest.mark.parametrize("name", [JUPYTER, *(pytest.param(name, marks=pytest.mark.slow) for name in OTHERS)])
def test_it_runs_in_jupyter(name):
    notebook, cells = read(name)
    from nbclient import NotebookClient

    NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    assert any("image/png" in output.get("data", {}) for cell in cells for output in cell.outputs)
