"""Without a holdout no true name is lost to how a recording is cut, or to a simulation that cannot keep its phase.

Truth from the independent integrator.
"""

import pytest

from bench.diagnosis.diagnosis import diagnose
from bench.diagnosis.model import Recorded, keeps_phase
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import Motion, Ramps, slow_reversals
from tests.diagnosis.constructed import RIG, moved
from tests.diagnosis.constructed import recorded as made_up
from tests.diagnosis.hand_made import term
from tests.diagnosis.test_add import added
from tests.outside import SlowMemoryFriction
from tests.recorded import PLAIN

OFFSET, COGGING, HARMONIC = 0.1, 0.15, 60.0
STANDS, JERK = 5.0, 0.02


def strokes(speeds):
    """To each speed - rad/s - and to rest again, one after the other."""
    points = [(0.0, 0.0)]
    for speed in speeds:
        time, rise = points[-1][0], abs(speed) / 600.0
        points += [(time + rise, speed), (time + rise + 0.15, speed)]
        points += [(time + 2.0 * rise + 0.15, 0.0), (time + 2.0 * rise + 0.2, 0.0)]
    return Ramps(points, JERK)


@pytest.fixture(scope="module")
def recorded():
    """An axis that runs forward, stands, and runs backward; and one that runs slowly over strong cogging."""
    there = strokes([10.0, 40.0, -2.0, 80.0, 25.0, -2.0, 60.0, 15.0, 90.0])
    back = strokes([-30.0, -70.0, -12.0, -50.0])
    motions = {
        "stands": Motion((there, Ramps([(0.0, 0.0), (STANDS, 0.0)], JERK), back)),
        "cogging": Motion(
            (
                strokes([10.0, -40.0, 8.0, -25.0, 6.0, -15.0, 30.0]),
                slow_reversals([4.0, 3.0, 6.0, 2.0], 0.6, JERK),
                strokes([-30.0, -7.0, -12.0, 5.0]),
            )
        ),
    }
    effects = {
        "stands": (KINDS["torque_offset"](OFFSET), SlowMemoryFriction(0.8, 0.5, 40.0)),
        "cogging": (KINDS["cogging_torque"](COGGING, HARMONIC, 0.4),),
    }
    return PLAIN.record(effects, motions, 3)


def test_an_axis_that_stands_in_the_middle_keeps_its_constant_torque(recorded):
    """Beside friction that no catalogue holds. Its first two thirds go forward, where an offset is friction."""
    result = added((PLAIN.rig, recorded["stands"], None), [term("direction_dependent_friction")], with_holdout=False)
    assert result.rejected == ()
    (named,) = result.effects  # forward less backward is twice an offset
    assert named.parameters["coulomb_difference"].value == pytest.approx(2.0 * OFFSET, rel=0.02)


def test_a_wave_whose_simulation_loses_its_phase_is_judged_by_its_torque(recorded):
    """Held softly, the simulated axis slips over cogs whose stiffness exceeds the cascade's: A*n > 0.37*J*w**2."""
    found = diagnose(recorded["cogging"], PLAIN.rig)
    assert found.verdict == "explained"
    (named,) = found.effects
    assert named.parameters["harmonic"].value == HARMONIC
    assert named.parameters["amplitude"].value == pytest.approx(COGGING, rel=0.02)
    assert any("torque at the measured position" in warning for warning in found.warnings)


@pytest.mark.parametrize(
    ("one", "drift", "kept"),
    [
        (term("cogging_torque", 60.0), 0.017, True),
        (term("cogging_torque", 60.0), 0.018, False),
        (term("backlash", 0.06, 639.0, 0.5, 0.0), 0.0099, True),
        (term("backlash", 0.06, 639.0, 0.5, 0.0), 0.0101, False),
        (term("torsion_spring"), 1.0, True),
    ],
)
def test_phase_is_kept_within_a_sixth_of_a_turn_of_the_wave_or_of_the_gap(one, drift, kept):
    """A wave out of phase by p leaves |exp(j*p) - 1| of itself: all of it from pi/3 on."""
    trace = made_up(moved(2.0))
    assert keeps_phase([one], Recorded("recording", trace, RIG).drift(trace["position"] + drift)) is kept
