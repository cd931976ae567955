"""Nothing is explained while anything that is shown speaks against it."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.arrays import rms
from bench.axis_kind import COULOMB as DRY
from bench.axis_kind import VISCOUS
from bench.diagnosis.diagnosis import diagnose, out_of_phase
from bench.diagnosis.name import NamedEffect
from bench.diagnosis.policy import Policy
from bench.diagnosis.probability import Probabilities
from bench.diagnosis.verdict import Gap, frictions, verdict
from bench.effects.catalogue import catalogue
from bench.fit.dependence import Dependence
from bench.parameter import Parameter
from bench.report.verdict import reason, reasons
from tests.diagnosis.constructed import COULOMB, RIG, bare, moved, recorded

NONE = frozenset(catalogue())
MOTION = moved(4.0)


def parameter(value, reach):
    return Parameter(value, "SI", reach / 1.96, (value - reach, value + reach))


def named(name, **quantities):
    return NamedEffect(catalogue()[name], {key: parameter(*found) for key, found in quantities.items()}, (), {})


def added(
    *effects,
    friction=(0.08, 0.001),
    seconds=4.0,
    chi=1.0,
    stopped=None,
    withheld=False,
    in_phase=True,
    refused=None,
    on=None,
):
    """Effects that were added, with what a test does not ask for as it is where all is well."""
    fitted = SimpleNamespace(chi=chi, depends=on, columns=np.ones((5, 2)), owners=np.array([VISCOUS, DRY]))
    return SimpleNamespace(
        effects=list(effects),
        parameters={
            "viscous_friction_coefficient": parameter(0.08, 0.001),
            "coulomb_friction_torque": parameter(*friction),
        },
        recordings=SimpleNamespace(rig=RIG, trace=SimpleNamespace(time=np.linspace(0.0, seconds, 5))),
        suspects=SimpleNamespace(policy=Policy(), stopped=stopped, withheld=withheld),
        refused=refused or {},
        recorded=[SimpleNamespace(name="recording"), SimpleNamespace(name="holdout")],
        extension=SimpleNamespace(fitted=fitted),
        gaps=SimpleNamespace(in_phase=lambda stage, recorded: in_phase),
    )


def against(*effects, velocity=None, torque=None, unknown=0.1, **otherwise):
    """What speaks against a diagnosis, in words by the criterion."""
    quiet = Gap("SI", 0.01, (0.1, 0.01), None)
    likely = Probabilities({frozenset(): 1.0 - unknown}, unknown)
    said, objections = verdict(added(*effects, **otherwise), likely, torque or quiet, velocity or quiet)
    assert said == ("unexplained_remainder" if objections else "explained" if effects else "nothing_missing")
    return {one.criterion: reason(one) for one in objections}


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
    found = against(SPRING, velocity=Gap("rad/s", 0.027, identify, holdout))
    assert found.keys() == ({"moves_worse"} if said else set())
    assert said in found.get("moves_worse", "")


@pytest.mark.parametrize(("after", "said"), [(0.70, ""), (0.72, "recording is worse"), (3.39, "recording is worse")])
def test_a_model_whose_waves_lost_their_phase_is_judged_by_a_speed_whose_squares_double(after, said):
    """At wrong instants they err twice, where they are and where they are not: sqrt(2*(0.5**2 + 0.027**2)) = 0.708."""
    found = against(SPRING, velocity=Gap("rad/s", 0.027, (0.50, after), None), in_phase=False)
    assert said in found.get("moves_worse", "")
    assert (bool(found), out_of_phase(added(SPRING, in_phase=False)) != []) == (bool(said), True)


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
    found = against(effect)
    assert found.keys() == ({"undetermined"} if said else set())
    assert said in found.get("undetermined", "")


def test_friction_that_is_not_determined_counts_where_its_torque_does():
    assert "not determined" in against(SPRING, friction=(0.08, 0.09))["undetermined"]
    assert against(SPRING, friction=(0.001, 0.002)) == {}
    assert against(friction=(0.08, 0.09)) == {}


def test_what_is_minor_may_be_open():
    """How warming friction divides between viscous and dry is minor; how much it is, is not."""
    known, either = {"relative_amplitude": (0.3, 0.02), "time_constant": (2.0, 0.1)}, {"viscous_share": (0.4, 3.0)}
    assert against(named("friction_warmup", **known, **either)) == {}
    for name, (value, _) in known.items():
        wide = known | either | {name: (value, 1.1 * value)}
        assert name.replace("_", " ") in against(named("friction_warmup", **wide))["undetermined"]


def test_the_torque_of_friction_is_that_of_its_own_column():
    """Viscous friction times the RMS speed of the rows, Coulomb friction times one."""
    fitted = bare(recorded(MOTION))
    parameters = {
        "viscous_friction_coefficient": parameter(8e-4, 1e-5),
        "coulomb_friction_torque": parameter(0.08, 0.001),
    }
    found = added()
    found.extension.fitted, found.parameters = fitted, parameters
    friction = frictions(found)
    speed = rms(fitted.rows.values(lambda signals: signals.velocity))
    for name, torque in (("viscous_friction_coefficient", speed), ("coulomb_friction_torque", 1.0)):
        assert friction[name][0] is parameters[name]
        assert friction[name][1] == pytest.approx(torque, rel=5e-3)
    assert speed > 10.0


def test_friction_resists():
    assert "is negative" in against(friction=(-0.002, 0.001))["negative"]
    assert "is negative" in against(friction=(-0.02, 0.03))["negative"]
    assert against(friction=(-0.002, 0.003)) == {}


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
    assert "".join(against(stopped=stopped, withheld=withheld).values()) == said


@pytest.mark.parametrize(("chi", "said"), [(1.11, ""), (1.13, "the residual is 1.13 times the noise")])
def test_twelve_hundredths_above_the_floor_remain(chi, said):
    assert "".join(against(chi=chi).values()) == said


def test_a_holdout_residual_of_three_times_that_of_the_recording_is_an_objection():
    near, far = (Gap("N*m", 0.01, (0.1, 0.008), (0.1, after)) for after in (0.029, 0.031))
    assert against(torque=near) == {}
    assert "residual of the holdout is 0.031" in against(torque=far)["holdout"]


def test_a_holdout_with_half_as_much_friction_again_is_no_proof_that_nothing_is_missing():
    more = recorded(MOTION, lambda motion: 0.49 * COULOMB * motion.sign, seed=1)
    same = diagnose(recorded(MOTION), RIG, recorded(MOTION, seed=1), excluded=NONE)
    assert (same.verdict, reasons(same)) == ("nothing_missing", [])
    other = diagnose(recorded(MOTION), RIG, more, excluded=NONE)
    assert other.verdict == "unexplained_remainder"
    assert any("residual of the holdout" in said for said in reasons(other))


def test_friction_that_drives_is_reported():
    found = diagnose(recorded(MOTION, lambda motion: -1.5 * COULOMB * motion.sign), RIG, excluded=NONE)
    assert found.verdict == "unexplained_remainder"
    assert any("Coulomb friction torque" in said and "negative" in said for said in reasons(found))


def test_no_missing_effect_needs_the_speed_gap_within_its_limit():
    assert against(velocity=Gap("rad/s", 0.01, (0.03, 0.03), limit=0.035)) == {}
    found = against(velocity=Gap("rad/s", 0.01, (0.04, 0.04), limit=0.035))
    assert "4 times the noise" in found["moves_otherwise"]
    assert against(velocity=Gap("rad/s", 0.01, None, limit=0.035)) == {}


def test_no_missing_effect_needs_nothing_to_be_the_likeliest_answer():
    assert against(unknown=0.49) == {}
    likelier = against(unknown=0.6)["likelier"]
    assert "unknown effect is more likely (60 %) than no missing effect (40 %)" in likelier


AGAINST = {
    "residual": against(SPRING, chi=1.2),
    "dependence": against(SPRING, on=Dependence("torque", {})),
    "moves_otherwise": against(velocity=Gap("rad/s", 0.01, (0.1, 0.1), limit=0.035)),
    "likelier": against(unknown=0.6),
    "stopped": against(SPRING, stopped="limit of effects reached"),
    "withheld": against(SPRING, withheld=True),
    "moves_worse": against(SPRING, velocity=Gap("rad/s", 0.01, (0.1, 0.2), None)),
    "undetermined": against(named("torsion_spring", stiffness=(0.1, 0.11))),
    "negative": against(SPRING, friction=(-0.08, 0.001)),
    "refused": against(SPRING, refused={"moment_of_inertia": "its interval contains zero"}),
    "holdout": against(SPRING, torque=Gap("N*m", 0.01, (0.1, 0.008), (0.1, 0.04))),
}


def test_one_objection_alone_turns_the_verdict():
    for criterion, found in AGAINST.items():
        assert found.keys() == {criterion}
        assert all(found.values())
    assert against(SPRING) == against() == {}
