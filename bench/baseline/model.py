"""A model of an axis as a state, and the comparison of two of them.

All values are exact, so nothing is undecided: a quantity has changed if it differs by more than its margin, an effect
is present or absent. Values show a change of the file, the response one of the simulator: the model's torque in one
stated run. Its speed reference is a sum of two sines, faded in; the drive a cascade of BANDWIDTH laid out for an
inertia, as are the speeds for a torque. Both come from the model of the baseline, so that every later model runs the
same.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from bench.arrays import Array, rms
from bench.baseline.check import Allowed, Checked, matched
from bench.baseline.state import INSTANTS, AxisEffect, Response, State
from bench.comparison.difference import CHANGED, SAME, Comparison, Difference, Measured
from bench.plant.axis_model import AxisModel, effect_values
from bench.plant.drive import Cascade, References
from bench.plant.model_file import SCHEMA, load_model, read_table
from bench.plant.plant import Plant
from bench.plant.run import run
from bench.trace.motion import integrated

#: Margins: of an angle - rad -, and of the torque of the response as a share of its RMS.
ANGLE, RESPONSE = 0.05, 0.01
#: Name of the comparison of runs.
RESPONSE_TORQUE = "response_torque"
#: Duration and tick of the run - s -; of its speed: frequencies - Hz -, shares of them, and fade-in - s.
DURATION, TICK = 2.5, 250e-6
FREQUENCIES, SHARES, FADE = (0.8, 3.1), (0.6, 0.4), 0.3
#: Bandwidth of the velocity loop - rad/s -: low enough for a coupling behind the motor.
BANDWIDTH = 30.0
#: Accelerating torque over Coulomb friction; and the least acceleration by `turns` - rad/s**2 (m/s**2).
OVER_FRICTION, LEAST = 3.0, {True: 50.0, False: 0.5}


def is_model(path: str | Path) -> bool:
    """Whether a file is a `model.toml`, a baseline of a model too."""
    return Path(path).exists() and read_table(path).get("schema") == SCHEMA


def modelled(path: str | Path, baseline: State | None = None) -> State:
    """The state of a `model.toml` that `bench diagnose` wrote, its response the run of `baseline` if there is one.

    InputError: no such model. SimulationError: the model diverged.
    """
    stored = load_model(path, scaled=True)
    kind, effects = stored.model.parameters.kind, []
    for present in stored.model.effects:
        values = effect_values(present, kind)
        shape = [values.get(slot.quantity.name, (math.nan,))[0] for slot in present.effect.shapes]
        found = {key: Measured(*pair) for key, pair in values.items()}
        effects.append(AxisEffect(present.effect, shape=tuple(shape), quantities=found))
    quantities = {name: Measured(*pair) for name, pair in stored.model.parameters.values.items()}
    moves = response(stored.model, None if baseline is None else baseline.response)
    return State("model", True, quantities, tuple(effects), rig={"kind": kind.name}, response=moves)


def response(model: AxisModel, like: Response | None = None) -> Response:
    """Run a model, with drive and speeds laid out as for `like`, else for itself; SimulationError if it diverged."""
    own = model.parameters
    least = max(OVER_FRICTION * own.coulomb_friction / own.inertia, LEAST[own.kind.turns])
    inertia, acceleration = (own.inertia, least) if like is None else (like.inertia, like.acceleration)
    wide = BANDWIDTH * inertia
    drive = Cascade(BANDWIDTH / 5.0, wide, wide * BANDWIDTH / 6.0, inertia, model.peak_effort, TICK)
    torque = run(Plant(model, drive, TICK), _references(acceleration)).torque
    kept = torque[np.linspace(0, torque.size - 1, INSTANTS + 1).astype(np.intp)[1:]]
    return Response(inertia, acceleration, tuple(kept.tolist()))


def _references(acceleration: float) -> References:
    time: Array = TICK * np.arange(round(DURATION / TICK) + 1, dtype=np.float64)
    omega = 2.0 * np.pi * np.array(FREQUENCIES)
    speeds = np.array(SHARES) * acceleration / omega
    velocity = np.minimum(time / FADE, 1.0) * (speeds @ np.sin(omega[:, None] * time))
    return References(time, integrated(velocity, TICK), velocity, np.gradient(velocity, TICK))


def compare_models(baseline: State, now: State, allowed: Allowed) -> Checked:
    """Whether a model is the same as that of the baseline: its values, its effects, and how it moves."""
    effects = matched(baseline, now)
    pairs = [("", baseline.quantities, now.quantities)]
    pairs += [(f"{old.label}.", old.quantities, new.quantities) for old, new in (*effects.both, *effects.renamed)]
    angles = {f"{one.label}.{q.name}" for one in baseline.effects for q in one.effect.quantities if q.angle}
    comparisons = []
    for owner, before, after in pairs:
        for name in (name for name in before if name in after):
            key, was, value = owner + name, before[name], after[name].value
            away, margin = value - was.value, allowed.margin_of(key, was, baseline)
            if key in angles:  # by the shorter way round
                away, margin = math.remainder(away, 2.0 * math.pi), ANGLE
            if not math.isfinite(away):
                away = 0.0 if value == was.value else math.inf
            comparisons.append(_exact(key, was.unit, (was.value, value), away, margin))
    for how, changed in (("gone", effects.gone), ("appeared", effects.appeared)):
        comparisons += [Comparison(e.label, "", None, None, (), 0.0, how, chance=0.0, result=CHANGED) for e in changed]
    if baseline.response is not None and now.response is not None:
        before, after = np.array(baseline.response.torque), np.array(now.response.torque)
        values, margin = (rms(before), rms(after)), RESPONSE * rms(before)
        comparisons.append(_exact(RESPONSE_TORQUE, now.kind.effort_unit, values, rms(after - before), margin))
    return Checked.of(comparisons, baseline, now, effects)


def _exact(name: str, unit: str, values: tuple[float, float], away: float, margin: float) -> Comparison:
    same = away == 0.0 or abs(away) <= margin < math.inf  # a share of an infinite value is no margin
    difference = Difference(away, 0.0)
    return Comparison(name, unit, *values, (difference,), margin, chance=float(same), result=SAME if same else CHANGED)
