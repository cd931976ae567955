"""Coverage-guided fuzzing of whatever reads: each input ends in a result or in one line, in bounded time and memory.

    python -m tests.studies.fuzz units --seconds 60
    python -m tests.studies.fuzz readers --runs 1000000 --corpus found/

Targets: units, rig, model, readers. An exception that is no BenchError, an input that takes longer than a minute or two
gigabytes ends the run; what was found is written to the working folder as `crash-...` or `timeout-...`, and belongs
into `tests/test_hostile.py`. Needs `atheris` (Linux); `tests.studies.fuzz.plain` does without.
"""

import argparse
import sys
from contextlib import nullcontext
from pathlib import Path

try:
    import atheris

    instrumented = atheris.instrument_imports(include=["bench", "pint", "tomllib"])
except ModuleNotFoundError:  # the options are listed without it
    atheris, instrumented = None, nullcontext()

with instrumented:
    from tests.studies.fuzz.targets import TARGETS, folder, once, seeds


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.studies.fuzz")
    parser.add_argument("target", choices=list(TARGETS))
    parser.add_argument("--seconds", type=int, default=0)
    parser.add_argument("--runs", type=int, default=-1)
    parser.add_argument("--corpus", type=Path, default=folder() / "corpus")
    asked = parser.parse_args()
    if atheris is None:
        parser.error("the extra `fuzz` is not installed: pip install -e '.[fuzz]', or take tests.studies.fuzz.plain")
    asked.corpus.mkdir(parents=True, exist_ok=True)
    tried = once(asked.target)
    for number, seed in enumerate(seeds(asked.target)):
        (asked.corpus / f"seed-{number}").write_bytes(seed)
        tried(seed)  # so that what is imported on the way is not counted as slow
    limits = [
        "-artifact_prefix=./",
        "-print_final_stats=1",
        "-timeout=60",
        "-rss_limit_mb=2048",
        "-max_len=4096",
        f"-max_total_time={asked.seconds}",
    ]
    atheris.Setup([sys.argv[0], str(asked.corpus), f"-runs={asked.runs}", *limits], tried)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
