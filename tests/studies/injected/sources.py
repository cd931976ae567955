"""Recordings that effects are put into: the public ones of real axes, and realistic simulated ones."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from bench.assets import asset
from bench.rig.rig import Rig, load_rig
from bench.trace.read import read
from bench.trace.trace import Trace
from bench.validation.independent.effects import Effect
from bench.validation.injection import Host, injected
from tests.cases import record
from tests.shared import SHARED
from tests.studies.blind.draw import Drawn
from tests.studies.frame import workers
from tests.studies.nuisance import realistic
from tests.studies.nuisance.record import home

DATA = SHARED / "data"
#: The pendulum servo at each of its gains.
PENDULUM = " ".join(f"2026-01-15_{at}" for at in ("10h28m32", "10h29m04", "10h29m37", "10h30m10"))


@dataclass(frozen=True)
class Source:
    """A recording of an axis.

    Attributes:
        axis, name: what it is of, and its own; recordings of one axis are rounds of it.
        path, rig: files.
        without: signal that its source spoiled (`real/README.md` says how), empty for none.
        drawn, seed: what a simulated one was simulated of; None of a real one.
    """

    axis: str
    name: str
    path: Path
    rig: Path
    without: str = ""
    drawn: Drawn | None = None
    seed: int = 0

    @property
    def real(self) -> bool:
        """Whether nobody simulated it."""
        return self.drawn is None

    @property
    def hidden(self) -> tuple[str, ...]:
        """Names of what is in a simulated one."""
        return () if self.drawn is None else tuple(effect.name for effect in self.drawn.hidden.effects)

    def read(self) -> tuple[Trace, Rig]:
        """Recording and rig."""
        rig = load_rig(self.rig)
        trace = read(self.path, rig.trace)
        return (trace.without(self.without) if self.without else trace), rig

    def made_with(self, host: Host, effect: Effect) -> Trace:
        """The recording, had the axis had an effect: a simulated one made once more, a real one changed."""
        if self.drawn is None:
            return injected(host, effect)
        hidden = replace(self.drawn.hidden, effects=(*self.drawn.hidden.effects, effect))
        ((first, _),) = record([hidden], self.seed, numbers=[self.drawn.number])
        return first.trace


def _beside(axis: str, names: str, without: str = "") -> Iterator[Source]:
    """Recordings with a rig beside them."""
    folder = DATA / "real" / axis
    for name in names.split():
        yield Source(axis, f"{axis}/{name}", folder / f"{name}.csv.gz", folder / "rig.toml", without)


def _shipped(folder: str, names: str, rig: str, suffix: str) -> Iterator[Source]:
    """Recordings whose rig is shipped."""
    for name in names.split():
        yield Source(folder, f"{folder}/{name}", DATA / folder / f"{name}{suffix}", asset("data", "rigs", rig))


def real() -> list[Source]:
    """The public recordings of one axis that a diagnosis does not refuse as they are."""
    return [
        *_beside("damiao_m1", "r1 r2 r3"),
        *_beside("damiao_m4", "r1 r2 r3", "velocity"),
        *_shipped("emps", "DATA_EMPS DATA_EMPS_PULSES", "emps.toml", ".mat"),
        *_shipped("laas_anticogging", "acc_current speed_test1", "laas.toml", ".txt"),
        *_shipped("bam_xl330", PENDULUM, "bam_xl330.toml", ".json"),
    ]


def simulated(seed: int, count: int, jobs: int) -> list[Source]:
    """Realistic axes, recorded if they are not yet."""
    drawn, folder = realistic.draw(seed, count), home() / f"realistic-{seed}"
    with workers(jobs) as pool, Progress(console=Console(stderr=True)) as progress:
        bar = progress.add_task("recording", total=count)
        for done in realistic.recorded(folder, drawn, seed, pool):
            progress.advance(bar, done)
    homes = [(case, folder / case.name) for case in drawn]
    return [Source(one.name, one.name, one / "run1.csv.gz", one / "rig.toml", "", case, seed) for case, one in homes]
