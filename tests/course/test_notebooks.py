"""Notebooks of the tasks: executed as they come, with solutions, and with a mistake."""

import contextlib
import json
import shutil
from contextlib import redirect_stdout
from io import StringIO

import matplotlib.pyplot as plt
import pytest

from bench.assets import asset
from bench.course.notebooks import TEXTS, notebook, write_notebooks
from bench.errors import InputError
from tests.command import bench

SIGNALS = """omega = np.radians(degrees_per_second)
current = milliamperes / 1000
alpha = np.diff(omega, prepend=omega[0]) / trace.sample_period
M = kT(current) * current"""
SOLUTIONS = {
    "task01": {
        "matrix": "A = np.column_stack([y**2, y, np.ones_like(y)])",
        "solve": "a, b, c = np.linalg.lstsq(A, z, rcond=None)[0]\nE = np.sum((z - A @ [a, b, c]) ** 2)",
        "graph": "plt.plot(y, z, '.')",
    },
    "task02": {
        "difference": "def backward_difference(u, T):\n    return np.diff(u, prepend=u[:1]) / T",
        "sine": "t = np.arange(0, 2 * np.pi, 0.001)\n"
        "largest_error = np.abs(backward_difference(np.sin(t), 0.001) - np.cos(t))[1:].max()",
    },
    "task03": {"constants": "kT_stall, kT_peak = M0 / I0, Mmax / Imax"},
    "task04": {
        "coefficients": "a, b, c = np.linalg.solve([[0, 1, 0], [I0**2, I0, 1], [Imax**2, Imax, 1]],"
        " [0, M0 / I0, Mmax / Imax])",
    },
    "task05": {"signals": SIGNALS},
    "task06": {
        "inertia": "alpha_max = np.abs(alpha).max()\nhard = np.abs(alpha) >= alpha_max / 4\n"
        "J = np.mean(M[hard] / alpha[hard])\nJ_load = J - J_motor",
    },
    "task07": {"signals": SIGNALS},
    "task08": {
        "filter": "alpha_filt = np.convolve(alpha[1:], np.ones(4) / 4, mode='valid')\n"
        "part = slice(2, 2 + alpha_filt.size)\nt_sync, omega_sync, M_sync = t[part], omega[part], M[part]",
        "fast": "fast = np.abs(omega_sync) >= 20",
    },
    "task09": {
        "solve": "A = np.column_stack([alpha_filt, omega, np.sign(omega)])\n"
        "J, K_fric_w, K_fric_0 = theta = np.linalg.lstsq(A, M, rcond=None)[0]\nE = np.sum((M - A @ theta) ** 2)",
    },
    "task10": {
        "curve": "start = np.argmax(M > 3.0)\nkept = (M >= 0.2) & (np.arange(M.size) >= start)\n"
        "n, M_kept = omega[kept] * 30 / np.pi, M[kept]",
        "corner": "corner = n[np.flatnonzero(M_kept > 0.99 * np.median(M_kept[:20]))[-1]]",
    },
    "task11": {
        "circuit": "Ke = U / no_load\nR_hot = (U - Ke * corner_hot) / Imax\n"
        "R_cold = motor.cold_resistance_share * R_hot\ncorner_cold = (U - R_cold * Imax) / Ke",
        "inductance": "inductance_moves_the_corner = False",
    },
}
#: A solution with a mistake, and words of the checks that must notice.
MISTAKES = [
    ("task02", {"difference": "def backward_difference(u, T):\n    return np.diff(u, prepend=u[:1])"}, "ramp"),
    ("task05", {"signals": SIGNALS.replace("np.radians(degrees_per_second)", "degrees_per_second")}, "2π"),
    ("task05", {"signals": SIGNALS.replace("kT(current)", "0.7")}, "torque per ampere"),
    ("task08", {"filter": SOLUTIONS["task08"]["filter"].replace("slice(2, 2 +", "slice(4, 4 +")}, "in step"),
    (
        "task09",
        {"solve": SOLUTIONS["task09"]["solve"].replace("np.sign(omega)", "np.ones_like(omega)")},
        "friction resists",
    ),
    ("task10", {"curve": SOLUTIONS["task10"]["curve"].replace("30 / np.pi", "60")}, "rpm"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    where = tmp_path_factory.mktemp("student")
    shutil.copytree(asset("data", "traces"), where, dirs_exist_ok=True, ignore=shutil.ignore_patterns("*.json"))
    return where


def printed(folder, text):
    """Lines of all checks of a notebook whose cells are executed one after the other."""
    names = {}
    with contextlib.chdir(folder), redirect_stdout(StringIO()) as out:
        for cell in json.loads(text)["cells"]:
            if cell["cell_type"] == "code":
                exec(compile(cell["source"], cell["id"], "exec"), names)  # what a kernel does
    plt.close("all")
    return lines(out.getvalue())


def lines(text):
    return [line for line in text.splitlines() if line.startswith(("open:", "ok:", "not yet:"))]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("task", SOLUTIONS)
def test_a_kernel_executes_it_too(task, folder):
    nbformat = pytest.importorskip("nbformat", reason="kernels come with the extra 'notebooks'")
    nbclient = pytest.importorskip("nbclient", reason="kernels come with the extra 'notebooks'")
    text = (TEXTS / f"{task}.md").read_text(encoding="utf-8")
    for filled, word in (({}, "open"), (SOLUTIONS[task], "ok")):
        book = nbformat.reads(notebook(text, filled), as_version=4)
        nbformat.validate(book)
        nbclient.NotebookClient(book, timeout=300, resources={"metadata": {"path": str(folder)}}).execute()
        outputs = [out for cell in book.cells if cell.cell_type == "code" for out in cell.outputs]
        found = lines("\n".join(out.get("text", "") for out in outputs))
        assert {line.split(":")[0] for line in found} == {word}, found


def test_there_is_one_for_each_task():
    assert sorted(path.stem for path in TEXTS.glob("*.md")) == sorted(SOLUTIONS)


@pytest.mark.parametrize("task", SOLUTIONS)
def test_a_notebook_runs_as_it_comes_and_with_its_solution(task, folder):
    text = (TEXTS / f"{task}.md").read_text(encoding="utf-8")
    empty = printed(folder, notebook(text))
    assert empty
    assert {line.split(":")[0] for line in empty} == {"open"}, empty
    solved = printed(folder, notebook(text, SOLUTIONS[task]))
    assert {line.split(":")[0] for line in solved} == {"ok"}, solved
    assert len(solved) == len(empty)


@pytest.mark.parametrize(("task", "cells", "word"), MISTAKES)
def test_checks_notice_a_mistake(task, cells, word, folder):
    text = (TEXTS / f"{task}.md").read_text(encoding="utf-8")
    found = printed(folder, notebook(text, {**SOLUTIONS[task], **cells}))
    assert any(line.startswith("not yet:") and word in line for line in found), found


def test_the_command_writes_them_and_overwrites_none(tmp_path):
    status, out, _ = bench("lab", "--notebooks", tmp_path / "mine")
    assert status == 0
    assert out.count("wrote") == 11
    for path in (tmp_path / "mine").iterdir():
        assert "lstsq" not in path.read_text(encoding="utf-8")
        assert json.loads(path.read_text(encoding="utf-8"))["nbformat"] == 4
    with pytest.raises(InputError, match="task01"):
        write_notebooks(tmp_path / "mine")
