import pytest

from bench.rig.rig import load_rig
from bench.validation.independent.rig import write_rig
from bench.validation.independent.sensors import Noise, Sensors
from tests.cases import Hidden, record
from tests.independent import axes
from tests.independent.axes import PLAIN
from tests.kept import kept


@pytest.fixture(scope="session")
def rig(tmp_path_factory):
    path = tmp_path_factory.mktemp("plain") / "rig.toml"
    write_rig(PLAIN, path)
    return load_rig(path)


@pytest.fixture(scope="session")
def sound():
    """Five seconds of one axis by the independent integrator: 1 kHz, position, speed and current with noise."""
    sensors = Sensors(velocity=Noise(white=0.02), current=Noise(white=0.01))
    plain = Hidden("plain", PLAIN, (), sensors, "null", 0.02, 5.0)
    return kept(lambda: record([plain], seed=3)[0][0].trace, __file__, str(axes.__file__))
