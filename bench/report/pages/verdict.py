"""What a diagnosis comes to, in lines: what was missing, how sure that is, whether it moves alike, what next."""

from __future__ import annotations

import math

from bench.axis_kind import INERTIA, KINDS
from bench.diagnosis.add.refine import NULL
from bench.diagnosis.found import Gap, NamedEffect
from bench.diagnosis.show.show import Diagnosis
from bench.names import words
from bench.report.numbers import coordinate_word, effort_word, interval, number, sentence, share, unit_text


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """What was missing and how much of the gap it accounts for, in a sentence."""
    gap, unit = diagnosis.torque, unit_text(diagnosis.torque.unit)
    effort = effort_word(diagnosis.torque.unit)
    before, after = gap.identify or (math.nan, math.nan)
    noise = f"the noise floor is {number(gap.noise_floor, digits=3)} {unit}"
    if not diagnosis.effects:
        if diagnosis.verdict == "nothing_missing":
            left = f"inertia and friction leave {number(after, digits=3)} {unit} of the {effort}"
            return f"Nothing is missing: {left}, {noise}."
        return (
            f"Something is missing that no effect of the catalogue explains: {number(after, digits=3)} {unit} "
            f"of the {effort} are left, {noise}."
        )
    several = len(diagnosis.effects) > 1
    named = "; ".join(_named(effect) for effect in diagnosis.effects)
    sensors = all(effect.effect.kind == "measurement" for effect in diagnosis.effects)
    what = f"{'were' if several else 'was'} {'wrong in the measurement' if sensors else 'missing'}"
    gone = f"with {'them' if several else 'it'} {share(1.0 - after / before)} of the {effort} gap is gone"
    if diagnosis.verdict == "explained":
        return f"{sentence(named)} {what}; {gone}, and what is left is noise."
    return f"{sentence(named)} {what}; {gone}, but {number(_chi(gap), digits=2)} times the noise is left."


def _named(effect: NamedEffect) -> str:
    """An effect with its quantities; a phase says nothing to a reader."""
    angles = {quantity.name for quantity in effect.effect.quantities if quantity.angle}
    values = [f"{words(name)} {interval(found)}" for name, found in effect.parameters.items() if name not in angles]
    return f"{words(effect.name)} ({', '.join(values)})" if values else words(effect.name)


def answers(diagnosis: Diagnosis) -> dict[str, str]:
    """What a reader comes with, answered."""
    kind = next(kind for kind in KINDS if kind.speed_unit == diagnosis.velocity.unit)
    inertia = diagnosis.parameters[kind.parameter(INERTIA)]
    names = "; ".join(f"{_named(effect)}: {effect.effect.summary}" for effect in diagnosis.effects)
    return {
        f"{sentence(kind.in_words(INERTIA))}?": f"{interval(inertia)} (95 %)",
        "What was missing?": names or "No effect of the catalogue.",
        "How sure?": _sure(diagnosis),
        "Does it move like the axis now?": _moves(diagnosis.velocity, bool(diagnosis.effects)),
        "What next?": following(diagnosis) or "Nothing is left open that another motion would tell.",
    }


def _sure(diagnosis: Diagnosis) -> str:
    """What bears the verdict out, and what speaks against it."""
    gap, lines, effort = diagnosis.torque, [], effort_word(diagnosis.torque.unit)
    if diagnosis.because:
        lines.append(f"Not wholly: {'; '.join(map(words, diagnosis.because))}.")
    if gap.holdout is not None:
        before, after = gap.holdout
        lines.append(
            f"On the recording that was not fitted the {effort} gap goes from {number(before, digits=3)} to "
            f"{number(after, gap.unit, 3)}, where noise alone leaves {number(gap.noise_floor, digits=3)}."
        )
    elif diagnosis.effects:
        lines.append("The last third of the recording, kept from the fit, bears it out; no holdout was given.")
    if diagnosis.holdout.same is False:
        lines.append("The holdout is of another axis, or of this one changed.")
    lines += [
        f"{sentence(words(effect.name))} cannot be told here from {' or '.join(map(words, effect.ambiguous_with))}."
        for effect in diagnosis.effects
        if effect.ambiguous_with
    ]
    if not lines:
        lines.append(f"What is left of the {effort} is {number(_chi(gap), digits=3)} times what noise alone leaves.")
    return " ".join(lines)


def _chi(gap: Gap) -> float:
    return math.nan if gap.identify is None else gap.identify[1] / gap.noise_floor


def _moves(gap: Gap, added: bool) -> str:
    """Whether the simulation moves as the axis does."""
    pair = gap.holdout or gap.identify
    if pair is None:
        return "Not known: MuJoCo cannot have the model, or it diverged."
    like = "Yes" if pair[1] <= NULL * gap.noise_floor else "Not wholly"
    before = f", {number(pair[0], digits=3)} before" if added else ""
    where = "on the recording that was not fitted" if gap.holdout else "on the recording"
    return (
        f"{like}: simulated speed is off by {number(pair[1], gap.unit, 3)} RMS {where}{before}; "
        f"the sensor's noise is {number(gap.noise_floor, digits=3)}."
    )


def following(diagnosis: Diagnosis) -> str:
    """What to record or look at next; empty where nothing is open."""
    found = diagnosis.next_experiment
    if found is not None:
        times = number(found.separation, digits=2)
        return (
            f"Record {words(found.profile)} up to {number(found.speed, diagnosis.velocity.unit, 3)}, "
            f"{found.repetitions} times: it tells {' from '.join(map(words, found.tells_apart))} "
            f"({times} times the noise); {found.reason}."
        )
    if diagnosis.unexplained_where:
        most = diagnosis.unexplained_where[0]
        return (
            f"Look at what is left: {share(most.share)} of it hangs on {coordinate_word(most.coordinate, most.unit)}, "
            f"most between {number(most.region[0], digits=3)} and {number(most.region[1], most.unit, 3)}; "
            "what the catalogue holds is not it."
        )
    return ""
