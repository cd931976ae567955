"""Notebooks of the tasks: executed as they come, with solutions, and with a mistake."""

import contextlib
import json
import re
import shutil
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest

from bench.course.notebooks import TEXTS, notebook, write_notebooks
from bench.errors import InputError
from tests.command import bench
from tests.course.conftest import as_a_student_has_them

SIGNALS = """omega, current = to_si(degrees_per_second, milliamperes)
alpha = num_derivative(omega, T)
M = torqueconstant(current) * current"""
MEAN = """def filtered_acceleration(omega, T):
    alpha = np.convolve(num_derivative(omega, T)[1:], np.ones(4) / 4, 'valid')
"""
OWN = "import numpy as np\nfrom bench.course.notebooks import own\nnum_derivative = own('num_derivative')\n"
#: What a student writes, with numpy alone, by the names of the cells.
SOLUTIONS = {
    "task01": {
        "parabola": "import numpy as np\ndef parabola(y, z):\n    A = np.column_stack([y**2, y, np.ones_like(y)])\n"
        "    theta = np.linalg.lstsq(A, z, rcond=None)[0]\n    return *theta, np.sum((z - A @ theta) ** 2)",
        "graph": "a, b, c, E = parabola(y, z)\nplt.plot(y, z, '.')",
    },
    "task02": {
        "difference": "import numpy as np\ndef num_derivative(u, T):\n    return np.diff(u, prepend=u[:1]) / T",
        "sine": "t = np.arange(0, 2 * np.pi, 0.001)\nd = num_derivative(np.sin(t), 0.001)\n"
        "largest_error = np.abs(d - np.cos(t))[1:].max()\n"
        "explained_by_half_a_sample = np.abs(d - np.cos(t - 0.0005))[1:].max()",
    },
    "task03": {
        "constants": "def torque_per_ampere(torque, current):\n    return torque / current",
        "values": "kT_stall, kT_peak = torque_per_ampere(M0, I0), torque_per_ampere(Mmax, Imax)",
    },
    "task04": {
        "coefficients": "def torqueconstant(Iq):\n    return -0.00559804 * Iq**2 + 0.795915 * Iq**0",
    },
    "task05": {
        "units": "import numpy as np\ndef to_si(degrees_per_second, milliamperes):\n"
        "    return degrees_per_second * np.pi / 180, milliamperes / 1000",
        "signals": SIGNALS,
    },
    "task06": {
        "inertia": "import numpy as np\ndef mean_inertia(alpha, M):\n    largest = np.abs(alpha).max()\n"
        "    hard = np.abs(alpha) >= largest / 4\n    return np.mean(M[hard] / alpha[hard]), largest",
        "load": "_, _, alpha, M = signals(folder.run('JLoadWithoutFriction'))\nJ, alpha_max = mean_inertia(alpha, M)\n"
        "J_load = J - folder.rig.motor.rotor_inertia\n"
        "J_disk = disk.disk_mass * (disk.outer_diameter**2 + disk.inner_diameter**2) / 8",
    },
    "task07": {"signals": SIGNALS},
    "task08": {
        "filter": f"{OWN}{MEAN}    return alpha, slice(2, 2 + alpha.size)",
        "fast": "import numpy as np\ndef fast_samples(omega):\n    return np.abs(omega) >= 20",
    },
    "task09": {
        "solve": "import numpy as np\ndef inertia_and_friction(alpha, omega, M):\n"
        "    A = np.column_stack([alpha, omega, np.sign(omega)])\n"
        "    theta = np.linalg.lstsq(A, M, rcond=None)[0]\n    return *theta, np.sum((M - A @ theta) ** 2)",
        "load": "J, K_fric_w, K_fric_0, E = inertia_and_friction(*remaining(folder.run('JLoadAndFriction')))\n"
        "J_load = J - folder.rig.motor.rotor_inertia",
    },
    "task10": {
        "curve": "import numpy as np\ndef kept_samples(omega, M):\n"
        "    kept = (M >= 0.2) & (np.arange(M.size) >= np.argmax(M > 3.0))\n"
        "    return omega[kept] * 30 / np.pi, M[kept]",
        "corner": "import numpy as np\ndef corner_speed(n, M):\n"
        "    return n[np.flatnonzero(M > 0.99 * np.median(M[:20]))[-1]]",
        "own": "n, M = kept_samples(run.velocity, torqueconstant(run.current) * run.current)\n"
        "corner = corner_speed(n, M)",
    },
    "task11": {
        "circuit": "def circuit(U, Imax, corner, no_load):\n    Ke = U / no_load\n"
        "    return Ke, (U - Ke * corner) / Imax\ndef corner_of(U, Imax, Ke, R):\n    return (U - R * Imax) / Ke",
        "cold": "Ke, R = circuit(U, Imax, corner_hot, no_load)\nR_cold = 0.7 * R\n"
        "corner_cold = corner_of(U, Imax, Ke, R_cold)",
        "decision": "inductance_moves_the_corner, inductance_moves_the_fall = False, True",
    },
}
MEDIAN = "n[np.flatnonzero(M > 0.99 * np.median(M[:20]))[-1]]"
SAVGOL = "import scipy.signal\n    return scipy.signal.savgol_filter(omega, 7, 2, deriv=1, delta=T), slice(0, None)"
#: Of a cell what stands there, what a student writes instead, and words of the check that notices; none where it is
#: right too.
CHANGES = [
    ("task01", "parabola", "np.linalg.lstsq(A, z, rcond=None)[0]", "np.linalg.solve(A.T @ A, A.T @ z)", ""),
    ("task02", "difference", "np.diff(u, prepend=u[:1])", "np.append(0, u[1:] - u[:-1])", ""),
    ("task08", "filter", "slice(2, 2 + alpha.size)", "np.arange(alpha.size) + 2", ""),
    ("task08", "filter", "return alpha, slice(2, 2 + alpha.size)", SAVGOL, ""),
    ("task10", "corner", MEDIAN, "n[M > 0.985 * M[:50].mean()].max()", ""),
    ("task01", "parabola", "y, np.ones_like(y)]", "np.ones_like(y), y]", "own coefficients"),
    ("task01", "parabola", "np.sum((z - A @ theta) ** 2)", "np.mean((z - A @ theta) ** 2)", "all of E"),
    ("task01", "parabola", "A, z, rcond=None)", "A[:9], z[:9], rcond=None)", "does not move the path"),
    ("task02", "difference", "u[:1]) / T", "u[:1])", "ramp"),
    ("task02", "difference", "np.diff(u, prepend=u[:1]) / T", "np.gradient(u, T)", "first value"),
    ("task02", "difference", "np.diff(u, prepend=u[:1]) / T", "np.append(np.diff(u) / T, 0)", "adds up"),
    ("task02", "difference", "/ T", "/ 0.001", "ramp"),
    ("task02", "sine", "0.0005", "0.001", "half a sample"),
    ("task03", "constants", "torque / current", "current / torque", "times the current"),
    ("task03", "values", "torque_per_ampere(Mmax, Imax)", "torque_per_ampere(M0, I0)", "saturates"),
    ("task03", "values", "Imax)", "I0)", "saturates"),
    ("task04", "coefficients", "Iq**2", "Iq", "as strong one way"),
    ("task04", "coefficients", "0.795915 * Iq**0", "0.75", "M0 at I0"),
    ("task04", "coefficients", "-0.00559804 * Iq**2 + 0.795915 * Iq**0", "3.5 / 5.7 + 0 * Iq", "M0 at I0"),
    ("task04", "coefficients", "-0.00559804", "0.00559804", "Mmax at Imax"),
    ("task05", "units", "* np.pi / 180", "", "2π"),
    ("task05", "units", "/ 1000", "", "ampere"),
    ("task05", "signals", "torqueconstant(current) * current", "0.7 * current", "at more current"),
    ("task05", "signals", "torqueconstant(current) * current", "torqueconstant(current)", "current's sign"),
    ("task05", "signals", "num_derivative(omega, T)", "num_derivative(omega, 1)", "adds up"),
    ("task06", "inertia", "largest / 4", "largest / 40", "less than a quarter"),
    ("task06", "inertia", "np.mean(M[hard] / alpha[hard])", "np.mean(M[hard]) / np.mean(alpha[hard])", "counts alike"),
    ("task06", "inertia", "np.abs(alpha).max()", "alpha.max()", "whichever way"),
    ("task06", "load", "J - folder", "J + folder", "motor turns"),
    ("task06", "load", "/ 8", "/ 2", "ring"),
    ("task07", "signals", "torqueconstant(current)", "torqueconstant(milliamperes)", "current's sign"),
    ("task08", "filter", "slice(2, 2 +", "slice(4, 4 +", "in step"),
    ("task08", "filter", "slice(2, 2 +", "slice(1, 1 +", "in step"),
    ("task08", "filter", "np.ones(4) / 4", "np.ones(3) / 3", "in step"),
    ("task08", "filter", "np.ones(4) / 4", "np.ones(4)", "steady"),
    ("task08", "filter", "np.ones(4) / 4", "np.ones(1)", "less noise"),
    ("task08", "fast", "np.abs(omega)", "omega", "whichever way"),
    ("task08", "fast", ">= 20", "> 20", "20 rad/s is fast"),
    ("task09", "solve", "np.sign(omega)", "np.ones_like(omega)", "has its values"),
    ("task09", "solve", "np.sum((M", "np.mean((M", "all of E"),
    ("task09", "solve", "M, rcond", "np.abs(M), rcond", "has its values"),
    ("task09", "load", "J - folder", "J * 1e4 - folder", "motor turns"),
    ("task09", "load", "J_load =", "J *= 1.1\nJ_load =", "goes with none"),
    ("task10", "curve", "30 / np.pi", "60", "50 turns"),
    ("task10", "curve", "M >= 0.2", "M >= 0.0", "0.2"),
    ("task10", "curve", "np.argmax(M > 3.0)", "0", "from the first"),
    ("task10", "corner", "0.99", "0.8", "starts to decline"),
    ("task10", "corner", "0.99 * np.median(M[:20])", "3.0", "starts to decline"),
    ("task10", "own", "corner = ", "corner = 1.3 * ", "full torque below"),
    ("task10", "own", "corner = ", "corner = 0.7 * ", "less beyond"),
    ("task11", "circuit", "U / no_load", "U / corner", "known"),
    ("task11", "circuit", "(U - Ke * corner) / Imax", "U / Imax", "known"),
    ("task11", "circuit", "(U - R * Imax) / Ke", "(U + R * Imax) / Ke", "the curve's"),
    ("task11", "cold", "0.7 * R", "R / 0.7", "resists less"),
    ("task11", "cold", "Imax, Ke, R_cold)", "Imax, Ke, R)", "as much as its resistance"),
    ("task11", "decision", "False, True", "True, True", "corner is what the equations do"),
    ("task11", "decision", "False, True", "False, False", "fall beyond"),
    ("task11", "decision", "False, True", "'no', True", "corner is what the equations do"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return as_a_student_has_them(tmp_path_factory.mktemp("student"))


def printed(folder, text):
    """Lines of all checks of a notebook whose cells are executed one after the other, or written into their files."""
    names = {}
    np.random.seed(5)  # noqa: NPY002, what the checks draw from
    with contextlib.chdir(folder), redirect_stdout(StringIO()) as out:
        for cell in json.loads(text)["cells"]:
            if cell["cell_type"] != "code":
                continue
            first, _, rest = cell["source"].partition("\n")
            if first.startswith("%%writefile "):  # what a kernel does
                Path(first.split()[1]).write_text(rest, encoding="utf-8")
            else:
                exec(compile(cell["source"], cell["id"], "exec"), names)
    plt.close("all")
    return lines(out.getvalue())


def lines(text):
    return [line for line in text.splitlines() if line.startswith(("open:", "ok:", "not yet:"))]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("task", SOLUTIONS)
def test_a_kernel_executes_it_too(task, folder, solved, tmp_path):
    nbformat = pytest.importorskip("nbformat", reason="kernels come with the extra 'notebooks'")
    nbclient = pytest.importorskip("nbclient", reason="kernels come with the extra 'notebooks'")
    for k, (filled, word) in enumerate((({}, "open"), (SOLUTIONS[task], "ok"))):
        where = shutil.copytree((folder, solved[0])[k], tmp_path / word)
        book = nbformat.reads(notebook(text_of(task), filled), as_version=4)
        nbformat.validate(book)
        nbclient.NotebookClient(book, timeout=300, resources={"metadata": {"path": str(where)}}).execute()
        outputs = [out for cell in book.cells if cell.cell_type == "code" for out in cell.outputs]
        found = lines("\n".join(out.get("text", "") for out in outputs))
        assert {line.split(":")[0] for line in found} == {word}, found


def test_there_is_one_for_each_task():
    assert sorted(path.stem for path in TEXTS.glob("*.md")) == sorted(SOLUTIONS)


@pytest.fixture(scope="module")
def solved(folder, tmp_path_factory):
    """A folder where every task is solved, one after the other, and what the checks said of each."""
    where = tmp_path_factory.mktemp("solved")
    shutil.copytree(folder, where, dirs_exist_ok=True)
    return where, {task: printed(where, notebook(text_of(task), cells)) for task, cells in SOLUTIONS.items()}


def text_of(task):
    return (TEXTS / f"{task}.md").read_text(encoding="utf-8")


def with_change(solved, tmp_path, task, cell, there, instead):
    """What the checks of a solved task say with something else in one of its cells, in a folder of its own."""
    assert there in SOLUTIONS[task][cell]
    for path in solved[0].iterdir():
        if path.suffix == ".py":
            shutil.copy(path, tmp_path)
        else:
            (tmp_path / path.name).symlink_to(path)
    changed = {**SOLUTIONS[task], cell: SOLUTIONS[task][cell].replace(there, instead)}
    return printed(tmp_path, notebook(text_of(task), changed))


@pytest.mark.parametrize("task", SOLUTIONS)
def test_a_notebook_runs_as_it_comes_and_with_its_solution(task, folder, solved):
    for lines_, word in ((printed(folder, notebook(text_of(task))), "open"), (solved[1][task], "ok")):
        assert {line.split(":")[0] for line in lines_} == {word}, lines_
        assert len(lines_) == len(solved[1][task])


@pytest.mark.parametrize(("task", "cell", "there", "instead", "word"), CHANGES)
def test_checks_notice_a_mistake_and_pass_other_right_ways(task, cell, there, instead, word, solved, tmp_path):
    found = with_change(solved, tmp_path, task, cell, there, instead)
    if word:
        assert any(line.startswith("not yet:") and word in line for line in found), found
    else:
        assert {line.split(":")[0] for line in found} == {"ok"}, found


def test_what_a_task_writes_later_ones_use(solved, tmp_path):
    """A torque constant that is half too large is seen in tasks 6, 9 and 10, whose own cells are right."""
    for path in solved[0].iterdir():
        (tmp_path / path.name).symlink_to(path)
    (tmp_path / "torqueconstant.py").unlink()
    (tmp_path / "torqueconstant.py").write_text("def torqueconstant(Iq):\n    return 1.2 + 0 * Iq\n")
    for task, word in (("task06", "hub and bolts"), ("task07", "peak"), ("task10", "peak")):
        found = printed(tmp_path, notebook(text_of(task), SOLUTIONS[task]))
        assert any(line.startswith("not yet:") and word in line for line in found), found


def test_no_cell_that_is_there_uses_a_solution_of_the_bench():
    """What is given reads recordings and the rig; acceleration, torque, filter and fit are the student's."""
    for task in SOLUTIONS:
        cells = re.findall(r"```python (?:given|check)\n(.*?)```", text_of(task), re.DOTALL)
        imported = {
            one or two for one, two in re.findall(r"from (bench[.\w]*) import|import (bench[.\w]*)", "".join(cells))
        }
        assert imported <= {"bench", *(f"bench.course.{name}" for name in ("flights", "notebooks", "recordings"))}
        assert not re.search(r"\.(acceleration|torque)\b(?! *\()|lstsq|polyfit", "".join(cells)), task


def test_the_command_writes_them_and_overwrites_none(tmp_path):
    status, out, _ = bench("lab", "--notebooks", tmp_path / "mine")
    assert status == 0
    assert out.count("wrote") == 11
    for path in (tmp_path / "mine").iterdir():
        assert "lstsq" not in path.read_text(encoding="utf-8")
        assert json.loads(path.read_text(encoding="utf-8"))["nbformat"] == 4
    with pytest.raises(InputError, match="task01"):
        write_notebooks(tmp_path / "mine")
