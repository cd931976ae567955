"""Recordings of the independent integrator, kept on disk: made once, however many processes of tests ask for them."""

from __future__ import annotations

import hashlib
import inspect
import os
import pickle
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from bench.files import whole
from bench.trace.trace import Trace
from bench.validation import independent

T = TypeVar("T")
#: Files that decide on what the integrator makes of a case.
INTEGRATOR = (
    *sorted(Path(independent.__file__).parent.rglob("*.py")),
    *(Path(__file__).with_name(name) for name in ("cases.py", "outside.py")),
)


def kept(make: Callable[[], T], *made_by: str | bytes) -> T:
    """What `make` returned when it was last called with the integrator, its callers and traces as they are now.

    Args:
        make: simulates; its result is pickled.
        made_by: files that say what is simulated, the caller's `__file__` first; bytes say it themselves.
    """
    digest = hashlib.sha256()
    of_trace = Path(inspect.getfile(Trace))
    for one in (of_trace, *made_by, *INTEGRATOR):
        digest.update(one if isinstance(one, bytes) else Path(one).read_bytes())
    folder = Path(tempfile.gettempdir()) / f"servobench-tests-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    path = folder / f"{Path(str(made_by[0])).stem}-{digest.hexdigest()[:16]}.pickle"
    if path.exists():
        return pickle.loads(path.read_bytes())
    result = make()
    with whole(path) as part:
        part.write_bytes(pickle.dumps(result))
    return result
