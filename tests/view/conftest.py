import pytest

from bench.trace.write import write
from tests.diagnosis.conftest import bench
from tests.diagnosis.test_commands import PENDULUM, run_of, with_unbalance
from tests.fit.motions import Truth
from tests.view.motions import model_file

__all__ = ["bench"]


@pytest.fixture(scope="session")
def trace():
    """Four seconds under an unbalance, in closed form."""
    return with_unbalance(run_of(seed=2, duration=4.0))


@pytest.fixture(scope="session")
def folder(tmp_path_factory, trace):
    """One with that recording and a model of its true values."""
    folder = tmp_path_factory.mktemp("shown")
    write(trace, folder / "run.csv")
    model_file(folder / "model.toml", Truth().values, unbalance={"amplitude": PENDULUM, "phase": 0.0})
    return folder
