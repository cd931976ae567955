"""A fleet: every recording of a manifest evaluated once, whatever some of them do, and looked over together."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from bench.errors import InputError
from bench.files import held, keeping, require_writable, whole
from bench.fleet.evaluate import Job, PlannedRecording, evaluate, plan
from bench.fleet.manifest import Manifest, read_manifest
from bench.fleet.store import Plain, Store
from bench.fleet.summary import Summary, summarise
from bench.jobs.each import each
from bench.jobs.process import Failure, Limits

#: Statuses that another try may change.
UNLUCKY = ("failed", "timed_out")
#: Of a recording whose result was in the store before, and no longer is.
LOST = {"status": "failed", "reason": "its result was removed from the folder, or changed, while the fleet ran"}
TABLE, RESULTS = "fleet.parquet", "results"
#: Share of the progress until it is known what is missing.
PLANNING = 0.05
NUMBER, TEXT, TEXTS = pa.float64(), pa.string(), pa.list_(pa.string())
#: Of each parameter, by what follows its name; and of the gaps of torque (force) and velocity.
OF_PARAMETER = {"": ("value", NUMBER), "_std_error": ("std_error", NUMBER), "_unit": ("unit", TEXT)}
OF_GAP = {"": "after", "_before": "before", "_noise_floor": "noise_floor", "_unit": "unit"}


@dataclass(frozen=True)
class Fleet:
    """What was found of a fleet; `evaluated` is how many were evaluated now, the others' results were there.

    Recordings as planned and their results are those of the manifest's rows (n,).
    """

    manifest: Manifest
    planned: Sequence[PlannedRecording]
    results: Sequence[Plain]
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
    storages: Sequence[str] = (),
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
        storages: that the manifest may name in addition to `bench.fleet.evaluate.STORAGES`, by fsspec's names.

    Raises:
        InputError: a bad manifest, a folder that cannot be written to, or no scheduler at the address.
    """
    manifest = read_manifest(path)
    tabulate(replace(manifest, table=manifest.table.slice(0, 0)), [], [])  # names that clash end it before any work
    with keeping(manifest.inputs), held(out):
        require_writable(out / TABLE)
        planned = plan(manifest, diagnose, storages, limits, workers, lambda share: progress(PLANNING * share))
        store = Store(out / RESULTS)
        missing = _missing(store, planned, retry)
        keys = list(missing)
        for count, (place, result) in enumerate(each(evaluate, missing.values(), limits, workers, scheduler), 1):
            store.put(keys[place], asdict(result) if isinstance(result, Failure) else result)
            progress(PLANNING + (1.0 - PLANNING) * count / len(keys))
        stored = {key: store.get(key) for key in dict.fromkeys(one.key for one in planned if one.job is not None)}
        results = [one.refusal or stored[one.key] or dict(LOST) for one in planned]
        with whole(out / TABLE) as temporary:
            pq.write_table(tabulate(manifest, planned, results), temporary)
        found = Fleet(manifest, planned, results, summarise(manifest, planned, results), len(keys))
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


def tabulate(manifest: Manifest, planned: Sequence[PlannedRecording], results: Sequence[Plain]) -> pa.Table:
    """The manifest's columns, and behind them what was found (n rows); InputError where both have one name."""
    table = manifest.table.replace_schema_metadata(None)
    for name, kind, values in _columns(planned, results):
        if name in manifest.table.column_names:
            found = "found a column that the fleet's table has too"
            raise InputError(f"{manifest.path}: {name}", found, "allowed: another name for it")
        table = table.append_column(name, pa.array(values, kind))
    return table.combine_chunks()


def _columns(
    planned: Sequence[PlannedRecording], results: Sequence[Plain]
) -> Iterator[tuple[str, pa.DataType, list[Any]]]:
    """Name, type and values (n,) of each column; empty where no result has it."""
    for name in ("status", "reason"):
        yield name, TEXT, [found[name] for found in results]
    parameters = [found.get("parameters", {}) for found in results]
    for name in dict.fromkeys(name for one in parameters for name in one):  # that any recording determines
        for ending, (key, kind) in OF_PARAMETER.items():
            yield name + ending, kind, [one.get(name, {}).get(key) for one in parameters]
    yield "verdict", TEXT, [found.get("verdict") for found in results]
    effects = [found.get("effects") for found in results]  # None where none were sought
    yield "names", TEXTS, [None if one is None else [effect["name"] for effect in one] for one in effects]
    yield "explained", NUMBER, [found.get("explained") for found in results]
    for of in ("torque", "velocity"):
        gaps = [found.get("gap", {}).get(of, {}) for found in results]
        for ending, key in OF_GAP.items():
            yield f"gap_{of}{ending}", TEXT if key == "unit" else NUMBER, [gap.get(key) for gap in gaps]
    yield "checks", TEXTS, [[check["name"] for check in found.get("checks", [])] for found in results]
    yield "version", TEXT, [one.basis["version"] for one in planned]
    yield "rig_sha256", TEXT, [one.basis["rig_sha256"] for one in planned]
    yield "trace_sha256", TEXT, [found.get("trace_sha256") for found in results]
    yield "options", TEXT, [json.dumps(one.basis["options"], sort_keys=True) for one in planned]
    yield "result", TEXT, [one.key or None for one in planned]
