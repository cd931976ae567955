"""Coverage-guided fuzzing of whatever reads: each input ends in a result or in one line, in bounded time and memory.

    python -m tests.fuzz units --seconds 60
    python -m tests.fuzz readers --runs 1000000 --corpus found/

Targets: units, rig, model, readers. An exception that is no InputError, an input that takes longer than a minute or two
gigabytes ends the run; what was found is written to the working folder as `crash-...` or `timeout-...`, and belongs
into `tests/test_hostile.py`. Needs `atheris` (Linux).
"""

import argparse
import bz2
import gzip
import io
import lzma
import sys
import tempfile
import zipfile
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io

try:
    import atheris

    instrumented = atheris.instrument_imports(include=["bench", "pint", "tomllib"])
except ModuleNotFoundError:  # the options are told without it
    atheris, instrumented = None, nullcontext()

with instrumented:
    from bench.errors import BenchError
    from bench.plant.model_file import load_model
    from bench.rig.rig import load_rig
    from bench.trace.inspect import inspect, to_json
    from bench.units import parse

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(tempfile.mkdtemp(prefix="fuzz-"))


def units(data: bytes) -> None:
    parse(data.decode("utf-8", errors="replace"), "N*m", "units")


def rig(data: bytes) -> None:
    load_rig(written(data, "rig.toml"))


def model(data: bytes) -> None:
    load_model(written(data, "model.toml"))


def readers(data: bytes) -> None:
    to_json(inspect(written(data, "run")))


def written(data: bytes, name: str) -> Path:
    path = FOLDER / name
    path.write_bytes(data)
    return path


TARGETS = {target.__name__: target for target in (units, rig, model, readers)}
#: What a run begins with: small good inputs, and words of their languages.
SEEDS = {
    "units": [b"22.4 kg*cm**2", b"1 m**(1/2)", b"-3e-4 N*m*s/rad", "2 °/s²".encode()],
    "rig": [path.read_bytes() for path in sorted((ROOT / "data" / "rigs").glob("*.toml"))],
    "model": [b'schema = "bench.model/1"\nkind = "rotary"\n[parameters]\nmoment_of_inertia = "0.0022 kg*m**2"\n'],
    "readers": [
        b"time [ms],velocity [deg/s],current [mA]\n0,1,2\n1,2,3\n2,3,4\n",
        b"[key]; [value]\nFlags; 16\n0.Variable; A.Velocity\n0.Data; \n; 0; 1\n; 1; 2\n",
        b"T\nP\nTimestamp(ms) A.Velocity\n0 1\n1 2\n",
        b"Name\tp\nStarttime of export\t132959733843760000\n\nName\tvelocity\nUnit\trad/s\n\n0\t1\n1\t2\n",
        b"EPOS Studio Version:;3\r\n;Velocity actual value;Torque actual value\r\nms;rpm;%\r\n0;1;1,5\r\n1;2;2\r\n",
        b"<Trace><TraceVariable VarName='a'><Values>1,2</Values><Timestamps>1,2</Timestamps></TraceVariable></Trace>",
    ],
}


def containers() -> list[bytes]:
    """Small recordings in the binary formats that are read."""
    columns = {"time_s": np.arange(12) * 1e-3, "velocity_rad_s": np.arange(12.0), "current_A": np.ones(12)}
    rows = "\n".join([",".join(columns), *(",".join(map(str, row)) for row in zip(*columns.values(), strict=True))])
    made = [gzip.compress(rows.encode(), mtime=0), bz2.compress(rows.encode()), lzma.compress(rows.encode())]
    for write in (
        lambda file: pq.write_table(pa.table(columns), file),
        lambda file: np.savez(file, **columns),
        lambda file: scipy.io.savemat(file, columns),
        lambda file: _zipped(file, rows),
    ):
        file = io.BytesIO()
        write(file)
        made.append(file.getvalue())
    return made


def _zipped(file: io.BytesIO, rows: str) -> None:
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("run.csv", rows)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("target", choices=list(TARGETS))
    parser.add_argument("--seconds", type=int, default=0)
    parser.add_argument("--runs", type=int, default=-1)
    parser.add_argument("--corpus", type=Path, default=FOLDER / "corpus")
    asked = parser.parse_args()
    if atheris is None:
        parser.error("the extra `fuzz` is not installed: pip install -e '.[fuzz]'")
    asked.corpus.mkdir(parents=True, exist_ok=True)
    seeds = SEEDS[asked.target] + (containers() if asked.target == "readers" else [])
    for number, seed in enumerate(seeds):
        (asked.corpus / f"seed-{number}").write_bytes(seed)

    def once(data: bytes) -> None:
        try:
            TARGETS[asked.target](data)
        except BenchError as error:
            assert "\n" not in str(error)

    for seed in seeds:
        once(seed)  # so that what is imported on the way is not counted as slow
    limits = [
        "-artifact_prefix=./",
        "-print_final_stats=1",
        "-timeout=60",
        "-rss_limit_mb=2048",
        "-max_len=4096",
        f"-max_total_time={asked.seconds}",
    ]
    atheris.Setup([sys.argv[0], str(asked.corpus), f"-runs={asked.runs}", *limits], once)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
