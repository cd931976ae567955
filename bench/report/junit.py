"""A check as JUnit XML, which every CI server reads: a test case for each comparison.

`changed` is a failure, `undecided` is skipped with the reason, `same` passes.
"""

from __future__ import annotations

import re
from xml.etree import ElementTree

from bench.baseline.check import Checked
from bench.baseline.wording import described, headline
from bench.comparison.difference import CHANGED, UNDECIDED
from bench.names import plain

#: Characters that XML 1.0 does not have at all, escaped or not.
_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def check_junit(checked: Checked, title: str) -> str:
    """The check as JUnit XML.

    Args:
        checked: what was found.
        title: of the suite.
    """
    counts = {result: sum(one.result == result for one in checked.comparisons) for result in (CHANGED, UNDECIDED)}
    numbers = {
        "tests": str(len(checked.comparisons)),
        "failures": str(counts[CHANGED]),
        "errors": "0",
        "skipped": str(counts[UNDECIDED]),
    }
    suites = ElementTree.Element("testsuites", {"name": "bench check", **numbers})
    suite = ElementTree.SubElement(suites, "testsuite", {"name": text(title), **numbers})
    for one in checked.comparisons:
        case = ElementTree.SubElement(suite, "testcase", {"classname": "bench.check", "name": text(one.name)})
        sentence = text(described(one, checked))
        if one.result == CHANGED:
            ElementTree.SubElement(case, "failure", {"message": sentence, "type": "changed"}).text = sentence
        elif one.result == UNDECIDED:
            ElementTree.SubElement(case, "skipped", {"message": sentence})
    ElementTree.SubElement(suite, "system-out").text = text(headline(checked))
    ElementTree.indent(suites)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, encoding="unicode") + "\n"


def text(given: str) -> str:
    """Text that XML can hold: control characters written out."""
    return _NO_XML.sub("", plain(given))
