"""Identify recordings and hold what is found against the truth."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.errors import UndeterminedError
from bench.identify.estimate import Estimate, RefusedEstimateError
from bench.identify.regression import identify
from bench.rig.rig import Rig, load_rig
from bench.trace.read import read
from bench.trace.trace import Trace
from bench.validate.independent import write_rig
from tests.blind.draw import draw
from tests.blind.record import home
from tests.coverage.draw import Known
from tests.coverage.table import QUANTITIES, Found, Outcome


def of_nulls(recordings: Sequence[Known]) -> tuple[int, Found]:
    """What is told of axes that lack nothing; a refused recording tells what it determines all the same."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "rig.toml"

        def each() -> Iterable[tuple[Trace, Rig, Sequence[float]]]:
            for known in recordings:
                write_rig(known.axis, path)
                yield known.trace, load_rig(path), (known.axis.inertia, known.axis.viscous, known.axis.coulomb)

        return len(recordings), _found(each())


def of_blind(counts: dict[str, int], seed: int, duration: float) -> dict[str, tuple[int, Found]]:
    """What `identify`, which knows no effect, tells of the blind set's axes, by what is hidden in them."""
    folder = home(seed, duration, None)
    by_hidden: dict[str, list[Path]] = {}
    for case in draw(seed, counts, duration):
        names = [effect.name for effect in case.hidden.effects]
        hidden = names[0] if len(names) == 1 else "two effects"
        by_hidden.setdefault(hidden.replace("_", " "), []).append(folder / case.name)

    def each(places: Sequence[Path]) -> Iterable[tuple[Trace, Rig, Sequence[float]]]:
        for place in places:
            truth, rig = json.loads((place / "truth.json").read_text("utf-8")), load_rig(place / "rig.toml")
            values = [truth[key] for key in ("inertia", "viscous_friction", "coulomb_friction")]
            yield read(place / "run1.csv.gz", rig.trace.columns), rig, values

    return {name: (len(places), _found(each(places))) for name, places in by_hidden.items()}


def _found(each: Iterable[tuple[Trace, Rig, Sequence[float]]]) -> Found:
    found: dict[str, list[Outcome]] = {quantity: [] for quantity in QUANTITIES}
    for trace, rig, truth in each:
        estimate = _estimate(trace, rig)
        names = [rig.axis_kind.parameter(term) for term in (INERTIA, VISCOUS, COULOMB)]
        for quantity, name, true in zip(QUANTITIES, names, truth, strict=True):
            if estimate is not None and name in estimate.parameters:
                told = estimate[name]
                half = 0.5 * (told.ci95[1] - told.ci95[0])
                found[quantity].append(Outcome(told.value / true - 1.0, half / true))
    return found


def _estimate(trace: Trace, rig: Rig) -> Estimate | None:
    try:
        return identify(trace, rig)
    except RefusedEstimateError as refused:
        return refused.estimate
    except UndeterminedError:
        return None
