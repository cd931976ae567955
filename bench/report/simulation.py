"""A simulated recording: what was simulated, and what the sensors made of it."""

from __future__ import annotations

from bench.axis_kind import INERTIA
from bench.effects.present import Present
from bench.names import words
from bench.plant.axis_model import parameter_quantities
from bench.plant.simulate import Simulated, Truth
from bench.report.document import Document, Downloads, File, Paragraph, Section, Table, TimeGraph, table
from bench.report.numbers import number, unit_text
from bench.report.over_time import Plotted, time_graph
from bench.report.parts import origin


def simulation(simulated: Simulated, name: str) -> Document:
    """The document of a simulated recording of a name."""
    truth, trace = simulated.truth, simulated.trace
    effects = [_effect(present, truth) for present in truth.effects]
    seconds = number(float(trace.time[-1] - trace.time[0]), "s", 3)
    hidden = f", with {', '.join(words(present.name) for present in truth.effects)} in it" if effects else ""
    kind = truth.parameters.kind
    answers = {
        f"{kind.in_words(INERTIA).capitalize()}?": number(truth.parameters.inertia, kind.inertia_unit, 5),
        "What is hidden?": "; ".join(effects) or "Nothing beyond inertia and friction.",
        "Where is the friction?": f"In the {truth.friction}.",
    }
    file = File(name="truth.json", about="the truth", media="application/json", content=truth.as_json())
    return Document(
        title=name,
        subject=f"Simulation of {truth.rig}: {name}",
        verdict=f"{seconds} of the profile {words(truth.profile)} were simulated{hidden}.",
        tone="sure",
        answers=answers,
        sections=(
            Section(key="motion", heading="Recorded and true", blocks=(_over_time(simulated),)),
            Section(key="truth", heading="The truth", blocks=(_parameters(truth), *_effects(truth))),
            Section(key="files", heading="The numbers", blocks=(Downloads(files=(file,)),)),
        ),
        origin=(*origin(None), f"seed {truth.seed}"),
    )


def _effect(present: Present, truth: Truth) -> str:
    values = ", ".join(f"{name} {number(value, unit)}" for name, value, unit in _values(present, truth))
    return f"{words(present.name)} ({values})"


def _values(present: Present, truth: Truth) -> list[tuple[str, float, str]]:
    units = {quantity.name: truth.parameters.kind.unit(quantity) for quantity in present.effect.quantities}
    return [(words(name), value, units[name]) for name, value in present.values]


def _over_time(simulated: Simulated) -> TimeGraph:
    """Speed and position as recorded and as they were, and the recorded effort."""
    trace, states = simulated.trace, simulated.states
    period = float(states.time[1] - states.time[0])
    ticks = ((trace.time - states.time[0]) / period).round().astype(int)
    was = {"velocity": ("speed", states.velocity[ticks, 0]), "position": ("position", states.position[ticks, 0])}
    signals = [
        Plotted(label, trace.units[name], trace.time, trace[name], [trace[name] - true], "true", name="recorded")
        for name, (label, true) in was.items()
        if name in trace
    ]
    efforts = [name for name in ("current", "torque", "force") if name in trace]
    signals += [Plotted(name, trace.units[name], trace.time, trace[name], name="recorded") for name in efforts]
    alternative = (
        f"Speed, position and {', '.join(efforts)} as the sensors recorded them, and speed and position as they were."
    )
    return time_graph("Over time.", alternative, trace.time, signals)


def _parameters(truth: Truth) -> Table:
    quantities = parameter_quantities(truth.parameters.kind)
    rows = (
        (words(quantity.name), number(getattr(truth.parameters, field), digits=5), unit_text(quantity.unit))
        for field, quantity in quantities.items()
    )
    return table("The axis, on the motor's side", ("quantity", "value>", "unit"), rows)


def _effects(truth: Truth) -> tuple[Table | Paragraph, ...]:
    if not truth.effects:
        return (Paragraph(text="No effect was added."),)
    rows = (
        (words(present.name), name, number(value, digits=5), unit_text(unit))
        for present in truth.effects
        for name, value, unit in _values(present, truth)
    )
    return (table("Effects", ("effect", "quantity", "value>", "unit"), rows),)
