"""A document as HTML: one file that opens without any other and without a network, or with a script file for many.

Charts are SVG: here is their geometry; the page's style sheet draws it.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup, escape

from bench.names import plain
from bench.report.document import LARGEST, Chart, Document, Intervals, Moving, Panel, Series, Table, TimeGraph
from bench.report.over_time import coarser, thinned

if TYPE_CHECKING:  # 0.05 s, which only a page has to pay
    from jinja2 import Environment

#: Bytes of a page at most, and intervals that its graphs over time have at least: one for each three pixels.
PAGE, COARSEST = 600_000, 400
#: The same, and instants of a motion at most, on a page of so much that its sections are folded.
FOLDED, INSTANTS = 50, 200
#: How many times fewer intervals each trial has at least.
FEWER = 1.1
#: A section of a page: its heading, and what is below it; and the data of a drawing there.
SECTION = re.compile(r"(<section [^>]*>\n<h2[^>]*>[^<]*</h2>)(.*?)(</section>)", re.DOTALL)
DRAWING = re.compile(r'(<script type="application/json">)(.*?)(?=</script>)', re.DOTALL)

#: Paths of a chart, and its bins.
PATH, BINS = re.compile(r'(?<= d=")[^"]+'), re.compile(r'(?<= data-bins=")[^"]+')
NEEDS_SCRIPT = "This section needs JavaScript; the tables above and the files of the folder contain its numbers."


def html(document: Document, script: str | None = None) -> str:
    """The page of a document.

    `script`: address, as seen from the page, of the script file that it shares with others; without, it is in the page.
    """
    page, intervals = _rendered(document, script), _intervals(document)
    if _size(page) <= PAGE or not intervals:
        return page
    rest = _size(page) - intervals
    thinner = _fitting(document, rest, COARSEST)
    if rest + _intervals(thinner) <= PAGE:
        return _rendered(thinner, script)
    moving = [block for block in document.blocks if isinstance(block, Moving)]
    frames = max((math.ceil(one.count / INSTANTS) for one in moving), default=1)
    rest = _size(_folded(page)) - intervals - sum(len(_data(one)) - len(_data(thinned(one, frames))) for one in moving)
    return _folded(_rendered(_fitting(thinned(document, frames), rest, FOLDED), script))


def _size(page: str) -> int:
    return len(page.encode())


def _fitting(document: Document, rest: int, least: int) -> Document:
    """The document with as many intervals as a page with so many other bytes has room for, but `least` in the longest
    graph.
    """
    room, intervals, times, thinner = max(PAGE - rest, 1), _intervals(document), 1, document
    most = max((graph.count for graph in document.blocks if isinstance(graph, TimeGraph)), default=0) // least
    while intervals > room and times < most:
        times = min(math.ceil(times * max(FEWER, intervals / room)), most)
        thinner = coarser(document, times)
        intervals = _intervals(thinner)
    return thinner


def _folded(page: str) -> str:
    """The page with all but its first section deflated together, from which its script makes them again.

    Numbers of charts come behind all other text. What is deflated already is not deflated again: bins of charts come
    behind that, and the data of drawings stay in their sections.
    """
    texts, paths, bins = list[str](), list[str](), list[str]()

    def fold(section: re.Match[str]) -> str:
        head, below, end = section.groups()
        text = DRAWING.sub(r"\1", below)
        for numbers, of, place in ((paths, PATH, "\1"), (bins, BINS, "\2")):
            numbers.extend(of.findall(text))
            text = of.sub(place, text)
        texts.append(text)
        data = "".join(f"{start}{content}</script>" for start, content in DRAWING.findall(below))
        return f"{head}<div data-folded></div><noscript><p>{NEEDS_SCRIPT}</p></noscript>{data}{end}"

    start = page.index("</section>") + len("</section>")
    rest = SECTION.sub(fold, page[start:])
    content = " ".join([_zipped("\0".join([*texts, *paths]).encode()), *bins])
    folded = f'<script type="text/plain" class="folded">{content}</script>'
    return page[:start] + rest.replace("<footer>", f"{folded}\n<footer>", 1)


def _intervals(document: Document) -> int:
    """Bytes of the page that are intervals of graphs over time, and bins on them."""
    charts = (block for block in (*document.blocks, *document.glance) if isinstance(block, Chart))
    bins = sum(len(_deflated(panel.bins)) for chart in charts for panel in chart.panels if panel.bins is not None)
    return bins + sum(len(_data(block)) for block in document.blocks if isinstance(block, TimeGraph))


def _rendered(document: Document, script: str | None) -> str:
    """The page of a document, with as much as that has."""
    kinds = {type(block) for block in document.blocks}
    seeks = any(isinstance(block, Table) and block.sought for block in document.blocks)
    drawing, moving = bool(kinds & {TimeGraph, Moving}), Moving in kinds
    lively = drawing or seeks
    inside = program(drawing, moving) if lively and script is None else None
    page = _environment().get_template("page.html.j2")
    return page.render(
        page=document,
        style=Markup(f"{_asset('uplot', 'uPlot.min.css')}\n{_asset('assets', 'page.css')}"),
        script=None if inside is None else Markup(inside),
        shared=script if lively else None,
        lively=lively,
        policy=_policy(inside),
    )


def program(drawing: bool = True, moving: bool = True) -> str:
    """The page's own scripts, for inside of a page or for a file of its own: with uPlot for graphs over time, and with
    what moves a drawing.
    """
    parts = [("assets", "seek.js")]
    parts += [("uplot", "uPlot.iife.min.js"), ("assets", "page.js")] if drawing else []
    parts += [("assets", "motion.js")] if moving else []
    body = "\n".join(_asset(*part) for part in parts)
    return f"{_asset('assets', 'inflated.js')}\nunfolded.then(() => {{\n{body}\n}});"


@cache
def _asset(*parts: str) -> str:
    """A part of every page, without its indentation."""
    text = files("bench.report").joinpath("page", *parts).read_text(encoding="utf-8")
    return "\n".join(line.lstrip() for line in text.splitlines())


@cache
def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    found = Environment(
        loader=PackageLoader("bench.report", "page/templates"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True, lstrip_blocks=True, finalize=_shown,
    )  # fmt: skip
    found.filters.update(drawn=drawn, sketched=sketched, laid=laid, rail=rail)
    found.filters["deflated"] = _deflated
    found.filters["coded"] = _coded
    found.filters["zipped"] = lambda text: _zipped(text.encode())
    found.filters["data"] = _data
    found.filters["link"] = lambda file: f"data:{file.media};base64,{base64.b64encode(file.content.encode()).decode()}"
    return found


def _shown(value: Any) -> Any:  # noqa: ANN401 - whatever a template prints
    """Text with the characters written out that would turn the direction of what follows."""
    return plain(value) if type(value) is str else value


def _coded(text: str) -> Markup:
    """Text for a page, in which what is between backticks is code."""
    parts = (escape(_shown(part)) for part in re.split(r"`([^`]+)`", text))
    return Markup("".join(f"<code>{part}</code>" if place % 2 else part for place, part in enumerate(parts)))


def _data(drawing: TimeGraph | Moving) -> Markup:
    return _json(_compressed(drawing.model_dump()))


def _compressed(data: Any) -> Any:  # noqa: ANN401 - any content of a part
    """The data of a drawing, all samples in it in a third to two thirds of their bytes."""
    match data:
        case {"offset": _, "low": low, "high": high}:
            return data | {"low": _deflated(low), "high": None if high is None else _deflated(high)}
        case dict():
            return {key: _compressed(value) for key, value in data.items()}
        case tuple():
            return [_compressed(value) for value in data]
    return data


def _deflated(text: str) -> str:
    """16-bit numbers, both in base 64, in less room.

    Differences from number to number, their signs in the lowest bit, upper bytes before lower ones, deflated.
    """
    steps = np.diff(np.frombuffer(base64.b64decode(text), "<i2"), prepend=np.int16(0))  # modulo 2**16
    folded = ((steps << 1) ^ (steps >> 15)).view(np.uint16)
    halves = np.concatenate([folded >> 8, folded & 0xFF]).astype(np.uint8)
    return _zipped(halves.tobytes())


def _zipped(content: bytes) -> str:
    return base64.b64encode(zlib.compress(content, 9)).decode("ascii")


def _json(content: Mapping[str, Any]) -> Markup:
    """As JSON inside of a script element, which no text in it can end."""
    text = json.dumps(content, ensure_ascii=True, separators=(",", ":"))
    for character in "<>&":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return Markup(text)


def _policy(inside: str | None) -> str:
    """What a browser may do for the page: run this script or one next to it, and load nothing from anywhere."""
    if inside is None:
        scripts = "'self' file:"
    else:
        scripts = f"'sha256-{base64.b64encode(hashlib.sha256(inside.encode()).digest()).decode('ascii')}'"
    return f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src {scripts}; base-uri 'none'"


#: Size of a panel, and of its margins left, right, top, bottom - units of the drawing; one panel alone is wider.
WIDTH, ALONE, HEIGHT = 380.0, 760.0, 230.0
LEFT, RIGHT, TOP, BOTTOM = 58.0, 12.0, 24.0, 42.0
#: Size of a sketch in a row, and what its largest dot takes of each side.
SKETCH, DOT = (150.0, 30.0), 4.0
#: Share of the span that is free around the points.
MARGIN = 0.04
#: Width of a row of intervals, which the page stretches, and ends of the travel of a slide, which is 760 wide.
ROW, TRAVEL = 1000.0, (80.0, 680.0)
#: Labels of an axis at most.
TICKS = 5
#: Styles that have dots, and those that have a line.
DOTTED, LINED = ("dots", "large dots", "rings"), ("line", "dashes", "dotted", "wide")


@dataclass(frozen=True)
class Ruler:
    """From values to the drawing: `low` at `start`, `high` at `stop`; logarithmic where `log`."""

    low: float
    high: float
    start: float
    stop: float
    log: bool = False

    def __call__(self, value: float) -> float:
        """The place of a value."""
        low, high, value = map(math.log10, (self.low, self.high, value)) if self.log else (self.low, self.high, value)
        return round(self.start + (value - low) / (high - low) * (self.stop - self.start), 1)

    @classmethod
    def around(cls, values: Iterable[float], start: float, stop: float, log: bool = False) -> Ruler:
        """A ruler that contains all values with a margin."""
        known = [value for value in values if shown(value, log)] or [1.0 if log else 0.0]
        low, high = min(known), max(known)
        if log:
            margin = (high / low) ** MARGIN if high > low else 2.0
            return cls(low / margin, high * margin, start, stop, log)
        margin = MARGIN * (high - low) or 0.5 * abs(high) or 0.5
        return cls(low - margin, high + margin, start, stop)

    def ticks(self, most: int = TICKS, whole: bool = False) -> list[tuple[float, str]]:
        """Places of round values, or of whole ones, with their labels."""
        if self.log:
            powers = range(math.ceil(math.log10(self.low)), math.floor(math.log10(self.high)) + 1)
            digits = (1.0,) if len(powers) > 1 else (1.0, 2.0, 5.0)
            every = [digit * 10.0**power for power in range(powers.start - 1, powers.stop) for digit in digits]
            every = [value for value in every if self.low <= value <= self.high]
            found = [(value, f"{value:g}") for value in every[:: 1 + len(every) // (most + 1)]]
        else:
            found = ticks(self.low, self.high, most, whole)
        return [(self(value), label) for value, label in found]


def shown(value: float, log: bool) -> bool:
    """Whether a value has a place on an axis."""
    return abs(value) <= LARGEST and (value >= 1.0 / LARGEST or not log)


@dataclass(frozen=True)
class Drawn:
    """A series in the drawing: dots as places, and as paths: dots, a line or an outline, bars to their bounds."""

    series: Series
    dots: Sequence[tuple[float, float]]
    spots: str
    line: str
    bars: str


@dataclass(frozen=True)
class PlacedPanel:
    """A panel in the drawing: values at the ends of its x axis, ticks of both axes, the place of zero where its scale
    contains it, and what is drawn.
    """

    panel: Panel
    width: float
    ends: tuple[float, float]
    x: Sequence[tuple[float, str]]
    y: Sequence[tuple[float, str]]
    zero: float | None
    marks: Sequence[Drawn]


def drawn(chart: Chart, small: bool = False) -> list[PlacedPanel]:
    """All panels: on one scale, or one above the other on a scale each; `small`: even one alone is as wide as many."""
    groups = [[panel] for panel in chart.panels] if chart.stacked else [chart.panels]
    width = ALONE if not small and (chart.stacked or len(chart.panels) == 1) else WIDTH
    placed = []
    for panels in groups:
        every = (series for panel in panels for series in panel.series)
        heights = (value for series in every for value in (*series.y, *series.low, *series.high))
        down = Ruler.around(heights, HEIGHT - BOTTOM, TOP, panels[0].log)
        zero = down(0.0) if down.low < 0.0 < down.high else None
        for panel in panels:
            along = (value for one in panel.series for value in one.x)
            across = Ruler.around(along, LEFT, width - RIGHT, panel.log)
            marks = [_drawn(one, across, down) for one in panel.series]
            ends = across.low, across.high
            placed.append(PlacedPanel(panel, width, ends, across.ticks(whole=panel.counted), down.ticks(), zero, marks))
    return placed


def _drawn(series: Series, across: Ruler, down: Ruler) -> Drawn:
    on_page = ((across, series.x), (down, series.y), (down, series.low), (down, series.high))
    x, y, low, high = (
        [ruler(value) if shown(value, ruler.log) else math.nan for value in values] for ruler, values in on_page
    )
    dots = [(a, b) for a, b in zip(x, y, strict=False) if math.isfinite(a) and math.isfinite(b)]
    around = dots if series.style in LINED else []
    if series.style == "band":
        around = [*zip(x, low, strict=False), *zip(x[::-1], high[::-1], strict=False)]
    marks = dots if series.style in DOTTED else []
    bars = list(zip(x, low, high, strict=True)) if series.style in DOTTED and low else []
    return Drawn(
        series,
        marks,
        _path(marks, "m", "h0"),
        line(around),
        "".join(f"M{at:g},{bottom:g}V{top:g}" for at, bottom, top in bars if math.isfinite(at + bottom + top)),
    )


def line(points: Sequence[tuple[float, float]]) -> str:
    """A path through points in tenths, in steps, which take half of what places take."""
    return _path(points, "l") if len(points) > 1 else ""


def _path(points: Sequence[tuple[float, float]], step: str, after: str = "") -> str:
    """A path from point to point in steps of this kind, with the same after each point."""
    tenths = [(round(10.0 * x), round(10.0 * y)) for x, y in points]
    steps = (f"{_tenth(c - a)},{_tenth(d - b)}" for (a, b), (c, d) in pairwise(tenths))
    between = f"{after}{step if after else ' '}"
    start = "".join(f"M{x:g},{y:g}{after}" for x, y in points[:1])
    return f"{start}{step}{between.join(steps)}{after}" if len(points) > 1 else start


def _tenth(number: int) -> str:
    """A number of tenths without the zero before its point."""
    text = f"{number / 10.0:g}"
    return text.replace("0.", ".", 1) if abs(number) < 10 else text


def sketched(parts: Sequence[Series]) -> list[Drawn]:
    """A drawing without axes in the row of a table."""
    (wide, high), x = SKETCH, [value for one in parts for value in one.x]
    across = Ruler.around(x, DOT, wide - DOT)
    down = Ruler.around((value for one in parts for value in (*one.y, *one.low, *one.high)), high - DOT, DOT)
    return [_drawn(one, across, down) for one in parts]


def ticks(low: float, high: float, most: int, whole: bool = False) -> list[tuple[float, str]]:
    """Round values within bounds, or whole ones, with labels of as many digits as distinguish them."""
    from matplotlib.ticker import MaxNLocator  # 0.1 s, which only a chart on a page has to pay

    every = MaxNLocator(most, integer=whole, min_n_ticks=1 if whole else 2).tick_values(low, high)
    places = [float(value) for value in every if low <= value <= high]
    step = min(np.diff(places), default=1.0)
    size = max(map(abs, places), default=1.0)
    if size >= 1e5 or size < 1e-3:
        return [(value, f"{value:.3g}".replace("-", "−")) for value in places]
    decimals = next((n for n in range(9) if abs(round(step, n) - step) < 1e-6 * step), 9)
    return [(value, f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")) for value in places]


def laid(block: Intervals) -> dict[str, Sequence[Any]]:
    """Rows of intervals in the drawing, cut at the limits of the scale, the band behind them, and the scale's ticks.

    Each row has its span, the places of value and bounds, and whether the value lies beyond the scale.
    """
    low, high = block.limits
    ruler, rows = Ruler(low, high, 0.0, ROW, block.log), []
    for span in block.spans:
        places = (ruler(min(max(value, low), high)) for value in (span.value, span.low, span.high))
        rows.append((span, *places, not low <= span.value <= high))
    return {
        "rows": rows,
        "right": [ruler(min(max(value, low), high)) for value in block.right],
        "ticks": ruler.ticks(),
    }


def rail(motion: Moving) -> list[tuple[float, str]]:
    """Places along the rail that a slide is drawn on, with their labels."""
    return Ruler(motion.low, motion.high, *TRAVEL).ticks(8)
