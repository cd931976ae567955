"""The pages a reader meets, and the commands and examples on them."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from pathlib import Path

from tests.command import Done, bench

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


def examples(name: str) -> list[str]:
    """Blocks of Python on a page."""
    return re.findall(r"^```python\n(.*?)^```", PAGES[name], re.MULTILINE | re.DOTALL)


def run_commands(page: str | list[str], change: Callable[[str], str] = str) -> list[Done]:
    """Run commands of the bench, in the working folder, which holds what they suppose.

    Args:
        page: text of a page, or of a part of it; or some of its commands.
        change: of a command, before it is run; an empty one is not.
    """
    lines = bench_commands(page) if isinstance(page, str) else page
    assert lines or not isinstance(page, str), "no command"
    done = []
    for line in filter(None, map(change, lines)):
        done.append(bench(*shlex.split(line)[1:]))
        assert done[-1].status == 0, f"{line}: {done[-1].err}"
    return done


def run_examples(name: str) -> dict:
    """Run the blocks of Python on a page, in the working folder, one after the other; the names that they make."""
    names: dict = {}
    for block in examples(name):
        exec(compile(block, name, "exec"), names)
    return names
