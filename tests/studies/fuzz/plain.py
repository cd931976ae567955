"""Fuzzing without coverage and without `atheris`: good inputs are cut, spliced and edited, the same way each time.

    python -m tests.studies.fuzz.plain readers --runs 300

An exception that is no refusal ends it; so does an input that takes longer than its deadline, with where it hangs, and
one that asks for memory beyond the bound (MemoryError). That input lies in the working folder then, as `input`.
"""

import argparse
import faulthandler
import random
import re
import resource
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import cycle, islice
from pathlib import Path

import psutil

#: Of one input - s; a good one takes 0.1 s, on a machine that does much else.
DEADLINE = 30.0
#: What the process may take beside what it has when it begins - bytes.
MEMORY = 1 << 31
#: What the languages of the seeds are made of, and numbers at the edges of what is one.
WORDS = [
    *(b"", b"\0", b"\n", b"\r\n", b" ", b"\t", b",", b";", b".", b'"', b"'", b"[", b"]", b"(", b"{", b"}", b"<"),
    *(b"<!--", b"&", b"=", b"**", b"/", b"^", b"-", b"#", b"\xff", b"\xef\xbb\xbf", "²".encode(), "µ".encode()),
    *(b"nan", b"inf", b"-0", b"1e400", b"1e-400", b"1e200", b"9" * 20, b"9" * 400, b"\xff" * 4, b"\0\0\0\x80"),
]  # fmt: skip
_TOKENS = re.compile(rb"\w+|\W")


def fuzz(target: Callable[[bytes], None], seeds: list[bytes], runs: int, deadline: float = DEADLINE) -> None:
    """Give a target its seeds, and then so many mutations of them."""
    for seed in seeds:  # also so that what is imported on the way counts as neither time nor memory of an input
        target(seed)
    most = psutil.Process().memory_info().vms + MEMORY
    resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))
    rng = random.Random(0)
    for seed in islice(cycle(seeds), runs):
        data = mutated(rng, seed, seeds)
        Path("input").write_bytes(data)
        with _within(deadline):
            target(data)


def mutated(rng: random.Random, content: bytes, seeds: list[bytes]) -> bytes:
    """An input with up to four places replaced, a few words each or all that follows, rarely by very much."""
    for _ in range(rng.randint(1, 4)):
        tokens = _TOKENS.findall(content)
        begin = rng.randint(0, len(tokens))
        end = rng.choice([begin, begin, begin + 1, begin + 1, begin + 1, begin + 2, begin + 3, len(tokens)])
        new = rng.choice([rng.choice(WORDS), rng.randbytes(rng.randint(0, 8)), _piece(rng, rng.choice(seeds))])
        content = b"".join([*tokens[:begin], new * rng.choice([1, 1, 1, 1, 1, 2, 2000]), *tokens[end:]])
    return content


def _piece(rng: random.Random, content: bytes) -> bytes:
    begin = rng.randint(0, len(content))
    return content[begin : begin + rng.randint(1, 64)]


@contextmanager
def _within(seconds: float) -> Iterator[None]:
    """End the process where the block takes longer, also in compiled code."""
    faulthandler.dump_traceback_later(seconds, exit=True)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()


def main() -> None:
    from tests.studies.fuzz.targets import TARGETS, once, seeds

    parser = argparse.ArgumentParser(prog="python -m tests.studies.fuzz.plain")
    parser.add_argument("targets", nargs="+", choices=list(TARGETS))
    parser.add_argument("--runs", type=int, default=300, help="of each target")
    asked = parser.parse_args()
    warnings.simplefilter("error")  # a user would read it beside, or in the place of, the one line
    for name in asked.targets:
        fuzz(once(name), seeds(name), asked.runs)


if __name__ == "__main__":
    main()
