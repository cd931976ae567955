"""Nothing is explained while anything that is shown speaks against it."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.arrays import NORMAL95, rms
from bench.diagnosis.diagnosis import (
    OBJECTIONS,
    Gap,
    Shown,
    depends,
    diagnose,
    holdout_apart,
    likelier,
    moves_otherwise,
    moves_worse,
    negative_friction,
    out_of_phase,
    refused,
    remains,
    undetermined,
    unfinished,
    verdict,
)
from bench.diagnosis.name import NamedEffect
from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import NameSet, Probabilities
from bench.effects.catalogue import catalogue
from bench.errors import UndeterminedError
from bench.fit.dependence import Dependence
from bench.parameter import Parameter
from bench.rig.rig import Rig
from tests.diagnosis.constructed import COULOMB, RIG, bare, moved, offset, recorded

NONE = frozenset(catalogue())
MOTION = moved(4.0)


def parameter(value, reach):
    return Parameter(value, "SI", reach / 1.96, (value - reach, value + reach))


def named(name, **quantities):
    return NamedEffect(catalogue()[name], {key: parameter(*found) for key, found in quantities.items()}, (), {})


def shown(
    *effects,
    velocity=None,
    torque=None,
    friction=(0.08, 0.001),
    seconds=4.0,
    chi=1.0,
    stopped=None,
    withheld=False,
    in_phase=True,
    refused=None,
    unknown=0.1,
    on=None,
):
    """What a diagnosis shows, with what a test does not ask for as it is where all is well."""
    quiet = Gap("SI", 0.01, (0.1, 0.01), None)
    searched = SimpleNamespace(stopped=stopped)
    return SimpleNamespace(
        effects=list(effects),
        velocity=velocity or quiet,
        torque=torque or quiet,
        friction={"coulomb_friction_torque": (parameter(*friction), 1.0)},
        whole=SimpleNamespace(chi=chi, depends=on),
        likely=Probabilities((NameSet(frozenset(), 1.0 - unknown),), unknown),
        added=SimpleNamespace(
            recordings=SimpleNamespace(trace=SimpleNamespace(time=np.linspace(0.0, seconds, 5))),
            suspects=SimpleNamespace(policy=Policy(), searched=searched, withheld=withheld),
            refused=refused or {},
            recorded=[SimpleNamespace(name="recording"), SimpleNamespace(name="holdout")],
            extension=None,
            gaps=SimpleNamespace(in_phase=lambda stage, recorded: in_phase),
        ),
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
    against = moves_worse(shown(SPRING, velocity=Gap("rad/s", 0.027, identify, holdout)))
    assert said in against
    assert bool(said) == bool(against)


@pytest.mark.parametrize(("after", "said"), [(0.70, ""), (0.72, "recording is worse"), (3.39, "recording is worse")])
def test_a_model_whose_waves_lost_their_phase_is_judged_by_a_speed_whose_squares_double(after, said):
    """At wrong instants they err twice, where they are and where they are not: sqrt(2*(0.5**2 + 0.027**2)) = 0.708."""
    worse = shown(SPRING, velocity=Gap("rad/s", 0.027, (0.50, after), None), in_phase=False)
    assert said in moves_worse(worse)
    assert (bool(moves_worse(worse)), out_of_phase(worse.added) != []) == (bool(said), True)


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
    against = undetermined(shown(effect))
    assert said in against
    assert bool(said) == bool(against)


def test_friction_that_is_not_determined_counts_where_its_torque_does():
    assert "not determined" in undetermined(shown(SPRING, friction=(0.08, 0.09)))
    assert undetermined(shown(SPRING, friction=(0.001, 0.002))) == ""
    assert undetermined(shown(friction=(0.08, 0.09))) == ""


def test_what_is_minor_may_be_open():
    """How warming friction divides between viscous and dry is minor; how much it is, is not."""
    known, either = {"relative_amplitude": (0.3, 0.02), "time_constant": (2.0, 0.1)}, {"viscous_share": (0.4, 3.0)}
    assert undetermined(shown(named("friction_warmup", **known, **either))) == ""
    for name, (value, _) in known.items():
        wide = known | either | {name: (value, 1.1 * value)}
        assert name.replace("_", " ") in undetermined(shown(named("friction_warmup", **wide)))


def test_the_torque_of_friction_is_that_of_its_own_column():
    """Viscous friction times the RMS speed of the rows, Coulomb friction times one."""
    fitted = bare(recorded(MOTION))
    parameters = {
        "viscous_friction_coefficient": parameter(8e-4, 1e-5),
        "coulomb_friction_torque": parameter(0.08, 0.001),
    }
    added = SimpleNamespace(
        recordings=SimpleNamespace(rig=RIG),
        extension=SimpleNamespace(fitted=fitted),
        refined=SimpleNamespace(parameters=parameters),
    )
    friction = Shown(added, None, None, None).friction  # pyright: ignore[reportArgumentType]
    speed = rms(fitted.rows.values(lambda signals: signals.velocity))
    for name, torque in (("viscous_friction_coefficient", speed), ("coulomb_friction_torque", 1.0)):
        assert friction[name][0] is parameters[name]
        assert friction[name][1] == pytest.approx(torque, rel=5e-3)
    assert speed > 10.0


def test_friction_resists():
    assert "is negative" in negative_friction(shown(friction=(-0.002, 0.001)))
    assert "is negative" in negative_friction(shown(friction=(-0.02, 0.03)))
    assert negative_friction(shown(friction=(-0.002, 0.003))) == ""


@pytest.mark.parametrize(
    ("stopped", "withheld", "said"),
    [
        (None, False, ""),
        (None, True, "an excluded effect was found"),
        ("limit", False, "limit"),
        ("limit", True, "limit"),
    ],
)
def test_a_search_that_was_cut_or_kept_from_a_name_explains_nothing(stopped, withheld, said):
    assert unfinished(shown(stopped=stopped, withheld=withheld)) == said


@pytest.mark.parametrize(("chi", "said"), [(1.11, ""), (1.13, "the torque residual is 1.13 times the noise")])
def test_twelve_hundredths_above_the_floor_remain(chi, said):
    assert remains(shown(chi=chi)) == said


def test_a_holdout_residual_of_three_times_that_of_the_recording_is_an_objection():
    near, far = (Gap("N*m", 0.01, (0.1, 0.008), (0.1, after)) for after in (0.029, 0.031))
    assert holdout_apart(shown(torque=near)) == ""
    assert "residual of the holdout is 0.031" in holdout_apart(shown(torque=far))


def test_a_holdout_with_half_as_much_friction_again_is_no_proof_that_nothing_is_missing():
    more = recorded(MOTION, lambda motion: 0.49 * COULOMB * motion.sign, seed=1)
    same = diagnose(recorded(MOTION), RIG, recorded(MOTION, seed=1), excluded=NONE)
    assert (same.verdict, same.because) == ("nothing_missing", [])
    other = diagnose(recorded(MOTION), RIG, more, excluded=NONE)
    assert other.verdict == "unexplained_remainder"
    assert any("residual of the holdout" in said for said in other.because)


def test_friction_that_drives_is_reported():
    found = diagnose(recorded(MOTION, lambda motion: -1.5 * COULOMB * motion.sign), RIG, excluded=NONE)
    assert found.verdict == "unexplained_remainder"
    assert any("Coulomb friction torque" in said and "negative" in said for said in found.because)


def test_no_missing_effect_needs_the_speed_gap_within_its_limit():
    assert moves_otherwise(shown(velocity=Gap("rad/s", 0.01, (0.03, 0.03), limit=0.035))) == ""
    assert "4 times the noise" in moves_otherwise(shown(velocity=Gap("rad/s", 0.01, (0.04, 0.04), limit=0.035)))
    assert moves_otherwise(shown(velocity=Gap("rad/s", 0.01, None, limit=0.035))) == ""


def test_no_missing_effect_needs_nothing_to_be_the_likeliest_answer():
    assert likelier(shown(unknown=0.49)) == ""
    assert "unknown effect is more likely (60 %) than no missing effect (40 %)" in likelier(shown(unknown=0.6))


AGAINST = {
    remains: shown(SPRING, chi=1.2),
    depends: shown(SPRING, on=Dependence("torque", {})),
    moves_otherwise: shown(velocity=Gap("rad/s", 0.01, (0.1, 0.1), limit=0.035)),
    likelier: shown(unknown=0.6),
    unfinished: shown(SPRING, stopped="limit of effects reached"),
    moves_worse: shown(SPRING, velocity=Gap("rad/s", 0.01, (0.1, 0.2), None)),
    undetermined: shown(named("torsion_spring", stiffness=(0.1, 0.11))),
    negative_friction: shown(SPRING, friction=(-0.08, 0.001)),
    refused: shown(SPRING, refused={"moment_of_inertia": "its interval contains zero"}),
    holdout_apart: shown(SPRING, torque=Gap("N*m", 0.01, (0.1, 0.008), (0.1, 0.04))),
}


def test_one_objection_alone_turns_the_verdict():
    assert set(AGAINST) == set(OBJECTIONS)
    for objection, found in AGAINST.items():
        assert verdict(found) == ("unexplained_remainder", [objection(found)])
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
    pairs = [[found.parameters["moment_of_inertia"], found.effects[0].parameters["torque"]] for found in (sharp, wide)]
    for own, found in zip(*pairs, strict=True):
        assert found.value == own.value
        half, before = found.ci95[1] - found.value, own.ci95[1] - own.value
        assert half == pytest.approx(np.hypot(before, 0.05 * found.value), rel=1e-3)
        assert found.std_error == pytest.approx(np.hypot(own.std_error, 0.05 / NORMAL95 * found.value), rel=1e-3)
