import pickle

import pytest

from bench.axis_kind import COULOMB, INERTIA, KINDS, LINEAR, MISALIGNMENT, OFFSET, ROTARY, VISCOUS, axis_kind
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.trace.signals import unit_on
from bench.units import Quantity, dimensionality, same_dimension


def test_an_axis_kind_is_found_by_its_name_and_stays_itself_between_processes():
    assert [axis_kind(kind.name, "rig.toml") for kind in (ROTARY, LINEAR)] == [ROTARY, LINEAR]
    for kind in KINDS:
        again = pickle.loads(pickle.dumps(kind))
        assert (again, hash(again)) == (kind, hash(kind))


@pytest.mark.parametrize("name", ["Rotary", "", None, 1, ["linear"], {}])
def test_another_name_is_the_callers_error(name):
    with pytest.raises(InputError, match=r"rig\.toml: kind: found .*; allowed: rotary, linear"):
        axis_kind(name, "rig.toml: kind")


def test_names_are_those_of_the_public_formats():
    terms = (INERTIA, VISCOUS, COULOMB, OFFSET)
    assert [ROTARY.parameter(term) for term in terms] == [
        "moment_of_inertia",
        "viscous_friction_coefficient",
        "coulomb_friction_torque",
        "torque_offset",
    ]
    assert [LINEAR.parameter(term) for term in terms] == [
        "moving_mass",
        "viscous_friction_coefficient",
        "coulomb_friction_force",
        "force_offset",
    ]
    assert ROTARY.in_words(INERTIA) == "moment of inertia"


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
@pytest.mark.parametrize("effort", [None, "A", "V", "dimensionless"])
def test_every_term_of_the_equation_of_motion_has_the_dimension_of_the_effort(kind, effort):
    given = effort or kind.effort_unit
    factors = {
        INERTIA: kind.acceleration_unit,
        VISCOUS: kind.speed_unit,
        COULOMB: "dimensionless",
        OFFSET: "dimensionless",
        MISALIGNMENT: f"({given})/s",
    }
    for term, factor in factors.items():
        assert same_dimension(f"({kind.parameter_unit(term, effort)})*({factor})", given), term


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_units_agree_with_those_of_recorded_signals(kind):
    assert kind.length_unit == unit_on(kind, "position")
    assert kind.speed_unit == unit_on(kind, "velocity")
    assert kind.acceleration_unit == unit_on(kind, "acceleration")
    assert kind.effort_unit == unit_on(kind, kind.effort)


@pytest.mark.parametrize(
    ("rotary", "linear"),
    [
        ("N*m", "N"),
        ("N*m*s/rad", "N*s/m"),
        ("N*m*s**2/rad**2", "N*s**2/m**2"),
        ("V*s/rad", "V*s/m"),
        ("kg*m**2", "kg"),
        ("1/rad", "1/m"),
        ("s", "s"),
        ("dimensionless", "dimensionless"),
    ],
)
def test_units_are_translated_to_metres_and_newtons(rotary, linear):
    assert LINEAR.translated(rotary) == linear
    assert ROTARY.translated(rotary) == rotary


def test_what_stays_an_angle_or_has_a_unit_of_its_own_says_so():
    assert LINEAR.unit(Quantity("phase", "phi", "rad", angle=True)) == "rad"
    assert LINEAR.unit(Quantity("gap", "g", "rad")) == "m"
    harmonic = Quantity("harmonic", "n", "dimensionless", linear_unit="rad/m")
    assert (ROTARY.unit(harmonic), LINEAR.unit(harmonic)) == ("dimensionless", "rad/m")
    assert LINEAR.unit(Quantity("amplitude", "A", "N*m"), "A") == "A"


def test_harmonics_times_position_and_phases_are_angles_on_every_axis():
    quantities = [quantity for effect in catalogue().values() for quantity in effect.quantities]
    harmonics = [quantity for quantity in quantities if quantity.name == "harmonic"]
    phases = [quantity for quantity in quantities if quantity.name == "phase"]
    assert harmonics and phases
    for kind in KINDS:
        for harmonic in harmonics:
            product = f"({kind.unit(harmonic)})*({kind.length_unit})"
            assert dimensionality(product) == dimensionality("rad")
        assert {kind.unit(phase) for phase in phases} == {"rad"}
