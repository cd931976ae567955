"""What an effect does to a recording: one axis simulated with it and without, and what `diagnose` sees of the two."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import bench
from bench.arrays import Array, rms
from bench.diagnosis.recordings import fit_bare
from bench.diagnosis.search import candidates
from bench.diagnosis.where import LEAST, bins_of, coordinates, means_in, where
from bench.effects.catalogue import catalogue
from bench.effects.effect import Effect
from bench.effects.present import Present, parse_effect
from bench.effects.rivals import RIVALS
from bench.fit.fit import Fit
from bench.fit.rows import Rows
from bench.names import words
from bench.plant.profile_names import DEFAULT, NAMES
from bench.plant.simulate import simulate
from bench.report.figures import MEASURED, MODELLED, NOISE, REST, in_style, save, thinned
from bench.report.numbers import coordinate_word, share, unit_text
from bench.rig.rig import Rig
from bench.trace.trace import Trace
from bench.validation.independent.effects import KINDS
from bench.validation.plan import own_axis

RIG = Path(__file__).resolve().parents[1] / "axis.toml"
#: Strength of every effect, where 1 is drastic, and seed of what else is drawn: phases, instants, harmonics.
SEVERITY, SEED = 0.5, 14
#: Length of the stretch of time that is drawn - s.
STRETCH = 0.3


@dataclass(frozen=True)
class Signature:
    """An effect on the axis of the pictures.

    Attributes:
        present: the effect with its values.
        text: the same as the command line takes it.
        affected, plain: recordings with the effect and without it, under the same drive along the same motion.
        bare: inertia, viscous and Coulomb friction fitted to the first; their residual is the gap.
        motions: by name of the motion, RMS of the gap over its noise floor.
        detected: motions in which single signals show it.
        shares: of the squared gap, what each effect of the catalogue and each decoy model would explain, were it
            tried alone; the most first.
    """

    present: Present
    text: str
    affected: Trace
    plain: Trace
    bare: Fit
    motions: Mapping[str, float]
    detected: frozenset[str]
    shares: Mapping[Effect, float]


@cache
def rig() -> Rig:
    """The axis of the pictures."""
    return bench.load_rig(RIG)


def shown(effect: Effect) -> bool:
    """Whether the bench can draw values of it."""
    return effect.name in KINDS


def signature(effect: Effect) -> Signature:
    """The effect on the axis of the pictures, with values as `bench validate` draws them."""
    own = own_axis(rig(), DEFAULT, None).case
    drawn = KINDS[effect.name].draw(own.axis, SEVERITY, np.random.default_rng(SEED), own.motion.duration)
    values = ",".join(f"{key}={float(value):.3g}" for key, value in drawn.quantities(own.axis).items())
    text = f"{effect.name}:{values}"
    present = parse_effect(text)
    affected = {name: recorded(name, present) for name in NAMES}
    bare = {name: fit_bare(Rows.of(trace, rig())) for name, trace in affected.items()}
    motions = {name: rms(fitted.left) / fitted.floor for name, fitted in bare.items()}
    width = {name: fitted.rows.conditioning.filter.width for name, fitted in bare.items()}
    detected = frozenset(name for name in NAMES if effect.detect(affected[name], rig(), width[name]) is not None)
    main = bare[DEFAULT]
    tried = candidates(main, [*catalogue().values(), *RIVALS])
    shares = {term.effect: gain / main.squares for term, gain in tried}
    return Signature(present, text, affected[DEFAULT], recorded(DEFAULT), main, motions, detected, shares)


def recorded(motion: str, *effects: Present) -> Trace:
    """A recording of the axis."""
    return simulate(rig(), motion, effects=effects).trace


@in_style
def drawn(found: Signature) -> Figure:
    """The gap over the coordinates that account for most of it, and the signals where they differ most."""
    figure = Figure(figsize=(8.6, 5.0), layout="constrained")
    axes = figure.subplot_mosaic([["0", "1", "2"], ["v", "v", "i"]])
    over_coordinates([axes[key] for key in "012"], found)
    for key, signal in (("v", "velocity"), ("i", "current")):
        beside(axes[key], found, signal)
    entries = [pair for key in "0v" for pair in zip(*axes[key].get_legend_handles_labels(), strict=True)]
    handles, labels = zip(*entries, strict=True)
    figure.legend(handles, labels, loc="outside lower center", ncols=len(labels), markerscale=2.0)
    return figure


def over_coordinates(places: list[Axes], found: Signature) -> None:
    """The gap, every row and the mean in bins, on one scale over as many coordinates as there are places."""
    kind, rows = rig().axis_kind, found.bare.rows
    unit, current = rig().net_effort(found.affected)[1], found.affected["current"][rows.samples()]
    lies = {name: (values, called) for name, values, _, called in coordinates(found.bare, kind, unit, current)}
    accounts = [one for one in where(found.bare, kind, unit, current) if one.coordinate in lies]
    for axes, account in zip(places, accounts, strict=False):
        if axes is not places[0]:
            axes.sharey(places[0])
            axes.tick_params(labelleft=False)
        values, x = lies[account.coordinate]
        index = bins_of(values)
        filled = np.bincount(index) >= LEAST
        centres, means = means_in(index, x)[filled], means_in(index, found.bare.left)[filled]
        order = np.argsort(centres)
        axes.axhspan(-found.bare.floor, found.bare.floor, color=NOISE, lw=0.0, zorder=0.5, label="noise floor")
        axes.plot(*thinned(x, found.bare.left), ".", ms=1.5, color=MEASURED, alpha=0.35, rasterized=True, label="gap")
        axes.plot(centres[order], means[order], "-o", ms=2.6, color=MODELLED, label="its mean")
        axes.set_title(f"{share(account.share)} of the gap", loc="right")
        axes.set_xlabel(labelled(coordinate_word(account.coordinate, account.unit), account.unit))
    places[0].set_ylabel(labelled("torque gap", unit))


def beside(axes: Axes, found: Signature, signal: str) -> None:
    """A signal with the effect and without it, over the stretch of time in which they differ most."""
    time, part = found.affected.time, stretch(found)
    axes.plot(time[part], found.plain[signal][part], color=REST, lw=1.4, label="recorded without the effect")
    axes.plot(time[part], found.affected[signal][part], color=MODELLED, lw=1.1, ls="--", label="recorded with it")
    axes.set_xlabel("time / s")
    axes.set_ylabel(labelled(words(signal), found.affected.units[signal]))


def stretch(found: Signature) -> slice:
    """The samples of a stretch of time in which speed and current differ most, each over its own size."""

    def differs(signal: str) -> Array:
        off = found.affected[signal] - found.plain[signal]
        return (off / rms(found.plain[signal])) ** 2

    length = round(STRETCH / found.affected.sample_period)
    sums = np.convolve(differs("velocity") + differs("current"), np.ones(length), "valid")
    start = int(np.argmax(sums))
    return slice(start, start + length)


def labelled(name: str, unit: str) -> str:
    """Name and unit of an axis."""
    text = unit_text(unit)
    return f"{name} / {f'({text})' if '/' in text else text}" if text else name


def draw(found: Signature, path: Path) -> None:
    """Write the picture."""
    save(drawn(found), path)
