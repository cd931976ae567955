"""Are the rig's torque constant and back-EMF constant those of one motor?"""

from __future__ import annotations

from bench.gate.check import Check, absent
from bench.rig.rig import Rig
from bench.trace.trace import Trace

NAME = "motor_constants_agree"
ALLOWED = "kT is Ke, 3/2 or sqrt(3) of it, as Ke is meant, within their tolerances, 10 % where none is stated"


def check(trace: Trace, rig: Rig | None) -> tuple[Trace, Check]:
    """Compare the two; the recording is unchanged."""
    if rig is None or rig.motor.back_emf_constant is None or rig.motor.torque_per_ampere is None:
        return trace, absent(NAME, "not both are stated", ALLOWED)
    found = rig.motor.disagreement
    if found is None:
        return trace, Check(NAME, "pass", "they agree", ALLOWED)
    return trace, Check(NAME, "warn", found, ALLOWED, "correct the wrong one in the rig, or state its tolerance (+/-)")
