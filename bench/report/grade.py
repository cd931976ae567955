"""A published MJCF compared with a log: a table for the robot's page and README, and a badge."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from bench.joints.grade import NEAR, GradedJoint, Stated
from bench.names import readable, words
from bench.report import document as doc
from bench.report.numbers import interval, share
from bench.report.serial import as_json

TABLE, BADGE = "grade.md", "grade.svg"
LABEL = "MJCF agrees with a log"
#: Colours of a badge from a share of the joints on, and where the log determines none.
COLOURS, GREY = {1.0: "#2e7d32", 0.5: "#b26a00", 0.0: "#b3261e"}, "#5f6368"
#: Mean width of a letter of a badge - px.
LETTER = 6.6


def grade_section(grade: Mapping[str, GradedJoint], title: str) -> doc.Section:
    """The table, and both files to take along."""
    headings = ("joint", "armature", "damping", "frictionloss", "lacks~")
    rows = [(name, *map(_number, joint.numbers.values()), _lacks(joint)) for name, joint in grade.items()]
    caption = f"Values of {title} in SI; that of the log follows if the two differ by more than its interval and "
    caption += share(NEAR)
    lines = (headings, ("---",) * len(headings), *rows)
    cells = ([escape(readable(one.removesuffix("~"))).replace("|", "&#124;") for one in line] for line in lines)
    text = "\n".join(f"| {' | '.join(line)} |" for line in cells)
    files = doc.downloads(
        doc.file(TABLE, "this table for a README", f"![{LABEL}: {_share(grade)}]({BADGE})\n\n{caption}.\n\n{text}\n"),
        doc.file(BADGE, "a badge for it", _badge(grade)),
    )
    return doc.section(
        "grade", "Grade", doc.Paragraph(text=_sentence(grade, title)), doc.table(caption, headings, rows), files
    )


def grade_json(grade: Mapping[str, GradedJoint]) -> dict[str, Any]:
    """Of each joint: its numbers as stated and as found, whether they agree, and what it lacks."""

    def found(number: Stated) -> dict[str, Any]:
        log = None if number.found is None else as_json(number.found)
        return {"stated": number.value, "found": log, "agrees": number.near}

    return {
        name: {"agrees": joint.agrees, "lacks": joint.lacks} | {key: found(one) for key, one in joint.numbers.items()}
        for name, joint in grade.items()
    }


def _counts(grade: Mapping[str, GradedJoint]) -> tuple[int, int]:
    """Of joints that agree, and of those that the log determines."""
    agree = [joint.agrees for joint in grade.values() if joint.agrees is not None]
    return sum(agree), len(agree)


def _share(grade: Mapping[str, GradedJoint]) -> str:
    agree, determined = _counts(grade)
    return f"{agree} of {determined} joints" if determined else "no joint determined"


def _sentence(grade: Mapping[str, GradedJoint], title: str) -> str:
    agree, determined = _counts(grade)
    rest = f" The log determines nothing of {len(grade) - determined} joints." if determined < len(grade) else ""
    return f"{agree} of {len(grade)} joints of {title} agree with the log in every value that it determines.{rest}"


def _number(number: Stated) -> str:
    """As stated; as found where that differs."""
    log = "not determined" if number.found is None else interval(number.found, unit=False)
    return f"{number.value:.4g}" if number.near else f"{number.value:.4g}, log: {log}"


def _lacks(joint: GradedJoint) -> str:
    return "not determined" if joint.lacks is None else ", ".join(map(words, joint.lacks)) or "nothing found"


def _badge(grade: Mapping[str, GradedJoint]) -> str:
    """An SVG of two fields, the result and the number of joints."""
    agree, determined = _counts(grade)
    colour = next(colour for least, colour in COLOURS.items() if agree >= least * determined) if determined else GREY
    share, width = _share(grade), [int(LETTER * len(text)) + 14 for text in (LABEL, _share(grade))]
    return f"""<svg xmlns="http://www.w3.org/2000/svg" width="{sum(width)}" height="20" role="img">
<title>{LABEL}: {share}</title>
<rect width="{width[0]}" height="20" fill="#444"/>
<rect x="{width[0]}" width="{width[1]}" height="20" fill="{colour}"/>
<g fill="#fff" font-family="Verdana,sans-serif" font-size="11" text-anchor="middle">
<text x="{width[0] / 2}" y="14">{LABEL}</text>
<text x="{width[0] + width[1] / 2}" y="14">{share}</text>
</g>
</svg>
"""
