"""What symmetry, dimensions and order ask of a diagnosis, under axes, motions, sensors and effects that are drawn."""

import re
import tomllib
from dataclasses import dataclass, replace

import numpy as np
import pint
import pytest

from bench.diagnosis.diagnosis import diagnose
from bench.rig.rig import Rig
from bench.trace.read import read
from bench.trace.trace import Trace
from bench.trace.write import write
from bench.validation.independent.effects import KINDS
from bench.validation.independent.references import random_motion
from bench.validation.independent.rig import random_rig, rig_text
from bench.validation.independent.sensors import Noise, random_sensors
from bench.validation.independent.simulate import simulate
from tests.kept import kept

OFTEN = (
    *("cogging_torque", "torque_offset", "stribeck_friction"),
    *("unbalance", "current_gain_asymmetry", "quadratic_drag"),
)
SELDOM = (
    *("torque_ripple", "load_torque_event", "torque_constant_saturation", "direction_dependent_friction"),
    *("elastic_coupling", "position_dependent_friction", "position_dependent_inertia", "torsion_spring"),
    *("current_loop_lag", "velocity_filter_lag", "encoder_eccentricity", "presliding_friction"),
    *("load_dependent_friction", "current_offset_drift"),
)
NAMES = [*OFTEN, *(pytest.param(name, marks=pytest.mark.slow) for name in SELDOM)]
#: What is recorded twice.
TWICE = ("cogging_torque", "elastic_coupling")
#: Quantities that point one way, and turn with a mirror.
POINTING = {("torque_offset", "torque"), ("load_torque_event", "torque"), ("current_gain_asymmetry", "gain_difference"),
            ("current_offset_drift", "rate")}  # fmt: skip
#: Waves of what is the same forwards and backwards: of a friction, an inertia, a torque constant.
OF_A_SIZE = {"torque_ripple", "position_dependent_friction", "position_dependent_inertia"}
#: Of a recording - s; the integrator's longest step - s -, which needs no truth here, only an axis.
SECONDS, STEP = 4.0, 250e-6
REGISTRY = pint.UnitRegistry()


@dataclass(frozen=True)
class Recorded:
    """A rig's table and recordings of its axis."""

    table: dict
    traces: list[Trace]

    @property
    def rig(self):
        return Rig.of(self.table, "drawn")


@pytest.fixture(scope="module")
def recordings():
    """By what is hidden."""

    def recorded():
        names, tables, cases = [], {}, []
        for seed, name in enumerate((*OFTEN, *SELDOM)):
            rng = np.random.default_rng(seed)
            axis = replace(random_rig(rng, name), control_period=250e-6)
            drawn = random_sensors(axis, rng)
            # the filter has 2 ms at most, so that a slower clock is the same only where noise is white
            sensors = replace(drawn, velocity=Noise(drawn.velocity.white), current=Noise(drawn.current.white))
            effects = (KINDS[name].draw(axis, 0.5, rng, SECONDS),)
            for _ in range(2 if name in TWICE else 1):
                cases.append((axis, random_motion(axis, rng, SECONDS), effects, sensors))
                names.append(name)
            tables[name] = tomllib.loads(rig_text(axis))
        runs = simulate(*zip(*cases, strict=True), seed=4, longest_step=STEP)
        return names, tables, [run.trace for run in runs]

    names, tables, traces = kept(recorded, __file__)
    of = {name: [trace for whose, trace in zip(names, traces, strict=True) if whose == name] for name in tables}
    return {name: Recorded(tables[name], of[name]) for name in tables}


@pytest.fixture(scope="module")
def found(recordings):
    """Diagnosis of the first recording, by what is hidden."""
    made = {}

    def diagnosed(name):
        if name not in made:
            made[name] = diagnose(recordings[name].traces[0], recordings[name].rig)
            assert made[name].verdict == "explained" and len(made[name].effects) == 1
        return made[name]

    return diagnosed


def assert_alike(there, here, turned, sigmas, rel):
    """The same names, and of each quantity the value that `turned` makes of it, and its error times a factor."""
    assert [effect.name for effect in here.effects] == [effect.name for effect in there.effects]
    assert (here.verdict, here.stopped) == (there.verdict, there.stopped)
    both = zip(there.effects, here.effects, strict=True)
    pairs = [(effect.name, effect.parameters, other.parameters) for effect, other in both]
    for effect, expected, found in [*pairs, ("axis", there.parameters, here.parameters)]:
        assert expected.keys() == found.keys()
        for name, parameter in expected.items():
            value, factor = turned(effect, name, parameter)
            off = found[name].value - value
            if name == "phase":
                off = np.angle(np.exp(1j * off))
            print(f"{effect} {name}: {off / max(factor * parameter.std_error, 1e-300):.2g} standard errors off")
            assert abs(off) <= sigmas * factor * parameter.std_error + 1e-9 * abs(value), (effect, name)
            assert found[name].std_error == pytest.approx(factor * parameter.std_error, rel=rel), (effect, name)


def within(diagnosis, rel):
    """How near errors come; those of what noise biases are by noise that is drawn, and have any order."""
    return 1.0 if any(effect.effect.filters_motion for effect in diagnosis.effects) else rel


def mirrored(effect, name, parameter):
    value = parameter.value
    if (effect, name) in POINTING:
        return -value, 1.0
    if name == "phase":
        return (np.pi - value if effect in OF_A_SIZE else -value), 1.0
    return value, 1.0


@pytest.mark.parametrize("name", NAMES)
def test_a_mirrored_recording_names_the_mirrored_same(recordings, found, name):
    one = recordings[name]
    trace = one.traces[0]
    backwards = {name: -values for name, values in trace.signals.items()}
    here = diagnose(Trace(trace.time, backwards, trace.units, "mirrored"), one.rig)
    assert_alike(found(name), here, mirrored, 0.25, within(here, 2e-2))


def in_units(one, scales):
    """Rig and first recording where the base units are others: what a number of each dimension is multiplied with."""
    trace = one.traces[0]
    signals = {name: values * factor(trace.units[name], scales) for name, values in trace.signals.items()}
    rig = Rig.of(scaled(one.table, scales), "scaled")
    return rig, Trace(trace.time * factor("s", scales), signals, trace.units, "scaled")


def factor(unit, scales):
    powers = REGISTRY.Unit(unit).dimensionality
    return float(np.prod([scales.get(dimension, 1.0) ** power for dimension, power in powers.items()]))


def scaled(table, scales):
    """A rig's table with every value scaled."""
    if isinstance(table, dict):
        return {key: scaled(value, scales) for key, value in table.items()}
    match = re.fullmatch(r"([\d.e+-]+) (.+)", table)
    return table if match is None else f"{float(match[1]) * factor(match[2], scales)!r} {match[2]}"


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("scales", "sigmas", "rel"),
    [
        # an axis heavier in everything, and current counted otherwise: inertia and torque by the mass, their ratio not
        ({"[mass]": 1.7, "[current]": 0.3}, 0.01, 1e-3),
        # a slower clock: inertia by its square, viscous friction by itself; the filter is one of a few that are tried
        ({"[time]": 1.4, "[mass]": 1.4**2}, 2.5, 1.0),
    ],
    ids=["mass and current", "time"],
)
def test_other_base_units_give_the_same_axis_in_them(recordings, found, name, scales, sigmas, rel):
    rig, trace = in_units(recordings[name], scales)

    def turned(effect, name, parameter):
        times = factor(parameter.unit, scales)
        return times * parameter.value, times

    assert_alike(found(name), diagnose(trace, rig), turned, sigmas, rel)


def unchanged(effect, name, parameter):
    return parameter.value, 1.0


@pytest.mark.parametrize("name", [TWICE[0], pytest.param(TWICE[1], marks=pytest.mark.slow)])
def test_the_order_of_recordings_does_not_matter(recordings, name):
    one = recordings[name]
    there, back = diagnose(one.traces, one.rig), diagnose(one.traces[::-1], one.rig)
    assert there.effects
    assert_alike(there, back, unchanged, 0.01, within(back, 0.1))  # blocks of the covariance end elsewhere


@pytest.mark.parametrize("name", NAMES[:2])
def test_the_order_of_columns_does_not_matter(recordings, found, name, tmp_path):
    """To the last bit, and a file is what was recorded."""
    one = recordings[name]
    write(one.traces[0], tmp_path / "run.csv")
    head, *rows = [line.split(",") for line in (tmp_path / "run.csv").read_text().splitlines()]
    order = np.random.default_rng(0).permutation(len(head))
    text = "\n".join(",".join(cells[k] for k in order) for cells in (head, *rows))
    (tmp_path / "permuted.csv").write_text(text + "\n")
    here = diagnose(read(tmp_path / "permuted.csv"), one.rig)
    assert list(order) != sorted(order)
    assert_alike(found(name), here, unchanged, 0.0, 0.0)


def test_more_noise_widens_the_intervals_of_what_errs(recordings, found):
    """Where the tick within which signals are taken tells an error too, it comes beside what noise makes of it."""
    name = "encoder_eccentricity"
    one, rng = recordings[name], np.random.default_rng(0)
    trace = one.traces[0]
    noise = {"position": 2e-5, "velocity": 0.1, "current": 0.05}
    loud = {key: values + noise.get(key, 0.0) * rng.normal(size=values.size) for key, values in trace.signals.items()}
    there, here = found(name), diagnose(Trace(trace.time, loud, trace.units, "loud"), one.rig)
    assert [effect.name for effect in here.effects] == [effect.name for effect in there.effects] == [name]
    for quantity, parameter in there.effects[0].parameters.items():
        ratio = here.effects[0].parameters[quantity].std_error / parameter.std_error
        print(f"{name} {quantity}: {ratio:.2f} times as wide")
        assert ratio > 1.2, quantity


#: What no revolution counts for, so that it is the same behind a gear.
WITHOUT_A_TURN = [
    *("torque_offset", "stribeck_friction", "quadratic_drag"),
    *(
        pytest.param(name, marks=pytest.mark.slow)
        for name in (
            "presliding_friction",
            "elastic_coupling",
            "current_loop_lag",
            "torsion_spring",
            "load_torque_event",
        )
    ),
]
#: Powers of the gear's ratio by which values of a rig are larger on its output; all others have none.
BEHIND_A_GEAR = {
    **dict.fromkeys(("torque_constant", "back_emf_constant"), 1),
    **dict.fromkeys(("rotor_inertia", "velocity_gain", "integral_gain", "inertia_feedforward"), 2),
}


def times(text, number):
    """A value of a rig's table, which has a unit, times a number."""
    value, unit = text.split(" ", 1)
    return f"{float(value) * number!r} {unit}"


@pytest.mark.parametrize("name", WITHOUT_A_TURN)
@pytest.mark.parametrize("ratio", [100.0, 0.1])
def test_a_joint_behind_a_gear_has_the_same_names(recordings, found, name, ratio):
    """Its speeds are a hundredth, its torque a hundredfold: of what the motor has, as the joint's own numbers."""
    one = recordings[name]
    trace, table = one.traces[0], {**one.table}
    for part in ("motor", "drive"):
        table[part] = {key: times(text, ratio ** BEHIND_A_GEAR[key]) if key in BEHIND_A_GEAR else text
                       for key, text in table[part].items()}  # fmt: skip
    signals = {key: values / (ratio if "rad" in trace.units[key] else 1.0) for key, values in trace.signals.items()}
    here = diagnose(Trace(trace.time, signals, trace.units, "behind a gear"), Rig.of(table, "geared"))
    there = found(name)
    assert ([effect.name for effect in here.effects], here.verdict) == ([name], there.verdict)
    inertia = "moment_of_inertia"
    expected = ratio**2 * there.parameters[inertia].value
    assert here.parameters[inertia].value == pytest.approx(expected, rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "slower"),
    [
        *(("stribeck_friction", 10.0), ("presliding_friction", 10.0), ("elastic_coupling", 10.0)),
        # no lag ten times as long: the filter stays, so that noise of the motion is louder and biases a lag
        *(
            ("stribeck_friction", 0.1),
            ("presliding_friction", 0.1),
            ("elastic_coupling", 0.1),
            ("current_loop_lag", 0.1),
        ),
    ],
)
def test_an_axis_ten_times_as_slow_or_fast_has_the_same_names(recordings, name, slower):
    """A gantry and a stage; of its numbers the test above reports, for a clock that changes less."""
    rig, trace = in_units(recordings[name], {"[time]": slower, "[mass]": slower**2})
    assert [effect.name for effect in diagnose(trace, rig).effects] == [name]
