"""Recordings of drawn cases as files, simulated side by side and kept for the next run."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor, as_completed
from pathlib import Path

from tests.cases import record, write_case
from tests.kept import INTEGRATOR
from tests.studies.blind.draw import Drawn, noise_of, strength_of

#: Half of the shortest control period; the integrator's own step is all of it - s.
LONGEST_STEP = 31.25e-6
#: Cases simulated together at most: more cost no less each.
TOGETHER = 120

HERE = Path(__file__).resolve().parent


def home(seed: int, duration: float, control_period: float | None) -> Path:
    """Folder of the recordings; another one as soon as integrator or draw are changed."""
    digest = hashlib.sha256()
    for path in (*INTEGRATOR, HERE / "draw.py", HERE / "record.py"):
        digest.update(path.read_bytes())
    period = "" if control_period is None else f"-{control_period * 1e6:g}us"
    return Path(tempfile.gettempdir()) / f"blind-{digest.hexdigest()[:10]}" / f"{seed}-{duration:g}s{period}"


def truth_of(folder: Path, name: str) -> dict:
    """What is hidden in a case; raises FileNotFoundError if it is not recorded yet."""
    return json.loads((folder / name / "truth.json").read_text(encoding="utf-8"))


def recorded(folder: Path, drawn: Sequence[Drawn], seed: int, pool: Executor) -> Iterator[int]:
    """Record what is not recorded yet; yields how many cases are done, as they are."""
    missing = [case for case in drawn if not (folder / case.name / "truth.json").exists()]
    yield len(drawn) - len(missing)
    together: dict[float, list[Drawn]] = {}
    for case in missing:
        together.setdefault(case.hidden.axis.control_period, []).append(case)
    batches = [cases[k : k + TOGETHER] for cases in together.values() for k in range(0, len(cases), TOGETHER)]
    tasks = [pool.submit(_record, folder, batch, seed) for batch in batches]
    for task in as_completed(tasks):
        yield task.result()


def _record(folder: Path, batch: Sequence[Drawn], seed: int) -> int:
    cases = [case.hidden for case in batch]
    runs = record(cases, seed, numbers=[case.number for case in batch], longest_step=LONGEST_STEP)
    for case, pair in zip(cases, runs, strict=True):
        entry = write_case(folder, case, pair)
        entry |= {
            "strength": strength_of(case.severity) if case.group == "single" else "",
            "sample_period": case.sensors.sample_period,
            "noise": noise_of(case),
            "linear": case.axis.linear,
        }
        # last, since it says that the case is complete
        (folder / case.name / "truth.json").write_text(json.dumps(entry, indent=1), encoding="utf-8")
    return len(batch)
