"""Pages that are made while the documentation is built: one for each effect, and one for each command."""

from __future__ import annotations

import os
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from sphinx.application import Sphinx

import bench
import command_pages
import effect_pages
import signature
from bench.effects.catalogue import catalogue

HERE = Path(__file__).resolve().parent
#: What pages and pictures of effects are made from: a change in any renders all again.
MADE_FROM = (*Path(bench.__file__).parent.rglob("*.py"), *HERE.glob("*.py"), signature.RIG)


def generate(app: Sphinx) -> None:
    """Write all pages below `reference` in the source folder."""
    reference = Path(app.srcdir) / "reference"
    effects(reference / "effects")
    found = command_pages.commands()
    pages = {f"{name}.md": command_pages.page(name, command) for name, command in found.items()}
    write(reference / "commands", pages | {"table.txt": command_pages.table(found)})


def effects(folder: Path) -> None:
    """Pages and pictures of all effects, side by side on all cores, unless none of what they are made from changed."""
    names = sorted(catalogue())
    done = folder / "done"
    if done.exists() and done.stat().st_mtime > max(path.stat().st_mtime for path in MADE_FROM):
        return
    folder.mkdir(parents=True, exist_ok=True)
    with ProcessPoolExecutor(max_workers=os.cpu_count()) as beside:
        made = dict(zip(names, beside.map(one_effect, names, [folder] * len(names)), strict=True))
    write(folder, {f"{name}.md": text for name, text in made.items()} | {"table.txt": table(names)})
    done.touch()


def one_effect(name: str, folder: Path) -> str:
    """Page of an effect; its picture is written."""
    effect = catalogue()[name]
    found = signature.signature(effect) if signature.shown(effect) else None
    if found is not None:
        signature.draw(found, folder / f"{name}.png")
    return effect_pages.page(effect, found)


def table(names: Iterable[str]) -> str:
    """All effects."""
    return effect_pages.table([catalogue()[name] for name in names])


def write(folder: Path, pages: dict[str, str]) -> None:
    """Exactly these pages in a folder; those that are what they were stay untouched."""
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.glob("*.md"):
        if path.name not in pages:
            path.unlink()
    for name, text in pages.items():
        path = folder / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Before sources are looked for."""
    app.connect("builder-inited", generate)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
