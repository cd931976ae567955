"""Units as recorders, drives and datasheets spell them, each with the factor that its closed form gives."""

import math
import typing
from pathlib import Path

import pytest
from pydantic import TypeAdapter

from bench.axis_kind import ROTARY
from bench.errors import InputError
from bench.rig import values
from bench.rig.rig import Rig
from bench.trace.read import read
from bench.units import parse
from bench.units.conversion import scale_of
from bench.units.grammar import UnitError

KNOWN = {"pi": math.pi, "sqrt": math.sqrt, "inch": 0.0254, "ft": 0.3048, "lb": 0.45359237, "oz": 0.45359237 / 16}
KNOWN |= {"g0": 9.80665, "__builtins__": {}}
#: SI unit, factor, spellings of a line.
ROWS = [
    [cell.strip() for cell in line.split("|")]
    for line in Path(__file__).with_name("spellings.txt").read_text(encoding="utf-8").splitlines()
    if "|" in line and not line.startswith("#")
]
#: Quantities of one column, of which a recording has either.
EITHER = [("rad/s", "m/s"), ("rad", "m"), ("rad/s**2", "m/s**2"), ("N*m", "dimensionless")]


@pytest.mark.parametrize(("si", "factor", "spellings"), [(si, of, rest) for si, of, *rest in ROWS])
def test_a_spelling_has_the_factor_of_its_closed_form(si, factor, spellings):
    """Where its quantity alone is allowed, and where the other one of its column is, too."""
    for allowed in ((si,), *(pair for pair in EITHER if si in pair)):
        for spelling in spellings:
            if factor == "refused":
                with pytest.raises(UnitError) as refused:
                    scale_of(spelling, allowed)
                assert refused.value.allowed.startswith("allowed: ")
            else:
                found = scale_of(spelling, allowed)
                assert (found.unit, found.factor) == (si, pytest.approx(eval(factor, KNOWN), rel=1e-12)), spelling


def test_the_table_is_large_and_names_no_spelling_twice():
    every = [(si, spelling) for si, _, *spellings in ROWS for spelling in spellings]
    assert len(set(every)) == len(every) >= 600


RPM = 2.0 * math.pi / 60.0
#: One value in several spellings of a speed, by the SI unit of the quantity.
SPEEDS = {
    "rad/s": ("3 1/min", "3 min⁻¹", "3 rpm", "3 U/min", "0.003 krpm", "3 rev/min", f"{3 * RPM!r} rad/s"),
    "V*s/rad": ("3 V/(1/min)", "3 V*min", "3000 mV/min⁻¹", "3 V/rpm", "3000 V/(1000 1/min)", f"{3 / RPM!r} V*s/rad"),
    "N*m*s/rad": ("3 N*m/(1/min)", "3 N*m*min", "3 Nm/min⁻¹", "3 Nm/rpm", "3 Nm*min/rev", f"{3 / RPM!r} N*m*s/rad"),
    "kg*m**2": ("3 N*m/(1/min/s)", "3 N*m*min*s", "3 Nm/(rpm/s)", "0.05 N*m/(rpm/min)", f"{3 / RPM!r} kg*m**2"),
    "N*m/A": ("3 V/(1/min)", "3 V*min", "3000 mV/min⁻¹", "3 V/rpm", f"{3 / RPM!r} N*m/A"),
    "N*m": ("3 W/(1/min)", "3 W*min", "3 W/rpm", f"{3 / RPM!r} N*m"),
}
ALIASES = {
    "Speed": "rad/s",
    "VelocityNoise": "rad/s",
    "BackEmf": "V*s/rad",
    "Viscous": "N*m*s/rad",
    "Inertia": "kg*m**2",
    "Feedforward": "kg*m**2",
    "TorquePerAmpere": "N*m/A",
    "Torque": "N*m",
    "Coulomb": "N*m",
}


def keys_of(model, place=""):
    """Every key of a rig whose value may be spelled with a speed, with the name of its type."""
    for name, annotation in typing.get_type_hints(model, include_extras=True).items():
        for part in typing.get_args(annotation) or (annotation,):
            if isinstance(part, type) and issubclass(part, values.RigTable):
                yield from keys_of(part, f"{place}{name}.")
            yield from ((f"{place}{name}", alias) for alias in ALIASES if part is getattr(values, alias))
        yield from ((f"{place}{name}", alias) for alias in ALIASES if annotation is getattr(values, alias))


KEYS = [(key, alias) for key, alias in keys_of(Rig) if alias in ALIASES]


def test_the_keys_of_a_rig_with_a_speed_are_found():
    found = {key for key, _ in KEYS}
    assert {"motor.back_emf_constant", "drive.velocity_gain", "simulation.viscous_friction_coefficient"} <= found


@pytest.mark.parametrize(("key", "alias"), KEYS, ids=[key for key, _ in KEYS])
def test_a_speed_in_a_key_of_a_rig_is_the_same_in_every_spelling(key, alias):
    adapter, context = TypeAdapter(getattr(values, alias)), {"kind": ROTARY}
    found = [adapter.validate_python(text, context=context) for text in SPEEDS[ALIASES[alias]]]
    assert found == pytest.approx([found[-1]] * len(found), rel=1e-12)


@pytest.mark.parametrize("text", ["3 MA", "800 MNm", "5 MV", "2 Mm"])
def test_millions_in_a_rig_are_refused(text):
    si = {"A": "A", "m": "N*m", "V": "V"}[text[-1]] if text != "2 Mm" else "m"
    with pytest.raises(InputError, match="a leading m means thousandths"):
        parse(text, si, "rig.toml: key")


@pytest.mark.parametrize(("unit", "signal", "si"), [("MA", "current", "A"), ("MNm", "torque", "N*m")])
def test_millions_in_a_column_are_thousandths_with_a_note(tmp_path, unit, signal, si):
    path = tmp_path / "log.csv"
    rows = "\n".join(f"{k * 1e-3:.3f},{math.sin(k):.6f},{1000 + k}" for k in range(50))
    path.write_text(f"time [s],velocity [rad/s],{signal} [{unit}]\n{rows}\n")
    trace = read(path)
    assert trace.signals[signal][:2] == pytest.approx([1.0, 1.001])
    assert any(f"{unit} taken as m{unit[1:]}" in note for note in trace.notes)
    assert trace.units[signal] == si
