"""A fleet: every recording of a manifest evaluated once, whatever some of them do, and looked over together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from bench.files import held, keeping, require_writable
from bench.fleet.evaluate import Job, evaluate
from bench.fleet.manifest import Manifest, read_manifest
from bench.fleet.plan import PlannedRecording, Store, plan
from bench.fleet.summary import Summary, summarise
from bench.fleet.table import tabulate, write_table
from bench.jobs.each import each
from bench.jobs.process import Failure, Limits

#: Statuses that another try may change.
UNLUCKY = ("failed", "timed_out")
TABLE = "fleet.parquet"
#: Share of the progress until it is known what is missing.
PLANNING = 0.05


@dataclass(frozen=True)
class Fleet:
    """What was found of a fleet.

    Attributes:
        manifest: of it.
        summary: of them.
        evaluated: how many were evaluated now; the others' results were there.
    """

    manifest: Manifest
    summary: Summary
    evaluated: int


def fleet(
    path: Path,
    out: Path,
    diagnose: bool = False,
    retry: bool = False,
    limits: Limits | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[float], None] = lambda share: None,
    finish: Callable[[Fleet], None] = lambda found: None,
) -> Fleet:
    """Evaluate what has no result yet, and write the table of all.

    Args:
        path: of the manifest.
        out: folder of results and table.
        diagnose: seek effects too.
        retry: what failed or timed out before is done again.
        limits, workers, scheduler: as `bench.jobs.each.each` has them.
        progress: called with the share done.
        finish: called with what was found while no other run writes to the folder.

    Raises:
        InputError: a bad manifest, a folder that cannot be written to, or no scheduler at the address.
    """
    manifest = read_manifest(path)
    tabulate(replace(manifest, table=manifest.table.slice(0, 0)), [], [])  # names that clash are told before any work
    with keeping(manifest.inputs), held(out):
        require_writable(out / TABLE)
        planned = plan(manifest, diagnose, lambda share: progress(PLANNING * share))
        store = Store(out / "results")
        missing = _missing(store, planned, retry)
        keys, jobs = list(missing), list(missing.values())
        for count, (place, result) in enumerate(each(evaluate, jobs, limits, workers, scheduler), 1):
            store.put(keys[place], asdict(result) if isinstance(result, Failure) else result)
            progress(PLANNING + (1.0 - PLANNING) * count / len(jobs))
        results = [one.refusal or store.get(one.key) or {} for one in planned]
        write_table(out / TABLE, tabulate(manifest, planned, results))
        found = Fleet(manifest, summarise(manifest, planned, results), len(jobs))
        finish(found)
    return found


def _missing(store: Store, planned: Sequence[PlannedRecording], retry: bool) -> dict[str, Job]:
    """What is to be evaluated, by the key of its result; recordings that are the same are evaluated once."""
    missing = {}
    for one in planned:
        if one.job is not None and one.key not in missing:
            found = store.get(one.key)
            if found is None or (retry and found["status"] in UNLUCKY):
                missing[one.key] = one.job
    return missing
