"""The field's words: none of a list of private ones in what users read, and hardly any in docstrings and comments."""

import ast
import io
import re
import tokenize
from itertools import chain
from pathlib import Path

import pytest

from tests.docs.pages import PAGES

ROOT = Path(__file__).parents[2]
#: What to write, and a pattern of what it is written instead of.
WORDS = {
    "residual": r"\b(is|are|was|were|be|nothing|what|much|more|none|little|than) left\b(?! out\b)"
    r"|\bleft (over|unexplained)\b|\bleaves\b(?! (\w+ ){0,3}out\b)",
    "with, next to, in addition to": r"\bbesides?\b",
    "depends on, correlates with": r"\b(hangs?|hanging|hung) (on|together)\b",
    "report, show, distinguish, determine": r"\b(tells?|told|telling|says?|said|saying|knows)\b",
    "is, is given in": r"\b(stands|stood)\b(?! still)",
    "contains, is valid": r"\bholds\b(?! (its|the) (torque|axis|load|joint|position))",
    "confirms": r"\b(bears?|borne|bore|bearing) (it |them |this )?out\b",
    "fitted, predicted, computed from": r"\b(makes?|made|making) of\b",
    "check, test": r"\b(asks|asked|asking)\b(?! for)",
    "unknown effect, alternative": r"\b(none of|outside) the catalogue\b|\brivals?\b",
    "no missing effect found": r"\bnothing is missing\b",
    "standing still": r"\brests\b",
    "separate, difference": r"\bapart\b|\beach alone\b",
    "mains interference": r"\bhums?\b",
    "weakly coupled, free-running, needs attention": r"\bsoftly\b|\blet free\b|\bneeds? a person\b",
    "again": r"\b(anew|aught|thereof|wherein)\b",
    "the reason, not its history": r"\bshared case\b|\bpair \d+\b",
}
#: Occurrences in docstrings and comments: names of attributes, messages of other tools.
MOST = 20


def private(text):
    """Private words of a text outside of code and of names of files."""
    prose = re.sub(r"```.*?```|`[^`\n]*`|\]\([^)]*\)", "", text, flags=re.DOTALL)
    found = (re.finditer(pattern, prose, re.IGNORECASE) for pattern in WORDS.values())
    return [prose[max(one.start() - 30, 0) : one.end() + 20].strip() for one in chain.from_iterable(found)]


def split(path):
    """Sentences among the strings of a module, and its docstrings and comments."""
    source = path.read_text(encoding="utf-8")
    nodes = list(ast.walk(ast.parse(source)))
    said = {id(node.value) for node in nodes if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)}
    texts = [node for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    comments = (one.string for one in tokenize.generate_tokens(io.StringIO(source).readline))
    strings = [one.value for one in texts if id(one) not in said and " " in one.value.strip()]
    return strings, [*(one.value for one in texts if id(one) in said), *(c for c in comments if c.startswith("#"))]


@pytest.fixture(scope="module")
def modules():
    return [split(path) for top in ("bench", "docs") for path in sorted((ROOT / top).rglob("*.py"))]


def test_pages_of_the_documentation_have_none():
    assert {name: found for name, page in PAGES.items() if (found := private(page))} == {}


def test_strings_that_users_read_have_none(modules):
    templates = (path.read_text(encoding="utf-8") for path in (ROOT / "bench").rglob("*.j2"))
    texts = chain(templates, (text for strings, _ in modules for text in strings))
    assert [found for text in texts for found in private(text)] == []


def test_docstrings_and_comments_have_hardly_any(modules):
    found = [one for _, texts in modules for text in texts for one in private(text)]
    assert len(found) <= MOST, found


def test_a_private_word_is_found():
    assert private("what is left of it stands beside `what is left`") == [
        "what is left of it stands beside",
        "what is left of it stands beside",
        "what is left of it stands beside",
    ]
