"""A rig file that is wrong, or says how uncertain it is."""

from __future__ import annotations

import re
from dataclasses import replace

from tests.studies.nuisance.nuisance import Nuisance


class TorqueConstantWrong(Nuisance):
    """kT of another winding in the rig, beside the right back-EMF constant: J is off with it and nothing else shows it.

    Right is a refusal, or an answer that says of the two constants that they disagree.
    """

    strengths = (0.8, 1.2)
    unit = "times"
    refusal_is_right = True

    def known(self, axis, strength):
        return replace(axis, torque_constant=strength * axis.torque_constant)

    def reported(self, answer):
        return any(re.search("torque.constant|back.emf", said, re.IGNORECASE) for said in answer.complaints)


class TorqueConstantTolerance(Nuisance):
    """kT as data sheets state it, with a tolerance: J's interval must hold the truth, and the error is no error."""

    strengths = (0.9, 1.1)
    unit = "times, +/- 15 %"
    inertia_error = 0.15

    def known(self, axis, strength):
        return replace(axis, torque_constant=strength * axis.torque_constant)

    def rig_text(self, text, axis, strength):
        constant = strength * axis.torque_constant
        stated = f'torque_constant = "{constant:.8g} +/- {0.15 * constant:.3g} N*m/A"'
        return re.sub(r"^torque_constant = .*$", stated, text, flags=re.MULTILINE)


class RigWithoutPeakCurrent(Nuisance):
    """The data sheet is lost: no peak current, no winding, or no drive either."""

    strengths = ("without winding", "without winding and drive")
    unsuited = frozenset({"voltage_limit"})

    def rig_text(self, text, axis, strength):
        kept = re.sub(r"^(peak_current|resistance|inductance|back_emf_constant) = .*\n", "", text, flags=re.MULTILINE)
        return kept if strength == "without winding" else kept[: kept.index("[drive]")]
