"""Where a document goes: a page by itself, a folder with page, data, figures and files to take along, or Markdown."""

from __future__ import annotations

import os
from pathlib import Path
from urllib.parse import quote

from pydantic import ValidationError

from bench.errors import InputError
from bench.files import held, read_text, write_text
from bench.names import short
from bench.report.document import Code, Document, Paragraph, Points, Table
from bench.report.html import html, program

HTML, DATA = "report.html", "report.json"


def write_document(folder: Path, document: Document, ending: str = ".png") -> list[Path]:
    """Write page, data, pictures and files to take along of a document into a folder; the paths written.

    Args:
        ending: of the pictures, one of `bench.report.figures.FORMATS`.

    Raises:
        InputError: the folder cannot be written to.
    """
    texts = {**{file.name: file.content for file in document.files}, **document.files_in_folder}
    with held(folder):
        write_text(folder / DATA, document.model_dump_json() + "\n")
        write_text(folder / HTML, html(document))
        written = [folder / HTML, folder / DATA]
        if document.pictures:
            from bench.report.figures import drawn, save  # matplotlib: 0.35 s

            for picture in document.pictures:
                written.append(folder / f"{picture.name}{ending}")
                save(drawn(picture), written[-1])
        for name, text in texts.items():
            written.append(folder / name)
            write_text(written[-1], text)
    return written


def write_html(path: Path, document: Document, lasting: bool = True) -> None:
    """Write the page of a document alone into a file; `lasting`: whether it is on the disk before it takes its name.

    Raises:
        InputError: another ending than .html, or a place that cannot be written to.
    """
    _require_ending(path, ".html", ".htm")
    write_text(path, html(document), lasting)


def _require_ending(path: Path, *endings: str) -> None:
    if path.suffix.lower() not in endings:
        raise InputError(path, f"found the ending '{path.suffix}'", f"allowed: {endings[0]}")


def rebuild(folders: list[Path], script: Path | None = None) -> list[Path]:
    """Regenerate the pages of folders from their data; the paths written.

    Args:
        folders: with a `report.json` each.
        script: file to write that all of them share; each contains its own without.

    Raises:
        InputError: a folder without a page's data, or data of something else; a script that is not named .js.
    """
    if script is not None:
        _require_ending(script, ".js", ".mjs")
    documents = {folder: read_document(folder / DATA) for folder in folders}
    written = []
    if script is not None:
        write_text(script, program())
        written.append(script)
    for folder, document in documents.items():
        shared = script and quote(Path(os.path.relpath(script.resolve(), folder.resolve())).as_posix())
        with held(folder):
            write_text(folder / HTML, html(document, shared))
        written.append(folder / HTML)
    return written


def read_document(path: Path) -> Document:
    """The document of a `report.json`.

    Raises:
        InputError: no such file, or one without any.
    """
    if path.parent.is_dir() and not path.exists():
        raise InputError(path.parent, f"found no {DATA}", "allowed: a folder that --out of a command wrote")
    text = read_text(path, "the data of a page")
    try:
        return Document.model_validate_json(text)
    except ValidationError as error:
        detail = error.errors()[0]
        key = ".".join(str(part) for part in detail["loc"]) or "page"
        found = f"found {short(repr(detail['input']), 60)}"
        allowed = short(" ".join(detail["msg"].split()))  # which quotes a kind that there is not, whatever is there
        raise InputError(f"{path}: {key}", found, f"allowed: {allowed[0].lower()}{allowed[1:]}") from error


def markdown(part: object) -> str:
    """A table, a text or a list as Markdown; empty of what only a page can show."""
    match part:
        case Table():
            rule = ["---:" if column.number else "---" for column in part.columns]
            rows = ([column.heading for column in part.columns], rule, *part.rows)
            escaped = ((cell.replace("|", "\\|").replace("\n", " ") for cell in row) for row in rows)
            lines = (f"| {' | '.join(row)} |" for row in escaped)
            return "\n".join([*((f"## {part.caption}", "") if part.caption else ()), *lines])
        case Paragraph():
            return part.text
        case Points():
            return "\n".join(f"- {item}" for item in part.items)
        case Code():
            return f"```\n{part.text}\n```"
        case _:
            return ""
