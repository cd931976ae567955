"""Nothing is explained while anything that is shown speaks against it."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.arrays import rms
from bench.diagnosis.diagnosis import diagnose
from bench.diagnosis.found import Gap, NamedEffect
from bench.diagnosis.name.policy import Policy
from bench.diagnosis.show.verdict import (
    OBJECTIONS,
    HoldoutApart,
    MovesWorse,
    NegativeFriction,
    Remains,
    Shown,
    Undetermined,
    Unfinished,
    verdict,
)
from bench.effects.catalogue import catalogue
from bench.errors import UndeterminedError
from bench.fit.parameter import Parameter
from bench.rig.rig import Rig
from bench.statistics import NORMAL95
from tests.diagnosis.constructed import COULOMB, RIG, bare, moved, offset, recorded
from tests.diagnosis.hand_made import level, made

NONE = frozenset(catalogue())
MOTION = moved(4.0)


def parameter(value, reach):
    return Parameter(value, "SI", reach / 1.96, (value - reach, value + reach))


def named(name, **quantities):
    return NamedEffect(catalogue()[name], {key: parameter(*found) for key, found in quantities.items()}, (), {})


def shown(*effects, velocity=None, torque=None, friction=(0.08, 0.001), seconds=4.0):
    """What a diagnosis shows, with what a test does not ask for as it is where all is well."""
    quiet = Gap("SI", 0.01, (0.1, 0.01), None)
    return SimpleNamespace(
        effects=list(effects),
        velocity=velocity or quiet,
        torque=torque or quiet,
        friction={"coulomb_friction_torque": (parameter(*friction), 1.0)},
        recordings=SimpleNamespace(trace=SimpleNamespace(time=np.linspace(0.0, seconds, 5))),
    )


SPRING = named("torsion_spring", stiffness=(0.1, 0.01))


@pytest.mark.parametrize(
    ("identify", "holdout", "said"),
    [
        ((0.50, 0.10), None, ""),
        ((0.50, 3.39), None, "recording is worse"),
        ((0.50, 0.10), (0.5, 0.6), "holdout is worse"),
        ((0.050, 0.055), None, ""),
        (None, None, ""),
    ],
)
def test_a_model_that_moves_worse_explains_nothing(identify, holdout, said):
    """Worse by more than noise makes of it: sqrt(0.05**2 + 0.027**2) = 0.0568."""
    against = MovesWorse().against(shown(SPRING, velocity=Gap("rad/s", 0.027, identify, holdout)))
    assert said in against
    assert bool(said) == bool(against)


@pytest.mark.parametrize(
    ("effect", "said"),
    [
        (SPRING, ""),
        (named("torsion_spring", stiffness=(0.1, 0.11)), "stiffness"),
        (named("load_torque_event", torque=(0.1, 0.01), start=(0.001, 0.05), end=(2.0, 0.05)), ""),
        (named("load_torque_event", torque=(0.1, 0.01), start=(0.17, 1.7e6), end=(2.0, 0.05)), "start"),
        (named("unbalance", amplitude=(0.1, 0.01), phase=(0.02, 0.3)), ""),
        (named("unbalance", amplitude=(0.1, 0.01), phase=(0.02, 3.5)), "phase"),
    ],
)
def test_a_quantity_that_is_not_determined_explains_nothing(effect, said):
    against = Undetermined().against(shown(effect))
    assert said in against
    assert bool(said) == bool(against)


def test_friction_that_is_not_determined_counts_where_its_torque_does():
    assert "not determined" in Undetermined().against(shown(SPRING, friction=(0.08, 0.09)))
    assert Undetermined().against(shown(SPRING, friction=(0.001, 0.002))) == ""
    assert Undetermined().against(shown(friction=(0.08, 0.09))) == ""


def test_what_is_minor_may_be_open():
    """How warming friction divides between viscous and dry is minor; how much it is, is not."""
    known, either = {"relative_amplitude": (0.3, 0.02), "time_constant": (2.0, 0.1)}, {"viscous_share": (0.4, 3.0)}
    assert Undetermined().against(shown(named("friction_warmup", **known, **either))) == ""
    for name, (value, _) in known.items():
        wide = known | either | {name: (value, 1.1 * value)}
        assert name.replace("_", " ") in Undetermined().against(shown(named("friction_warmup", **wide)))


def test_the_torque_of_friction_is_that_of_its_own_column():
    """Viscous friction times the RMS speed of the rows, Coulomb friction times one."""
    fitted = bare(recorded(MOTION))
    parameters = {
        "viscous_friction_coefficient": parameter(8e-4, 1e-5),
        "coulomb_friction_torque": parameter(0.08, 0.001),
    }
    added = SimpleNamespace(
        extension=SimpleNamespace(whole=SimpleNamespace(fitted=fitted)), refined=SimpleNamespace(parameters=parameters)
    )
    recordings = SimpleNamespace(rig=RIG)
    friction = Shown(recordings, None, added, None, None).friction  # pyright: ignore[reportArgumentType]
    speed = rms(fitted.rows.values(lambda signals: signals.velocity))
    for name, torque in (("viscous_friction_coefficient", speed), ("coulomb_friction_torque", 1.0)):
        assert friction[name][0] is parameters[name]
        assert friction[name][1] == pytest.approx(torque, rel=5e-3)
    assert speed > 10.0


def test_friction_resists():
    assert "is negative" in NegativeFriction().against(shown(friction=(-0.002, 0.001)))
    assert "is negative" in NegativeFriction().against(shown(friction=(-0.02, 0.03)))
    assert NegativeFriction().against(shown(friction=(-0.002, 0.003))) == ""


@pytest.mark.parametrize(
    ("stopped", "withheld", "said"),
    [
        (None, False, ""),
        (None, True, "an effect that was not to be tried"),
        ("limit", False, "limit"),
        ("limit", True, "limit"),
    ],
)
def test_a_search_that_was_cut_or_kept_from_a_name_explains_nothing(stopped, withheld, said):
    suspects = SimpleNamespace(searched=SimpleNamespace(stopped=stopped), withheld=withheld)
    assert Unfinished().against(SimpleNamespace(suspects=suspects)) == said


@pytest.mark.parametrize(("chi", "said"), [(1.11, ""), (1.13, "the torque gap is 1.13 times what noise leaves")])
def test_twelve_hundredths_above_the_floor_remain(chi, said):
    suspects = SimpleNamespace(policy=Policy())
    assert Remains().against(SimpleNamespace(suspects=suspects, whole=made(level(100.0 * chi**2)))) == said


def test_a_holdout_at_three_times_what_is_left_here_stands_apart():
    near, far = (Gap("N*m", 0.01, (0.1, 0.008), (0.1, after)) for after in (0.029, 0.031))
    assert HoldoutApart().against(shown(torque=near)) == ""
    assert "stands apart" in HoldoutApart().against(shown(torque=far))


def test_a_holdout_with_half_as_much_friction_again_is_no_proof_that_nothing_is_missing():
    more = recorded(MOTION, lambda motion: 0.49 * COULOMB * motion.sign, seed=1)
    same = diagnose(recorded(MOTION), RIG, recorded(MOTION, seed=1), excluded=NONE)
    assert (same.verdict, same.because) == ("nothing_missing", [])
    other = diagnose(recorded(MOTION), RIG, more, excluded=NONE)
    assert other.verdict == "unexplained_remainder"
    assert any("holdout stands apart" in said for said in other.because)


def test_friction_that_drives_is_reported():
    found = diagnose(recorded(MOTION, lambda motion: -1.5 * COULOMB * motion.sign), RIG, excluded=NONE)
    assert found.verdict == "unexplained_remainder"
    assert any("coulomb friction torque" in said and "negative" in said for said in found.because)


def test_each_objection_turns_the_verdict(monkeypatch):
    """With all is well but one, that one alone is said; without it the model explains."""
    for objection in OBJECTIONS:
        for other in OBJECTIONS:
            said = "no" if other is objection else ""
            monkeypatch.setattr(type(other), "against", lambda self, shown, said=said: said)
        assert verdict(shown(SPRING)) == ("unexplained_remainder", ["no"])
    for other in OBJECTIONS:
        monkeypatch.setattr(type(other), "against", lambda self, shown: "")
    assert verdict(shown(SPRING)) == ("explained", [])
    assert verdict(shown()) == ("nothing_missing", [])


def test_an_inertia_below_the_rotor_s_is_refused():
    """A current in the wrong unit: what moves is a thousandth of the rotor alone."""
    trace = recorded(MOTION)
    weak = trace.with_signals({"current": 1e-3 * trace["current"]}, {"current": "A"})
    with pytest.raises(UndeterminedError, match="load moment of inertia"):
        diagnose(weak, RIG, excluded=NONE)


def test_the_rig_s_tolerances_are_in_every_interval():
    """M = kT*I: inertia, friction and an offset are proportional to kT, so 5 % of one is 5 % of the others."""
    trace, motor = recorded(MOTION, offset(0.05)), {"rotor_inertia": "4 kg*cm**2", "peak_current": "6 A"}
    only = NONE - {"torque_offset"}
    sharp, wide = (
        diagnose(
            trace, Rig.of({"name": "t", "kind": "rotary", "motor": motor | {"torque_constant": text}}), excluded=only
        )
        for text in ("0.7 N*m/A", "0.7 +/- 0.035 N*m/A")
    )
    told = [[found.parameters["moment_of_inertia"], found.effects[0].parameters["torque"]] for found in (sharp, wide)]
    for own, found in zip(*told, strict=True):
        assert found.value == own.value
        half, before = found.ci95[1] - found.value, own.ci95[1] - own.value
        assert half == pytest.approx(np.hypot(before, 0.05 * found.value), rel=1e-3)
        assert found.std_error == pytest.approx(np.hypot(own.std_error, 0.05 / NORMAL95 * found.value), rel=1e-3)
