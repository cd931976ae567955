"""The page of an effect, as Markdown: all of it comes from the effect, or simulated with it."""

from __future__ import annotations

import difflib
import inspect
import re
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

from bench.axis_kind import LINEAR
from bench.effects.catalogue import catalogue, simpler_forms
from bench.effects.effect import (
    Coupling,
    DriveLimit,
    Effect,
    Lag,
    Occasional,
)
from bench.effects.present import Present
from bench.effects.signals import Scope
from bench.effects.waves import Wave
from bench.names import words
from bench.plant.plant import Plant
from bench.plant.profile_names import NAMES
from bench.report.effects import acting, bounds, unit_of
from bench.report.numbers import number, share
from bench.units import Quantity
from signature import Signature, rig


def turns_once(effect: Effect) -> bool:
    """Whether it is a wave of one revolution."""
    return isinstance(effect, Wave) and effect.once_per_revolution


#: What is true of an effect, in words.
DECLARED: tuple[tuple[Callable[[Effect], bool], str], ...] = (
    (turns_once, "It applies only to rotary axes."),
    (lambda effect: effect.repeatable, "An axis may have several of it, each of another shape."),
    (
        lambda effect: isinstance(effect, Occasional),
        "It happens in one recording and not in another, so a holdout need not show it.",
    ),
    (
        lambda effect: isinstance(effect, DriveLimit),
        "It shows where the drive runs the axis, so the references have to be recorded.",
    ),
    (lambda effect: isinstance(effect, Coupling), "It joins motor and load: an axis has one such effect."),
    (lambda effect: effect.external, "It may act on the load of a coupling rather than on the motor."),
    (
        lambda effect: effect.scales_friction,
        "It multiplies the level of dry friction, what other effects add to it included.",
    ),
)
#: Greek letters in equations that are written in ASCII.
LETTERS: dict[str, str] = dict(zip(("alpha", "omega", "sigma", "phi", "mu", "tau", "pi"), "αωσφμτπ", strict=True))
#: Gap over noise floor above which something is missing, as the verdict has it.
SHOWS = 1.12
#: Share of the squared gap from which another effect is named as an alternative.
NEAR = 0.05


def page(effect: Effect, found: Signature | None) -> str:
    """The page of an effect.

    Args:
        effect: of the catalogue.
        found: what it does to a recording; None where the bench does not know which values suit an axis.
    """
    equations, source = said(effect)
    kind = "a fault of the measurement" if effect.of_measurement else "physics of the axis"
    sections = [
        ("", f"`{effect.name}`, {kind}: {effect.summary}."),
        ("", "" if found is None else picture(effect, found)),
        ("Equation", equations),
        ("Parameters", parameters(effect)),
        ("In MuJoCo", in_mujoco(effect, found)),
        ("Alternatives", rivals(effect, found)),
        ("What motion shows it", "" if found is None else motions(effect, found)),
        ("Try it", "" if found is None else trial(found)),
        ("Source", source),
    ]
    texts = [f"## {heading}\n\n{text}" if heading else text for heading, text in sections if text]
    return "\n\n".join([f"# {words(effect.name).capitalize()}", *texts]) + "\n"


def said(effect: Effect) -> tuple[str, str]:
    """Equations with the meaning of their symbols, and the source, of the effect's module."""
    text = inspect.getdoc(inspect.getmodule(type(effect))) or effect.summary
    body, _, source = text.partition("\nSource: ")
    return "\n\n".join(as_markdown(block) for block in body.split("\n\n")[1:]), escaped(" ".join(source.split()))


def as_markdown(block: str) -> str:
    """A paragraph, or an indented block of equations."""
    if block.startswith("    "):
        return "```text\n" + "\n".join(readable(line[4:]) for line in block.splitlines()) + "\n```"
    return prose(" ".join(block.split()))


def prose(text: str) -> str:
    """Text of a docstring: formulas in it as they are printed, code unchanged, nothing else markup."""
    parts = re.split(r"(`[^`]*`)", text)
    return "".join(part if part.startswith("`") else escaped(readable(part)) for part in parts)


def readable(equation: str) -> str:
    """An equation with letters and signs as they are printed."""
    text = re.sub(r"[A-Za-z]+", lambda found: LETTERS.get(found[0], found[0]), equation)
    return text.replace("**2", "²").replace("<=", "≤").replace("*", "·")


def escaped(text: str) -> str:
    """Text in which no sign is markup."""
    return re.sub(r"([*_|<`\[])", r"\\\1", text)


def picture(effect: Effect, found: Signature) -> str:
    """The picture, and what it shows."""
    units = {quantity.name: quantity.unit for quantity in effect.quantities}
    values = ", ".join(f"{words(key)} {number(value, units[key], 3)}" for key, value in found.present.values)
    return (
        f"![The torque gap and the signals with {words(effect.name)}]({effect.name}.png)\n\n"
        f"*{values}, on [one axis](../../axis.toml) along the motion `identification`. Above: what torque that "
        "inertia, viscous and Coulomb friction do not explain, over the coordinates that account for most of "
        "its variance. Below: speed and current with the effect and without it, under the same drive, "
        "where they differ most.*"
    )


def parameters(effect: Effect) -> str:
    """The effect's quantities as a table."""
    lines = ["| quantity | symbol | unit | on a linear axis | values | absent at |", "|---|---|---|---|---|---|"]
    for one in effect.quantities:
        linear = "–" if turns_once(effect) else unit_cell(LINEAR.unit(one))
        null = "" if one.null is None else f"{one.null:g}".replace("inf", "∞")
        cells = (f"`{one.name}`", escaped(readable(one.symbol)), unit_cell(unit_of(one)), linear, bounds(one), null)
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def unit_cell(unit: str) -> str:
    """A unit as code; a dash where there is none."""
    return "–" if unit in ("-", "dimensionless") else f"`{unit}`"


def in_mujoco(effect: Effect, found: Signature | None) -> str:
    """Where it acts, what is added to the MJCF, and what makes the rest."""
    places = [
        f"- {place}: {prose((inspect.getdoc(getattr(effect, hook)) or '').splitlines()[0])}"
        for hook, place in acting(effect).items()
    ]
    added = [] if found is None else mjcf(found.present)
    if added:
        shown = "```xml\n" + "\n".join(added) + "\n```"
        rest = [
            "`bench export` puts it into your own MJCF. In addition to the bare axis the picture's model has",
            shown,
        ]
    elif effect.of_measurement:
        rest = ["It does not belong to the motion: an exported model does not contain it."]
    else:
        rest = ["MuJoCo has no such part: `bench.Effects` makes it in [a loop of your own](../../export.md)."]
    return "\n\n".join(["\n".join(places), *rest])


def mjcf(present: Present) -> list[str]:
    """Lines of the axis' MJCF that are another with the effect."""
    bare, with_it = (Plant.from_rig(rig(), some).spec().to_xml().splitlines() for some in ([], [present]))
    added = [line[2:].strip() for line in difflib.ndiff(bare, with_it) if line.startswith("+ ")]
    return [part for line in added for part in broken(line)]


def broken(line: str) -> list[str]:
    """A long line of XML as several, broken between attributes."""
    kept = re.sub(r'"[^"]*"', lambda value: value[0].replace(" ", "\0"), line)
    parts = textwrap.wrap(kept, 84, subsequent_indent="    ", break_long_words=False, break_on_hyphens=False)
    return [part.replace("\0", " ") for part in parts]


def rivals(effect: Effect, found: Signature | None) -> str:
    """What would explain the same recording, what it cannot be distinguished from, and with what it is not searched
    for."""
    others = {name: other for name, other in catalogue().items() if other is not effect}
    lags = [name for name, other in others.items() if isinstance(other, Lag)]
    lines = [] if found is None else [*ambiguous(effect, found.bare.scope)]
    pairs = [
        ("It is tried in the place of", replaced(effect)),
        ("In its place are tried", (name for name, other in others.items() if effect.name in replaced(other))),
        ("A recording determines only one of it and", lags if isinstance(effect, Lag) else ()),
    ]
    for sentence, names in pairs:
        linked = ", ".join(link(name) for name in sorted(names))
        lines += [f"{sentence}: {linked}."] if linked else []
    if found is not None:
        simpler = {name: [one.name for one in simpler_forms(other, found.bare.scope)] for name, other in others.items()}
        own = [one.name for one in simpler_forms(effect, found.bare.scope)]
        lines += [f"Where some of it is nil, it is: {', '.join(map(link, own))}."] if own else []
        wider = sorted(name for name, forms in simpler.items() if effect.name in forms)
        lines += [f"It is a special case of: {', '.join(map(link, wider))}."] if wider else []
    listed = "\n".join(f"- {line}" for line in lines)
    return "\n\n".join(part for part in ("" if found is None else explained(effect, found), listed) if part)


def replaced(effect: Effect) -> frozenset[str]:
    """Names of the effects in the place of which it is tried."""
    return effect.replaces


def explained(effect: Effect, found: Signature) -> str:
    """Shares of the gap that it and its nearest alternatives would explain."""
    itself = f"{words(effect.name)} by itself would take {share(found.shares.get(effect, 0.0))}"
    if type(effect).detect is not Effect.detect:
        itself = "it takes none, as single signals show it rather than the balance"
    elif effect not in found.shares:
        itself = "it takes none by itself, as it is tried only once others are found"
    near = [(other, part) for other, part in found.shares.items() if other is not effect and part >= NEAR]
    named = [f"{link(o.name) if o.name in catalogue() else escaped(o.summary)} {share(part)}" for o, part in near[:4]]
    return f"Of the squared gap of the picture's recording {itself}. " + (
        f"The nearest others: {', '.join(named)}." if named else "No other would take a twentieth."
    )


def ambiguous(effect: Effect, scope: Scope) -> Iterable[str]:
    """What recordings of some kinds cannot distinguish from it."""
    no_position = replace(scope, signals=scope.signals - {"position"}, source="velocity")
    kinds = (
        ("No recording distinguishes it from", scope),
        ("Without a recorded position it cannot be distinguished from", no_position),
        ("In one direction of motion it cannot be distinguished from", replace(scope, one_way=True)),
    )
    always: Sequence[str] = ()
    for sentence, such in kinds:
        names = [name for name in effect.ambiguous(such) if name not in always]
        always = always or names
        if names:
            yield f"{sentence}: {', '.join(link(name) for name in names)}."


def link(name: str) -> str:
    """An effect's page."""
    return f"[{words(name)}]({name}.md)"


def motions(effect: Effect, found: Signature) -> str:
    """How far it is above noise in each motion, and what else a recording has to have."""
    lines = ["| motion (`--profile`) | torque gap over noise floor | seen |", "|---|---:|---|"]
    for name in NAMES:
        seen = "by the signals" if name in found.detected else "by the gap" if found.motions[name] > SHOWS else "no"
        lines.append(f"| `{name}` | {found.motions[name]:.1f} | {seen} |")
    scope = found.bare.scope
    barred = {
        "It is not sought in motion of one direction.": replace(scope, one_way=True),
        "It is not sought where no position is recorded.": replace(scope, signals=scope.signals - {"position"}),
    }
    sentences = [sentence for sentence, such in barred.items() if effect.sought(scope) and not effect.sought(such)]
    sentences += [sentence for declares, sentence in DECLARED if declares(effect)]
    return "\n".join([*lines, "", *(f"- {sentence}" for sentence in sentences)])


def trial(found: Signature) -> str:
    """Commands that make the picture's recording, and diagnose it."""
    return (
        "With [the axis of the picture](../../axis.toml):\n\n```sh\n"
        f"bench simulate axis.toml --out run.csv.gz \\\n    --effect {found.text}\n"
        "bench diagnose run.csv.gz --rig axis.toml --out found\n```"
    )


def table(pages: Iterable[Effect]) -> str:
    """All effects with what they are, for the page that lies two folders above theirs."""
    lines = ["| effect | what it is | quantities |", "|---|---|---|"]
    for effect in pages:
        quantities = ", ".join(quantity_cell(quantity) for quantity in effect.quantities)
        named = f"[{words(effect.name)}](reference/effects/{effect.name}.md)"
        lines.append(f"| {named} | {escaped(effect.summary)} | {quantities} |")
    return "\n".join(lines) + "\n"


def quantity_cell(quantity: Quantity) -> str:
    """A quantity with its unit."""
    unit = unit_of(quantity)
    return words(quantity.name) + ("" if unit == "-" else f" `{unit}`")
