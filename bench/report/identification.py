"""An identification: inertia and friction, how sure that is, and the residual torque.

As the contract's JSON (`bench.identify/1`) and as a document; its picture has the motion, torque measured and modelled,
the residual, and the estimates.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.arrays import Array
from bench.axis_kind import COULOMB, INERTIA, MISALIGNMENT, VISCOUS, AxisKind
from bench.comparison.spread import Between
from bench.fit.estimate import Alone, Estimate, MotorConstants, modelled_effort
from bench.fit.motor import SPEED
from bench.fit.solution import NOISE_ALONE
from bench.gate.gate import gate, warnings_of
from bench.names import readable, words
from bench.report import document as doc
from bench.report.numbers import brief, effort_word, interval, number, sentence, share, unit_text
from bench.report.over_time import Plotted, time_graph
from bench.report.parts import checks_section, noise_band, origin, parameters_table, recordings_table
from bench.report.serial import known, picked, serialised
from bench.rig.rig import Rig
from bench.trace.motion import Motion, condition, motion
from bench.trace.trace import Trace

if TYPE_CHECKING:  # MuJoCo: 0.1 s
    from bench.fit.refine import Refinement

SCHEMA = "bench.identify/1"
#: Revolutions per minute of 1 rad/s.
RPM = 30.0 / math.pi
#: Recordings whose motion is drawn; of more, the first ones.
DRAWN = 6


def identification_json(
    estimate: Estimate,
    refinement: Refinement | None = None,
    refused: str | None = None,
    provenance: Mapping[str, Any] | None = None,
) -> str:
    """The estimate as the contract's JSON.

    Args:
        refinement: what polishing did, where it was asked for.
        refused: why the recording cannot answer, where it cannot.
        provenance: of the files it came from; null where it came from none.
    """
    residual = estimate.residual
    content = {
        "schema": SCHEMA,
        **picked(estimate, "estimator", "parameters"),
        "explained": known(estimate.explained),
        "refused": refused,
        **recordings_json(estimate.recordings, estimate.between, provenance),
        "provenance": provenance,
        "residual": {
            "rms": residual.rms,
            "noise_floor": known(residual.noise_floor),
            **picked(residual, "unit", "relative", "depends_on"),
        },
        "samples": {"read": estimate.samples_read, "used": estimate.samples_used},
        "filter": {"cutoff": known(estimate.cutoff), "unit": "Hz", "source": estimate.source},
        **picked(estimate, "dead_time", "command", "motor", "coupling", "checks", "warnings"),
    }
    return serialised(content if refinement is None else {**content, "refinement": refinement})


def recordings_json(
    recordings: Sequence[Alone], between: Mapping[str, Between], provenance: Mapping[str, Any] | None
) -> dict[str, Any]:
    """Each of several recordings by itself, and how they differ; `reason`: why one does not determine some of the
    parameters."""
    digests = {each["file"]: each["sha256"] for each in provenance["traces"]} if provenance else {}
    alone = []
    for one in recordings:
        file = {"file": one.origin, "sha256": digests.get(one.origin)}
        alone.append({**file, **picked(one, "parameters"), "reason": one.reason or None})
    return {"recordings": alone, "between": between if alone else None}


@dataclass(frozen=True)
class Moved:
    """The first part of a recording, as a page shows it.

    Attributes:
        motion: through the filter that the estimate was made with.
        along: the estimate, with the shift of torque against speed that this recording has of its own.
    """

    name: str
    kind: AxisKind
    motion: Motion
    along: Estimate

    @property
    def left(self) -> Array:
        """Measured less modelled effort - the residual's unit - (n,); nan where the direction is uncertain."""
        return self.motion.effort - modelled_effort(self.motion, self.along, self.kind)


def moved(
    traces: Sequence[Path], rig: Rig, estimate: Estimate, read: Callable[[Path], Trace] | None = None
) -> list[Moved]:
    """Motions of the files that an estimate came from; of a very long one its first part, unless `read` reads it."""
    found, cutoff = [], estimate.cutoff if estimate.cutoff > 0.0 else None
    shift = rig.axis_kind.parameter(MISALIGNMENT)  # of torque against speed, which each recording has of its own
    for index, trace in enumerate(traces):
        from bench.trace.stream import stream

        first = gate(read(trace) if read is not None else next(stream(trace, rig.trace)), rig).trace
        (effort, _), (own, _) = rig.net_effort(first), rig.own_effort(first)
        filtered = motion(first, effort, rig.driven(first), condition(first, own, cutoff))
        own_shift = estimate.recordings[index].parameters.get(shift) if estimate.recordings else None
        parameters = {**estimate.parameters, **({shift: own_shift} if own_shift is not None else {})}
        found.append(Moved(readable(trace.name), rig.axis_kind, filtered, replace(estimate, parameters=parameters)))
    return found


def identification(
    title: str,
    kind: AxisKind,
    estimate: Estimate,
    refinement: Refinement | None = None,
    motions: Sequence[Moved] = (),
    provenance: Mapping[str, Any] | None = None,
) -> doc.Document:
    """The document of an identification.

    Args:
        title: rig and recordings.
        refinement: what polishing did, where it was asked for.
        motions: of its recordings, for a page and pictures; () without.
    """
    alone = recordings_table(estimate.recordings, estimate.between, estimate.parameters)
    tables = (parameters_table("The axis", estimate.parameters), *_in_addition(estimate), *alone)
    sections = [doc.section("parameters", "Parameters", *tables), checks_section(estimate.checks, estimate.warnings)]
    if motions:
        graphs = map(_over_time, motions[:DRAWN])
        text = identification_json(estimate, refinement, None, provenance) + "\n"
        file = doc.file("identify.json", "all results as numbers", text)
        sections[1:1] = [
            doc.section("motion", "Measured and modelled", *graphs),
            doc.section("where", "Where the residual is", _rest(estimate, motions)),
        ]
        sections.append(doc.section("files", "The numbers", doc.downloads(file)))
    return doc.Document(
        title=title,
        subject=f"Identification of {title}",
        verdict=_verdict(estimate, kind),
        tone="sure" if _noise(estimate) else "open",
        answers=_answers(estimate, refinement, kind),
        sections=tuple(sections),
        origin=origin(provenance),
        pictures=tuple(
            doc.Picture(  # motion and torque of a recording, the estimates, and the residual
                name="identification" if place == 1 else f"identification-{place}",
                title=f"{title.partition(': ')[0]}: {one.name}",
                rows=(
                    (_over_time(one, acceleration=True), parameters_table("", one.along.parameters)),
                    (_rest(one.along, [one]),),
                ),
            )
            for place, one in enumerate(motions, 1)
        ),
        warnings=(*estimate.warnings, *warnings_of(estimate.checks)),
    )


def _times_noise(estimate: Estimate) -> float:
    """Residual over noise floor; nan where the estimator has none."""
    return estimate.residual.rms / estimate.residual.noise_floor


def _noise(estimate: Estimate) -> bool:
    """Whether nothing shows that the residual is more than noise."""
    return estimate.residual.depends_on is None and not _times_noise(estimate) > NOISE_ALONE


def _verdict(estimate: Estimate, kind: AxisKind) -> str:
    effort, chi = effort_word(estimate.residual.unit), _times_noise(estimate)
    line = f"The {kind.in_words(INERTIA)} is {interval(estimate[kind.parameter(INERTIA)])}"
    if math.isfinite(estimate.explained):
        explained = math.floor(1e4 * estimate.explained) / 100.0
        line += f"; inertia and friction explain {explained:g} % of the {effort}'s variance"
    if not math.isfinite(chi):
        return f"{line}."
    if chi > NOISE_ALONE:
        return f"{line}, but the residual is {number(chi, digits=2)} times the noise."
    if estimate.residual.depends_on is not None:
        return f"{line}, but the residual depends on the {estimate.residual.depends_on}."
    return f"{line}, and the residual is noise."


def _answers(estimate: Estimate, refinement: Refinement | None, kind: AxisKind) -> dict[str, str]:
    inertia, residual = kind.parameter(INERTIA), estimate.residual
    friction = [
        f"{words(name)} {interval(estimate[name])}"
        for name in map(kind.parameter, (COULOMB, VISCOUS))
        if name in estimate.parameters
    ]
    sure = "± is half of the 95 % interval, which allows for correlated residuals."
    if estimate.between:
        sure += " It includes how the recordings differ."
    of = f"{share(residual.relative)} of the {effort_word(residual.unit)}"
    left = f"{number(residual.rms, residual.unit, 3)} RMS, {of}"
    if math.isfinite(residual.noise_floor):
        left += f"; the noise floor is {number(residual.noise_floor, digits=3)}"
    basis = f"{estimate.samples_used} of {estimate.samples_read} samples"
    if math.isfinite(estimate.cutoff):  # of the filter that they went through
        basis += f"; cut-off {number(estimate.cutoff, 'Hz', 3)}, speed from {estimate.source}"
    polished = {}
    if refinement is not None:
        before, after = refinement.held_out
        error = f"simulation error on held-out motion {number(before)} to {number(after, kind.speed_unit)}"
        kept = "polish kept" if refinement.accepted else "polish not kept"
        polished["Polished?"] = f"{error} (held at {number(refinement.bandwidth, 'rad/s')}): {kept}."
    return {
        f"{words(inertia).capitalize()}?": f"{interval(estimate[inertia])} (95 %)",
        "Friction?": "; ".join(friction) or "not determined",
        "How sure?": sure,
        "Residual?": f"{left}.",
        "From what?": f"{basis}.",
        **({} if estimate.motor is None else {"Motor?": _motor(estimate.motor)}),
        **({} if estimate.command is None else {"Command?": f"{sentence(str(estimate.command))}."}),
        **polished,
        "What next?": "The residual is noise. A recording of another motion can confirm it."
        if _noise(estimate)
        else "`bench diagnose` searches for what acts in addition to inertia and friction.",
    }


def _in_addition(estimate: Estimate) -> list[doc.Table]:
    """Constants of motor and coupling, where the recording shows them."""
    motor = {} if estimate.motor is None else estimate.motor.parameters
    tables = {"The motor": motor, "The coupling, on the load's side": estimate.coupling}
    return [parameters_table(caption, found) for caption, found in tables.items() if found]


def _motor(motor: MotorConstants) -> str:
    """What voltage and current show of the motor, and why not the rest."""
    found = [f"{words(name)} {brief(one)}" for name, one in motor.parameters.items()]
    speed = motor.parameters.get(SPEED)
    if speed is not None and speed.unit.startswith("rad"):
        found.append(f"KV {number(speed.value * RPM, 'rpm/V', 3)}")
    if motor.supply is not None:
        found.append(f"supply {number(motor.supply[0])} to {number(motor.supply[1], 'V')}")
    refused = (f"{words(name)} cannot be determined: {why}" for name, why in motor.refused.items())
    return f"{'; '.join([*found, *refused])}."


def _over_time(one: Moved, acceleration: bool = False) -> doc.TimeGraph:
    """Speed, and torque with the model's."""
    moved, unit = one.motion, one.along.residual.unit
    effort = effort_word(unit)
    signals = [Plotted("speed", one.kind.speed_unit, moved.time, moved.velocity)]
    if acceleration:
        signals.append(Plotted("acceleration", one.kind.acceleration_unit, moved.time, moved.acceleration))
    signals.append(Plotted(effort, unit, moved.time, moved.effort, [one.left], "modelled"))
    alternative = f"Speed of {one.name}, its {effort} as measured and with inertia and friction only, and the residual."
    return time_graph("Over time.", alternative, moved.time, signals)


def _rest(estimate: Estimate, motions: Sequence[Moved]) -> doc.Chart:
    """The residual torque over speed, acceleration, torque and time."""
    from bench.diagnosis.where import LEAST, bins_of, means_in

    unit, floor, kind = estimate.residual.unit, estimate.residual.noise_floor, motions[0].kind
    left = np.concatenate([one.left for one in motions])
    known = np.isfinite(left)
    over = {
        ("speed", kind.speed_unit): [one.motion.velocity for one in motions],
        ("acceleration", kind.acceleration_unit): [one.motion.acceleration for one in motions],
        (effort_word(unit), unit): [one.motion.effort for one in motions],
        ("time", "s"): [one.motion.time - one.motion.time[0] for one in motions],
    }
    panels = []
    for (name, of), parts in over.items():
        values = np.concatenate(parts)[known]
        index = bins_of(values)
        kept = np.bincount(index) >= LEAST
        dots = doc.series(
            "residual", "dots", "residual", means_in(index, values)[kept], means_in(index, left[known])[kept]
        )
        band = [noise_band(dots.x, floor)] if math.isfinite(floor) else []
        panels.append(doc.Panel(x_label=name, x_unit=unit_text(of), series=(*band, dots)))
    return doc.Chart(
        title="Residual.",
        alternative=f"Mean of measured less modelled {effort_word(unit)} in bins; what exceeds the noise floor "
        "has a cause in addition to inertia and friction.",
        y_label="residual",
        y_unit=unit_text(unit),
        panels=tuple(panels),
    )
