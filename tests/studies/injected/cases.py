"""Which effect is put into which recording how strong, what became of it, and a file that keeps it."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field, replace
from hashlib import sha256
from itertools import product
from pathlib import Path
from zlib import crc32

import numpy as np

import bench
from bench.errors import BenchError
from bench.trace.write import write
from bench.validation.independent.effects import KINDS
from bench.validation.injection import INJECTABLE, injected
from bench.validation.into import Injection, Own, own, put_into
from bench.validation.severity import disturbance, drawn
from tests.studies.blind.score import same, twins
from tests.studies.injected.sources import Source

#: Strengths over what the recording's own diagnosis leaves.
STRENGTHS = (2.0, 5.0)
#: Lags of which a recording shows the difference alone.
OPPOSED = {"current_loop_lag", "current_filter_lag"}
#: Fates beside those of the bench: the axis cannot have the effect so large, and work that gave no result.
UNABLE, FAILED = "unable", "failed"


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


def itself(source: Source) -> Own | str:
    """What a recording says before anything is put into it, or why it says nothing."""
    try:
        found = own(*source.read())
    except BenchError as refusal:
        return " ".join(str(refusal).split())
    if source.drawn is None:
        return found
    named = same(found.names)
    hidden = tuple(name for name in source.hidden if twins(name) not in named)
    host = replace(found.host, axis=source.drawn.hidden.axis)
    return replace(found, host=host, taken=found.taken.union(*map(twins, hidden)), hidden=hidden)


def possible(effect: str, own: Own) -> bool:
    """Whether an axis can have an effect beside what it has, and show it: one coupling, one friction by its load."""
    beside = {effect, *own.names, *own.hidden}
    return not beside >= OPPOSED and not any(KINDS[name].never_beside in beside for name in beside)


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
        names, verdict, reason, probabilities, seconds: as there.
        quantities: true value, value, and both ends of the interval of 95 %, by name.
        hidden: what is in the recording, too, as far as it is known or was named before.
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

    @classmethod
    def of(cls, case: Case, own: Own, found: Injection | None) -> Row:
        """Of what the bench says."""
        if found is None:
            return cls(case, UNABLE)
        quantities = {one.quantity: (one.true, one.parameter.value, *one.parameter.ci95) for one in found.scored}
        beliefs = dict(found.probabilities)
        answer = found.names, found.verdict, found.reason, beliefs, found.seconds, quantities
        return cls(case, found.fate, *answer, (*own.names, *own.hidden))

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


def judged(item: tuple[Case, Source, Own]) -> Row:
    """Put in, diagnosed and judged."""
    case, source, own = item
    if not possible(case.effect, own):
        return Row(case, UNABLE)
    return Row.of(case, own, put_into(own, case.effect, case.strength, case.own_seed, source.made_with))


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
        row = Row(
            **content | {"case": Case(**content["case"]), "names": names, "quantities": quantities, "hidden": hidden}
        )
        if row.fate != FAILED:
            yield row


def write_case(folder: Path, case: Case, source: Source, own: Own) -> bool:
    """Write a case as other sets have them: run1.csv.gz, rig.toml, truth.json; whether the axis can have it."""
    host = own.host
    able = case.effect not in own.taken and possible(case.effect, own)
    effect = drawn(host, case.effect, case.strength * own.left, case.own_seed) if able else None
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
        "own": (*own.names, *own.hidden),
        "own_verdict": own.verdict,
        "left": own.left,
        "rms": whole,
        "rms_beyond_base": beyond,
        "parameters": {case.effect: effect.truth(host.axis)},
        "quantities": {case.effect: effect.quantities(host.axis)},
        "inertia": host.axis.inertia,
        "viscous_friction": host.axis.viscous,
        "coulomb_friction": host.axis.coulomb,
    }
    (folder / "truth.json").write_text(json.dumps(truth, indent=1), encoding="utf-8")
    return True
