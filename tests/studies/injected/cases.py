"""Which effect is put into which recording how strong, what became of it, and a file that keeps it."""

from __future__ import annotations

import json
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from hashlib import sha256
from itertools import product
from pathlib import Path
from zlib import crc32

import numpy as np

import bench
from bench.diagnosis.diagnosis import Diagnosis, diagnose
from bench.errors import BenchError
from bench.trace.write import write
from bench.validation.coverage import of_effects
from bench.validation.independent.effects import KINDS, Effect
from bench.validation.injection import INJECTABLE, disturbance, drawn, injected
from bench.validation.into import FLAGGED, Own, fate, own
from tests.cases import parameters
from tests.studies.blind.score import same, twins
from tests.studies.injected.sources import Source

#: Strengths over what the recording's own diagnosis leaves.
STRENGTHS = (2.0, 5.0)
#: Lags of which a recording shows the difference alone.
OPPOSED = {"current_loop_lag", "current_filter_lag"}
#: Fates beside those of the bench: the axis cannot have the effect so large, and work that gave no result.
UNABLE, FAILED = "unable", "failed"
#: The name of what no catalogue holds, beside names.
NONE = ""


@dataclass(frozen=True)
class Known(Own):
    """A recording before anything is put into it, and names of what is hidden in it, as of a simulated one."""

    hidden: tuple[str, ...] = ()

    @property
    def beside(self) -> tuple[str, ...]:
        """Names of all that it holds."""
        return (*self.names, *self.hidden)


@dataclass(frozen=True)
class Case:
    """An effect that is to be put into a recording; its other parameters hang on the seed and on nothing beside it."""

    source: str
    effect: str
    strength: float
    seed: int

    @property
    def name(self) -> str:
        """Of it alone."""
        return f"{self.source} {self.effect} {self.strength:g}"

    @property
    def own_seed(self) -> int:
        """Of the other parameters."""
        return crc32(f"{self.seed} {self.name}".encode())


def itself(source: Source) -> Known | str:
    """What a recording says before anything is put into it, or why it says nothing."""
    try:
        found = Known(**vars(own(*source.read())))
    except BenchError as refusal:
        return " ".join(str(refusal).split())
    if source.drawn is None:
        return found
    named = same(found.names)
    hidden = tuple(name for name in source.hidden if twins(name) not in named)
    host = replace(found.host, axis=source.drawn.hidden.axis)
    return replace(found, host=host, taken=found.taken.union(*map(twins, hidden)), hidden=hidden)


def possible(effect: str, own: Known) -> bool:
    """Whether an axis can have an effect beside what it has, and show it: one coupling, one friction by its load."""
    beside = {effect, *own.beside}
    return not beside >= OPPOSED and not any(KINDS[name].excludes in beside for name in beside)


def draw(sources: Sequence[str], effects: Sequence[str], seed: int) -> list[Case]:
    """Every effect at every strength in every recording, in an order of its own."""
    every = [Case(*each, seed) for each in product(sources, effects or INJECTABLE, STRENGTHS)]
    order = np.random.default_rng(seed).permutation(len(every))
    return [every[place] for place in order]


@dataclass(frozen=True)
class Row:
    """A case, judged.

    Attributes:
        case: as drawn.
        fate: as `bench.validation.into` has it, or UNABLE or FAILED.
        names, verdict, reason: as there.
        probabilities: of the effect's name, of others that are new, and of `NONE`.
        seconds: of CPU that the diagnosis took - s.
        quantities: true value, value, and both ends of the interval of 95 %, by name.
        hidden: what is in the recording, too, as far as it is known or was named before.
        sets: that hold the truth with 90 %, each of names, or None of the catalogue; empty if it is refused.
    """

    case: Case
    fate: str
    names: tuple[str, ...] = ()
    verdict: str = ""
    reason: str = ""
    probabilities: dict[str, float] = field(default_factory=dict)
    seconds: float = 0.0
    quantities: dict[str, tuple[float, float, float, float]] = field(default_factory=dict)
    hidden: tuple[str, ...] = ()
    sets: tuple[tuple[str, ...] | None, ...] = ()

    @property
    def believed(self) -> float:
        """Probability of the true name."""
        return self.probabilities.get(self.case.effect, 0.0)

    @property
    def line(self) -> str:
        """Of a table."""
        values = "; ".join(
            f"{key} {v:.4g} ({a:.4g} to {b:.4g}), true {t:.4g}" for key, (t, v, a, b) in self.quantities.items()
        )
        case, said = self.case, ", ".join(self.names)
        what = values or self.reason.partition(";")[0]
        cells = (case.source, case.effect, f"{case.strength:g}", self.fate, said, self.verdict, what)
        return f"| {' | '.join(cells)} |"


def effect_of(case: Case, own: Known) -> Effect | None:
    """The effect of a case; None if the axis cannot have it, or has it already."""
    if case.effect in own.taken or not possible(case.effect, own):
        return None
    return drawn(own.host, case.effect, case.strength * own.left, case.own_seed)


def judged(item: tuple[Case, Source, Known]) -> Row:
    """Put in, diagnosed and judged."""
    case, source, own = item
    effect = effect_of(case, own)
    if effect is None:
        return Row(case, UNABLE)
    made, began = source.made_with(own.host, effect), time.process_time()
    try:
        found = diagnose(made, own.host.rig)
    except BenchError as refused:
        reason = " ".join(str(refused).split())
        return Row(case, FLAGGED, reason=reason, probabilities={NONE: 1.0}, hidden=own.beside)
    seconds = time.process_time() - began
    became, new = fate(found, case.effect, own.beside)
    scored = of_effects([effect], own.host.axis, found)
    quantities = {one.quantity: (one.true, one.parameter.value, *one.parameter.ci95) for one in scored}
    beliefs = believed(found, case.effect, own.names)
    sets = tuple(None if names is None else (*sorted(names),) for names in found.probabilities.holding(0.9))
    return Row(case, became, new, found.verdict, "", beliefs, seconds, quantities, own.beside, sets)


def believed(found: Diagnosis, effect: str, own: Sequence[str]) -> dict[str, float]:
    """Probabilities of an effect, or what looks like it, of names that are not the recording's own, of none."""
    likely = found.probabilities.names
    twin = next((one.name for one in found.effects if effect in (one.name, *one.ambiguous_with)), effect)
    others = {name: share for name, share in likely.items() if name not in (effect, twin, *own)}
    return {effect: likely.get(twin, 0.0), **others, NONE: found.probabilities.none}


def kept_in(seed: int) -> Path:
    """File that rows of a seed are appended to; another one as soon as the bench is changed."""
    digest = sha256()
    for path in sorted(Path(bench.__file__).parent.rglob("*.py")):
        digest.update(path.read_bytes())
    return Path(tempfile.gettempdir()) / f"injected-{digest.hexdigest()[:10]}-{seed}.jsonl"


def keep(path: Path, row: Row) -> None:
    """Append a row, on a line of its own even behind one that was cut off: a run goes on where it was killed."""
    with path.open("a", encoding="utf-8") as file:
        file.write(f"\n{json.dumps(asdict(row))}\n")


def kept(path: Path) -> Iterator[Row]:
    """The rows of a file; a last one that was cut off is not there, nor what failed, which is tried again."""
    for line in path.read_text(encoding="utf-8").splitlines() if path.exists() else ():
        try:
            content = json.loads(line)
        except json.JSONDecodeError:
            continue
        quantities = {key: tuple(values) for key, values in content.pop("quantities").items()}
        names, hidden = tuple(content.pop("names")), tuple(content.pop("hidden"))
        sets = tuple(None if one is None else tuple(one) for one in content.pop("sets"))
        case = Case(**content.pop("case"))
        row = Row(case, **content, names=names, quantities=quantities, hidden=hidden, sets=sets)
        if row.fate != FAILED:
            yield row


def write_case(folder: Path, case: Case, source: Source, own: Known) -> bool:
    """Write a case as other sets have them: run1.csv.gz, rig.toml, truth.json; whether the axis can have it."""
    host, effect = own.host, effect_of(case, own)
    if effect is None:
        return False
    made = source.made_with(host, effect)
    whole, beyond = disturbance(host, injected(host, effect))
    folder.mkdir(parents=True, exist_ok=True)
    write(made, folder / "run1.csv.gz")
    # names of columns are the bench's own now
    rig = source.rig.read_text(encoding="utf-8").partition("[trace.columns]")[0]
    (folder / "rig.toml").write_text(rig, encoding="utf-8")
    truth = {
        "effects": [case.effect],
        "group": "injected",
        **asdict(case),
        "real": source.real,
        "own": own.beside,
        "own_verdict": own.verdict,
        "left": own.left,
        "rms": whole,
        "rms_beyond_base": beyond,
        "parameters": {case.effect: parameters(effect, host.axis)},
        "quantities": {case.effect: effect.quantities(host.axis)},
        "inertia": host.axis.inertia,
        "viscous_friction": host.axis.viscous,
        "coulomb_friction": host.axis.coulomb,
    }
    (folder / "truth.json").write_text(json.dumps(truth, indent=1), encoding="utf-8")
    return True
