"""Other people's recordings, beside the project and never in it; tests that need them skip where they are absent."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

SHARED = Path(__file__).resolve().parents[1].parent / "shared"
needs_shared = pytest.mark.skipif(not SHARED.exists(), reason="needs the public recordings in ../shared")


def null_cases():
    """Recordings with nothing hidden and their truth; empty where the shared folder is absent."""
    path = SHARED / "cases" / "truth.json"
    if not path.exists():
        return {}
    cases = json.loads(path.read_text(encoding="utf-8"))
    return {name: case for name, case in cases.items() if case["group"] == "null"}
