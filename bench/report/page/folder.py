"""A page in a folder: `report.html`, and `report.json`, from which it can be regenerated."""

from __future__ import annotations

import os
from pathlib import Path
from urllib.parse import quote

from pydantic import ValidationError

from bench.errors import InputError
from bench.files import held, read_text, write_text
from bench.names import short
from bench.report.page.blocks import Page
from bench.report.page.render import html, program

HTML, DATA = "report.html", "report.json"


def write_page(folder: Path, page: Page) -> list[Path]:
    """Write a page and what it is made of into a folder; returns both paths."""
    with held(folder):
        write_text(folder / DATA, page.model_dump_json() + "\n")
        write_text(folder / HTML, html(page))
    return [folder / HTML, folder / DATA]


def write_html(path: Path, page: Page) -> None:
    """Write a page alone into a file that a person named.

    Raises:
        InputError: another ending than .html, or a place that cannot be written to.
    """
    if path.suffix.lower() not in (".html", ".htm"):
        raise InputError(path, f"found the ending '{path.suffix}'", "allowed: .html")
    write_text(path, html(page))


def rebuild(folders: list[Path], script: Path | None = None) -> list[Path]:
    """Regenerate the pages of folders from their data.

    Args:
        folders: with a `report.json` each.
        script: file to write that all of them share; each holds its own without.

    Returns:
        Paths written.

    Raises:
        InputError: a folder without a page's data, or data of something else.
    """
    pages = {folder: read_page(folder / DATA) for folder in folders}
    written = []
    if script is not None:
        write_text(script, program())
        written.append(script)
    for folder, page in pages.items():
        beside = None if script is None else _address(script, folder)
        with held(folder):
            write_text(folder / HTML, html(page, beside))
        written.append(folder / HTML)
    return written


def read_page(path: Path) -> Page:
    """The page of a `report.json`.

    Raises:
        InputError: no such file, or one that holds no page.
    """
    if path.parent.is_dir() and not path.exists():
        raise InputError(path.parent, f"found no {DATA}", "allowed: a folder that --out of a command wrote")
    text = read_text(path, "the data of a page")
    try:
        return Page.model_validate_json(text)
    except ValidationError as error:
        detail = error.errors()[0]
        key = ".".join(str(part) for part in detail["loc"]) or "page"
        found = f"found {short(repr(detail['input']), 60)}"
        raise InputError(f"{path}: {key}", found, f"allowed: {detail['msg'][0].lower()}{detail['msg'][1:]}") from error


def _address(script: Path, folder: Path) -> str:
    """Of a file as seen from a folder."""
    return quote(Path(os.path.relpath(script.resolve(), folder.resolve())).as_posix())
