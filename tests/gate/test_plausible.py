"""What a recording shows, held against what its rig says."""

import numpy as np
import pytest

from bench.gate import plausible
from bench.gate.check import Seen
from bench.rig.rig import Rig
from tests.fit.motions import recording
from tests.gate.damage import changed

#: Of a motor with a disk, together - kg*m**2.
INERTIA = 1.5e-3
RIG = Rig.of(
    {
        "name": "motor with a disk",
        "kind": "rotary",
        "motor": {"torque_constant": "0.8 N*m/A", "rotor_inertia": "2 kg*cm**2", "peak_current": "30 A"}
        | {"maximum_speed": "320 rad/s"},
        "load": {"outer_diameter": f"{np.sqrt(8.0 * (INERTIA - 2e-4)):.9g} m", "mass": "1 kg"},
    }
)


@pytest.fixture(scope="module")
def run():
    """An axis whose inertia is what its rig's motor and disk have together."""
    return recording(np.random.default_rng(4))


@pytest.mark.parametrize(
    ("factor", "status"), [(1.0, "pass"), (1.15, "pass"), (0.87, "pass"), (1.3, "warn"), (0.7, "warn"), (9.5, "fail")]
)
def test_the_inertia_of_motor_and_disk(run, factor, status):
    found = plausible.agrees(Seen(changed(run, velocity=run["velocity"] / factor), RIG))
    assert found.status == status
    assert (f"{0.0015 * factor:.2g}"[:4] in found.found) or status == "pass"


def test_top_speed_and_peak_current(run):
    def found(**motor):
        known = {"load": None, "motor": RIG.motor.model_copy(update=motor)}
        return plausible.agrees(Seen(run, RIG.model_copy(update=known)))

    slow = found(maximum_speed=20.0)
    assert slow.status == "fail" and "velocity reaches" in slow.found and "20 rad/s" in slow.found
    assert "current reaches" in found(peak_current=2.5).found
    assert found(maximum_speed=None, peak_current=None).status == "not_applicable"
