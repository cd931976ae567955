"""The whole chain on the embedded rig: hide an effect in it, find it, add it, and compare the result with the truth."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from bench.diagnosis.diagnosis import diagnose
from bench.effects.present import Present
from bench.files import held
from bench.fit.identify import identify
from bench.names import words
from bench.plant.axis_model import effect_values
from bench.plant.profile_names import DEFAULT
from bench.plant.simulate import Truth, simulate, write_truth
from bench.report.diagnosis import diagnosis, write_diagnosis
from bench.report.document import Document, section
from bench.report.identification import identification, moved
from bench.report.numbers import number
from bench.report.parts import parameters_table
from bench.report.publish import write_document
from bench.rig.rig import load_rig
from bench.trace.read import read
from bench.trace.write import write
from bench.validation.plan import Hiding, Plan, own_axis

#: Of the shipped rigs.
RIG = "sh30701p"


def demo(out: Path, seed: int, progress: Callable[[float], None]) -> tuple[Document, list[Path]]:
    """Run the chain into a folder; identification and diagnosis read the trace file, like anybody's.

    The seed draws which effect is hidden, how strong it is, and the sensors' noise; `progress` is called with the share
    done. Returns the diagnosis with the truth, and the files that were written. InputError where they cannot be.
    """
    rig, trace = load_rig(RIG), out / "trace.csv.gz"
    case = Plan(seed, Hiding(1, 1), population=own_axis(rig, DEFAULT, None)).case(0)
    hidden = [Present.of(effect.name, effect.quantities(case.axis)) for effect in case.effects]
    title = f"{rig.name}, simulated in MuJoCo with an effect hidden by seed {seed}"
    with held(out):
        simulated = simulate(rig, DEFAULT, seed, progress=lambda share: progress(0.3 * share), effects=hidden)
        write(simulated.trace, trace)
        files = [trace, write_truth(trace, simulated.truth)]
        recorded = read(trace)
        bare = identify(recorded, rig)
        found = diagnose(recorded, rig, progress=lambda share: progress(0.3 + 0.5 * share))
        files += write_document(out, identification(title, rig.axis_kind, bare, motions=moved([trace], rig, bare)))
        files += write_diagnosis(out, found, title)
    progress(1.0)
    shown, truth = diagnosis(found, title), simulated.truth
    tables = [parameters_table("The axis", found.parameters, {k: v for k, (v, _) in truth.parameters.values.items()})]
    for one in found.effects:
        known = {k: v for present in truth.effects if present.effect is one.effect for k, v in present.values}
        tables.append(parameters_table(words(one.name), one.parameters, known))
    answers = {"What was hidden?": f"{_hidden(truth)}.", **shown.answers}
    compared = section("truth", "Found and true values", *tables)
    return shown.model_copy(update={"answers": answers, "sections": (compared,)}), list(dict.fromkeys(files))


def _hidden(truth: Truth) -> str:
    """Effects that are hidden, with their values."""
    kind = truth.parameters.kind
    hidden = {
        one.name: ", ".join(f"{words(key)} {number(*value, 3)}" for key, value in effect_values(one, kind).items())
        for one in truth.effects
    }
    return "; ".join(f"{words(name)} ({of})" if of else words(name) for name, of in hidden.items())
