"""A parameter that is not determined beside what was named is refused by itself: the rest of the answer stands.

Truth from the independent integrator: an axis on a spring. That the spring leaves the inertia open is said by hand: no
name of the catalogue does, since what is made of torque is made of the modelled one.
"""

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest

from bench.baseline.observe import observe
from bench.diagnosis.add import add
from bench.diagnosis.diagnosis import decided, diagnose, show
from bench.diagnosis.policy import POLICY
from bench.diagnosis.recordings import Recordings
from bench.effects.catalogue import catalogue
from bench.errors import UndeterminedError
from bench.plant.model_file import load_model
from bench.report.diagnosis import diagnosis, diagnosis_json, write_diagnosis
from bench.report.verdict import reasons
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import Motion, slow_reversals
from bench.validation.independent.sensors import Noise, Sensors
from tests.diagnosis.off import without
from tests.recorded import PLAIN, Recorder

RUBBING = Recorder(
    replace(PLAIN.axis, coulomb=0.5),
    Sensors(velocity=Noise(white=0.003), current=Noise(white=2e-3), encoder_resolution=2e-5),
)
STIFFNESS = 0.02
#: All names but that of the spring.
EXCLUDED = frozenset(catalogue()) - {"torsion_spring"}


@dataclass(frozen=True)
class Lacking(Recordings):
    """Recordings in which the interval of the inertia contains zero with any effect, or without one, too."""

    without_effects: bool = False

    def base(self, numbers):
        found = super().base(numbers)
        inertia = found["moment_of_inertia"]
        lacks = self.without_effects or numbers.fitted.terms
        return found | {"moment_of_inertia": inertia.widened(2.0 * inertia.value)} if lacks else found


def diagnosed(recordings, excluded=EXCLUDED, policy=POLICY):
    """As `diagnose` does it with recordings."""
    recordings, bare, suspects = decided(recordings, excluded, policy)
    return show(bare, add(recordings, suspects))


@pytest.fixture(scope="module")
def recorded():
    """Rig, and the axis on a spring."""
    speeds = [6.0, 8.0, 4.0, 7.0, 5.0, 9.0]
    motion = Motion((slow_reversals(speeds, 0.25, 0.02), slow_reversals(speeds[::-1], 0.25, 0.02)))
    return RUBBING.rig, RUBBING.record({"spring": (KINDS["torsion_spring"](STIFFNESS),)}, motion, 3)["spring"]


@pytest.fixture(scope="module")
def lacking(recorded):
    """Diagnosed where no fit with a name determines the inertia."""
    rig, trace = recorded
    return diagnosed(Lacking.of(trace, rig, None))


def test_names_that_take_the_inertia_are_a_remainder_and_leave_the_other_parameters(lacking):
    assert [effect.name for effect in lacking.effects] == ["torsion_spring"]
    assert lacking.verdict == "unexplained_remainder"
    assert set(lacking.refused) == {"moment_of_inertia", "load_moment_of_inertia"}
    assert reasons(lacking)[0].startswith("moment of inertia is not determined: its interval")
    assert set(lacking.parameters) == {"viscous_friction_coefficient", "coulomb_friction_torque"}


def test_its_model_is_the_last_that_has_an_inertia(lacking, recorded, tmp_path):
    """Here the bare axis, whose J the spring biases by k/w**2 at most."""
    assert lacking.model is not None
    assert lacking.model.model.effects == ()
    assert lacking.model.model.parameters.inertia == pytest.approx(RUBBING.axis.inertia, rel=0.5)
    assert np.isnan(lacking.steps[-1].velocity).all()
    assert np.isfinite(lacking.steps[0].velocity).all()
    write_diagnosis(tmp_path / "found", lacking, "axis")
    assert load_model(tmp_path / "found" / "model.toml").model.effects == ()


def test_it_is_reported_in_json_on_the_terminal_and_on_the_page(lacking):
    content = json.loads(diagnosis_json(lacking))
    assert content["refused"] == lacking.refused
    assert "moment_of_inertia" not in content["parameters"]
    assert content["gap"]["velocity"]["identify"] is None
    shown = diagnosis(lacking, "axis")
    assert "Not determined together with the missing effects: its interval" in shown.answers["Moment of inertia?"]
    (notes,) = (section for section in shown.sections if section.key == "notes")
    assert any("refused: moment of inertia, its interval" in item for item in notes.blocks[0].items)


def test_physics_of_the_catalogue_names_the_spring(recorded):
    rig, trace = recorded
    found = diagnose(trace, rig, excluded=EXCLUDED)
    assert (found.verdict, found.refused) == ("explained", {})
    assert found.effects[0].parameters["stiffness"].value == pytest.approx(STIFFNESS, rel=0.01)
    assert found.parameters["moment_of_inertia"].value == pytest.approx(RUBBING.axis.inertia, rel=0.01)


def test_where_what_is_missing_takes_the_inertia_of_the_bare_axis_there_is_no_model(recorded):
    """No step determines J: a remainder without a MuJoCo model."""
    rig, trace = recorded
    found = diagnosed(replace(Lacking.of(trace, rig, None), without_effects=True), frozenset(catalogue()))
    assert (found.verdict, found.effects, found.model) == ("unexplained_remainder", [], None)
    assert found.velocity.identify is None
    assert json.loads(diagnosis_json(found))["model"]["mjcf"] is None
    assert diagnosis(found, "axis").answers["Does it move like the axis now?"].startswith("Not known")


def test_an_inertia_below_the_rotors_is_refused_with_the_load(recorded):
    """A rig with the rotor of another motor, and a spring that is not to be tried; a baseline has the other numbers."""
    rig, trace = recorded
    other = rig.model_copy(update={"motor": rig.motor.model_copy(update={"rotor_inertia": 3.0 * RUBBING.axis.inertia})})
    found = diagnose(trace, other, excluded=frozenset(catalogue()))
    assert set(found.refused) == {"moment_of_inertia", "load_moment_of_inertia"}
    assert not set(found.refused) & set(found.parameters)
    assert found.verdict == "unexplained_remainder" and found.model is None
    state = observe(trace, other).state
    assert "moment_of_inertia" not in state.quantities and "coulomb_friction_torque" in state.quantities


def test_where_nothing_is_missing_the_recording_is_refused(recorded):
    """Its J is not determined, and no name is the reason."""
    rig, trace = recorded
    lacking = replace(Lacking.of(trace, rig, None), without_effects=True)
    with pytest.raises(UndeterminedError, match="moment of inertia cannot be determined: its interval"):
        diagnosed(lacking, policy=without("remains"))
