"""Reader of LeRobot's datasets, version 2 and 3: Parquet of lists, whose places `meta/info.json` names.

https://huggingface.co/docs/lerobot/lerobot-dataset-v3: `features` has for each column its `names`, a list or one under
another key; the files of `data/` hold episodes one after another, each with times from zero. Units are stated nowhere.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from bench.bounds import require_size
from bench.errors import InputError
from bench.files import read_bytes, read_text
from bench.structured import parse_json
from bench.trace.channel import Channel, Recording
from bench.trace.readers.arrow import MAGIC, channels_of_table, parquet_table
from bench.trace.source import FileFormat, Source

#: Sample periods between two episodes: a hole.
BETWEEN = 10.0


#: The description of a dataset, from its root.
_INFO = "meta/info.json"


def _recognises(source: Source) -> bool:
    if source.content.startswith(MAGIC):
        return _root(source) is not None
    return source.path.endswith(_INFO) and '"features"' in source.head and '"codebase_version"' in source.head


def _root(source: Source) -> Path | None:
    """Folder of the dataset that a file of `data/chunk-000` is of."""
    return next((one for one in Path(source.path).parents[1:3] if (one / _INFO).is_file()), None)


def _read(source: Source) -> Recording:
    root = _root(source) or Path(source.path).parent.parent
    info = parse_json(read_text(root / _INFO, "the description of a dataset"), root / _INFO)
    whole = not source.content.startswith(MAGIC)
    files = sorted(root.glob("data/**/*.parquet")) if whole else [Path(source.path)]
    if not files:
        raise InputError(root, "found no Parquet under data", "allowed: a LeRobot dataset with its data")
    require_size(root, sum(file.stat().st_size for file in files))
    tables = [parquet_table(read_bytes(file, "a file of a dataset"), str(file)) for file in files]
    try:
        table = pa.concat_tables(tables)
    except pa.ArrowInvalid as error:
        raise InputError(root, "found files of different columns", "allowed: those of one dataset") from error
    channels = channels_of_table(table, str(root), dict(_names(info.get("features", {}))))
    of = {channel.name: channel for channel in channels}
    if not {"timestamp", "episode_index"} <= set(of):
        allowed = "allowed: timestamp and episode_index, as a LeRobot dataset has them"
        raise InputError(root, f"found columns {', '.join(list(of)[:8])}", allowed)
    time, count = _one_after_another(of["timestamp"], of["episode_index"].values)
    joined = f"{count} episodes in sequence, a hole between each two"
    notes = ("times are those of LeRobot's frames, not of the sensors", *([joined] if count > 1 else []))
    kept = tuple(time if one.name == "timestamp" else one for one in channels)
    return Recording(kept, LEROBOT.format, str(root), notes=notes, usual_units={"time": "s"})


LEROBOT = FileFormat("LeRobot dataset", (), _recognises, _read)


def _names(features: Mapping[str, Any]) -> Iterator[tuple[str, list[str]]]:
    """Names of the places of each column that has any."""
    for name, feature in features.items():
        names = feature.get("names") if isinstance(feature, dict) else None
        names = next(iter(names.values()), None) if isinstance(names, dict) else names
        if isinstance(names, list) and all(isinstance(one, str) for one in names):
            yield name, names


def _one_after_another(time: Channel, episode: np.ndarray) -> tuple[Channel, int]:
    """Times (n,) of episodes that each begin at zero, as those of one recording; and how many episodes there are."""
    values = time.values.astype(np.float64)
    step = np.diff(values)
    gap = BETWEEN * float(np.median(step[step > 0.0])) if (step > 0.0).any() else 1.0
    starts = np.flatnonzero(np.diff(episode)) + 1
    shift = np.zeros(values.size)
    for start in starts:
        shift[start:] = shift[start - 1] + values[start - 1] + gap - values[start]
    return replace(time, values=values + shift), starts.size + 1
