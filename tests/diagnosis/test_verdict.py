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
        recordings=SimpleNamespace(
            rig=RIG, trace=SimpleNamespace(time=np.linspace(0.0, seconds, 5)), detected=("event",) * withheld
        ),
        suspects=SimpleNamespace(policy=Policy(), stopped=stopped, detected=()),
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
WARM, EITHER = {"relative_amplitude": (0.3, 0.02), "time_constant": (2.0, 0.1)}, {"viscous_share": (0.4, 3.0)}


def speed(identify, holdout=None, noise=0.027, **limit):
    return {"velocity": Gap("rad/s", noise, identify, holdout, **limit)}


def event(start):
    return named("load_torque_event", torque=(0.1, 0.01), start=start, end=(2.0, 0.05))


def unbalance(phase):
    return named("unbalance", amplitude=(0.1, 0.01), phase=phase)


def warming(**wide):
    return named("friction_warmup", **WARM | EITHER | wide)


def of_holdout(after):
    return {"torque": Gap("N*m", 0.01, (0.1, 0.008), (0.1, after))}


#: Effects, what else is not as where all is well, the criterion that speaks against it, and its words, if any.
SPEAKS = [
    # worse by more than noise makes of it: sqrt(0.05**2 + 0.027**2) = 0.0568
    ([SPRING], speed((0.50, 0.10)), "moves_worse", ""),
    ([SPRING], speed((0.50, 3.39)), "moves_worse", "recording is worse"),
    ([SPRING], speed((0.50, 0.10), (0.5, 0.6)), "moves_worse", "holdout is worse"),
    ([SPRING], speed((0.050, 0.055)), "moves_worse", ""),
    ([SPRING], speed(None), "moves_worse", ""),
    # out of phase a wave errs twice, where it is and where it is not: sqrt(2*(0.5**2 + 0.027**2)) = 0.708
    ([SPRING], speed((0.50, 0.70)) | {"in_phase": False}, "moves_worse", ""),
    ([SPRING], speed((0.50, 0.72)) | {"in_phase": False}, "moves_worse", "recording is worse"),
    # without a name the gap is within its limit
    ([], speed((0.03, 0.03), noise=0.01, limit=0.035), "moves_otherwise", ""),
    ([], speed((0.04, 0.04), noise=0.01, limit=0.035), "moves_otherwise", "4 times the noise"),
    ([], speed(None, noise=0.01, limit=0.035), "moves_otherwise", ""),
    ([SPRING], {}, "undetermined", ""),
    ([named("torsion_spring", stiffness=(0.1, 0.11))], {}, "undetermined", "stiffness"),
    ([event((0.001, 0.05))], {}, "undetermined", ""),
    ([event((0.17, 1.7e6))], {}, "undetermined", "start"),
    ([unbalance((0.02, 0.3))], {}, "undetermined", ""),
    ([unbalance((0.02, 3.5))], {}, "undetermined", "phase"),
    # how warming friction divides between viscous and dry is minor; how much it is, is not
    ([warming()], {}, "undetermined", ""),
    ([warming(relative_amplitude=(0.3, 0.33))], {}, "undetermined", "relative amplitude"),
    ([warming(time_constant=(2.0, 2.2))], {}, "undetermined", "time constant"),
    # friction counts where its torque does
    ([SPRING], {"friction": (0.08, 0.09)}, "undetermined", "not determined"),
    ([SPRING], {"friction": (0.001, 0.002)}, "undetermined", ""),
    ([], {"friction": (0.08, 0.09)}, "undetermined", ""),
    ([SPRING], {"friction": (-0.08, 0.001)}, "negative", "is negative"),
    ([], {"friction": (-0.002, 0.001)}, "negative", "is negative"),
    ([], {"friction": (-0.02, 0.03)}, "negative", "is negative"),
    ([], {"friction": (-0.002, 0.003)}, "negative", ""),
    ([], {"withheld": True}, "withheld", "an excluded effect was found"),
    ([], {"stopped": "limit"}, "stopped", "limit"),
    ([], {"stopped": "limit", "withheld": True}, "stopped", "limit"),
    ([], {"chi": 1.11}, "residual", ""),
    ([], {"chi": 1.13}, "residual", "the residual is 1.13 times the noise"),
    ([], of_holdout(0.029), "holdout", ""),
    ([], of_holdout(0.031), "holdout", "residual of the holdout is 0.031"),
    ([], {"unknown": 0.49}, "likelier", ""),
    ([], {"unknown": 0.6}, "likelier", "unknown effect is more likely (60 %) than no missing effect (40 %)"),
    ([SPRING], {"on": Dependence("torque", {})}, "dependence", "torque"),
    ([SPRING], {"refused": {"moment_of_inertia": "its interval contains zero"}}, "refused", "contains zero"),
]


@pytest.mark.parametrize(("effects", "otherwise", "criterion", "said"), SPEAKS)
def test_one_objection_turns_the_verdict(effects, otherwise, criterion, said):
    """On either side of its border, and no other criterion with it."""
    found = against(*effects, **otherwise)
    assert found.keys() == ({criterion} if said else set())
    assert said in found.get(criterion, "")


def test_waves_out_of_phase_are_reported():
    assert out_of_phase(added(SPRING, in_phase=False)) != []


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
