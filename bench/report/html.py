"""A document as HTML: one file that opens without any other and without a network, or beside a script file for many."""

from __future__ import annotations

import base64
import hashlib
import json
from functools import cache
from importlib.resources import files
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from bench.names import plain
from bench.report.document import Document, File, Moving, TimeGraph
from bench.report.drawing import drawn, laid, rail


def html(document: Document, script: str | None = None) -> str:
    """The page of a document.

    Args:
        document: what it says.
        script: address, as seen from the page, of the script file that it shares with others; inside of it without.
    """
    blocks = [block for section in document.sections for block in section.blocks]
    lively = any(isinstance(block, TimeGraph | Moving) for block in blocks)
    inside = program() if lively and script is None else None
    return (
        _environment()
        .get_template("page.html.j2")
        .render(
            page=document,
            style=Markup(f"{_asset('uplot', 'uPlot.min.css')}\n{_asset('assets', 'page.css')}"),
            script=None if inside is None else Markup(inside),
            shared=script if lively else None,
            policy=_policy(inside),
        )
    )


def program() -> str:
    """uPlot and the page's own scripts, for inside of a page or for a file of its own."""
    own = (_asset("assets", name) for name in ("page.js", "motion.js"))
    return "\n".join((_asset("uplot", "uPlot.iife.min.js"), *own))


@cache
def _asset(*parts: str) -> str:
    return files("bench.report").joinpath("page", *parts).read_text(encoding="utf-8")


@cache
def _environment() -> Environment:
    found = Environment(
        loader=PackageLoader("bench.report", "page/templates"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True, finalize=_shown,
    )  # fmt: skip
    found.filters |= {"data": _data, "link": _link, "drawn": drawn, "laid": laid, "rail": rail}
    return found


def _shown(value: Any) -> Any:  # noqa: ANN401 - whatever a template prints
    """Text with the characters written out that would turn the direction of what follows."""
    return plain(value) if type(value) is str else value


def _data(graph: TimeGraph | Moving) -> Markup:
    """A graph or a motion as JSON inside of a script element, which no text in it can end."""
    text = json.dumps(graph.model_dump(), ensure_ascii=True, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _link(file: File) -> str:
    """A file as an address."""
    return f"data:{file.media};base64,{base64.b64encode(file.content.encode()).decode('ascii')}"


def _policy(inside: str | None) -> str:
    """What a browser may do for the page: run this script or one beside it, and load nothing from anywhere."""
    if inside is None:
        scripts = "'self' file:"
    else:
        scripts = f"'sha256-{base64.b64encode(hashlib.sha256(inside.encode()).digest()).decode('ascii')}'"
    return f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src {scripts}; base-uri 'none'"
