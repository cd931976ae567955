"""The pages a reader meets, and the commands on them."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
#: Everything written by hand, by its path from the root.
PAGES = {
    str(path.relative_to(ROOT)): path.read_text(encoding="utf-8")
    for path in [
        *(ROOT / f"{name}.md" for name in ("README", "CONTRIBUTING", "SECURITY", "CHANGELOG")),
        *sorted(DOCS.glob("*.md")),
        *sorted(DOCS.glob("notebooks/*.md")),
    ]
}


def commands(page: str) -> list[str]:
    """Lines of the blocks of shell commands on a page, those that go on in the next line joined, without comments."""
    blocks = re.findall(r"^```sh\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    blocks += re.findall(r"(?:^    (?:bench|python|pytest) .*\n)+", page, re.MULTILINE)
    lines = [line for block in blocks for line in block.replace("\\\n", " ").splitlines() if line.strip()]
    return [" ".join(shlex.quote(word) for word in shlex.split(line, comments=True)) for line in lines]


def spoken(page: str) -> list[str]:
    """Commands within the text of a page, in part or as a whole."""
    text = re.sub(r"^```.*?^```", "", page, flags=re.MULTILINE | re.DOTALL)
    text = re.sub(r"\s*\n\s*", " ", text)
    return re.findall(r"`((?:bench|python -m tests\.|python -m pytest|pytest) ?[^`]*)`", text)


def bench_commands(page: str) -> list[str]:
    """Those of its blocks that are the bench's own."""
    return [line for line in commands(page) if line.startswith("bench ")]
