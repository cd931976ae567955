"""Links lead somewhere, sources of the method are cited in the code, and generated pages say what objects say."""

import re
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest

import bench
from bench.effects.catalogue import catalogue
from bench.effects.torque import Torque
from bench.trace.read import read
from bench.units import Quantity
from tests.diagnosis.command import started
from tests.docs.pages import DOCS, PAGES, ROOT, bench_commands
from tests.sources import SOURCES

sys.path.insert(0, str(DOCS / "_ext"))
import command_pages
import effect_pages
import signature


def links(page):
    """Files that a page's text links to, as a git host shows them."""
    text = re.sub(r"^```.*?^```", "", page, flags=re.MULTILINE | re.DOTALL)
    return [link for link in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text) if not link.startswith("http")]


def test_links_lead_to_files():
    leading = [(name, link) for name, page in PAGES.items() for link in links(page)]
    assert len(leading) > 100
    assert [(name, link) for name, link in leading if not ((ROOT / name).parent / link).exists()] == []


#: Folders of pages that are made while the site is built, and pages that include a file beside the folder.
MADE = tuple(f"docs/{folder}/" for folder in ("reference", "_build", "jupyter_execute"))
INCLUDED = {f"docs/{name}.md": f"{name.upper()}.md" for name in ("contributing", "security", "changelog")}
#: A table of a page whose first cell links the table that a study wrote: the link, and the rows.
QUOTED = re.compile(r"^\| \[[^]]+\]\(([^)]+)\)[^\n]*\n\|[-|]+\n((?:\|.*\n)+)", re.MULTILINE)


def linked(name):
    """Paths from the root that a page of the docs links to, by its path from the root."""
    path = ROOT / name
    text = path.read_text(encoding="utf-8") if path.suffix == ".md" else ""
    return {str((path.parent / link).resolve().relative_to(ROOT)) for link in links(text)}


def test_the_index_leads_to_every_page_in_two_clicks():
    once = linked("docs/index.md")
    reached = once.union(*map(linked, once))
    pages = {str(path.relative_to(ROOT)) for path in DOCS.rglob("*.md")}
    written = {INCLUDED.get(name, name) for name in pages if not name.startswith(MADE)}
    assert written - reached == {"docs/index.md"} - reached


def test_figures_of_the_validation_are_in_the_tables_that_it_links():
    quoted = QUOTED.findall(PAGES["docs/validation.md"])
    assert len(quoted) >= 6
    for target, rows in quoted:
        table = (DOCS / target).read_text(encoding="utf-8")
        for some, of in re.findall(r"(\d+) of (\d+)", rows):
            assert f"{some} of {of}" in table or f"{some}/{of}" in table, f"{target}: {some} of {of}"
        for share in re.findall(r"\| ([\d.]+) % \|", rows):
            assert f"| {share} |" in table, f"{target}: {share} %"


def test_the_readme_leads_to_the_index():
    assert "](docs/index.md)" in PAGES["README.md"]


#: A year in brackets or behind a name, as the text cites it, and the first author of each source of the list.
METHOD, _, LISTED = PAGES["docs/method.md"].partition("## Sources\n")


def first_author(source):
    """Surname of the first author, without accents that the code leaves out."""
    name = re.match(r"- (?:(?:[A-Z]\.[- ]?)+ ?)?([^,]+?)(?: et al\.)?,", source)[1]
    return name.split("-")[0] if name.startswith("Armstrong") else name


def plainly(text):
    return text.translate(str.maketrans("öéá", "oea"))


@cache
def blocks_of_text():
    """Docstrings and parts between empty lines of all modules."""
    text = plainly("\n".join(path.read_text(encoding="utf-8") for path in SOURCES))
    return re.split(r"\n\s*\n|\"\"\"", text)


def uncited(source):
    """What is missing of a source's citations, in the text or in the code."""
    author = first_author(source)
    if author not in METHOD:
        return f"{author} is listed and not cited"
    blocks = [part for part in blocks_of_text() if plainly(author) in part]
    years = re.findall(r"(?<!\d)(?:19|20)\d\d(?!\d)", source.split("-")[0] if "arXiv" in source else source)[:1]
    missing = [year for year in years if not any(year in part for part in blocks)]
    return f"no module cites {author} {' '.join(missing)}" if missing or not blocks else ""


def test_every_source_of_the_method_is_one_that_the_code_cites():
    sources = LISTED.strip().replace("\n  ", " ").splitlines()
    assert len(sources) > 20
    assert [missing for source in sources if (missing := uncited(source))] == []
    assert uncited("- N. Obody, *Nothing*, 1900.") == "Obody is listed and not cited"


def test_every_public_name_is_in_the_reference():
    for name in bench.__all__:
        assert f"bench.{name}\n" in PAGES["docs/python.md"] or name == "__version__"


def test_the_page_of_an_effect_says_what_the_effect_says():
    for effect in catalogue().values():
        text = effect_pages.page(effect, None)
        assert effect.summary in text
        for quantity in effect.quantities:
            assert f"| `{quantity.name}` |" in text, effect.name
        assert re.search(r"## Equation\n\n```text\n.+\n", text), effect.name
        assert re.search(r"## In MuJoCo\n\n- ", text), effect.name


class Creep(Torque):
    """An effect of somebody else's."""

    name = "belt_creep"
    summary = "the belt creeps"
    quantities = (Quantity("rate", "r_c", "1/s", lower=0.0, null=0.0),)

    def torque(self, values, axis, at):
        """In proportion to | the * rate."""
        return values["rate"]


def test_an_effect_of_another_package_has_a_page_too():
    assert not signature.shown(Creep())
    text = effect_pages.page(Creep(), None)
    assert "| `rate` | r\\_c | `1/s` | `1/s` | from 0 | 0 |" in text
    assert "In proportion to \\| the · rate." in text


def test_the_picture_is_of_the_recording_that_the_pages_commands_make(tmp_path, monkeypatch):
    """And of an unbalance it shows the position, the motions that tell it, and what is added to the MJCF."""
    effect = catalogue()["unbalance"]
    found = signature.signature(effect)
    monkeypatch.chdir(tmp_path)
    run = started(tmp_path)
    Path("axis.toml").write_bytes(signature.RIG.read_bytes())
    text = effect_pages.page(effect, found)
    (line, _) = bench_commands(text)
    assert run(*line.split()[1:]) == 0
    recorded = read("run.csv.gz")
    assert recorded["velocity"] == pytest.approx(found.affected["velocity"], abs=1e-6)
    assert "position" in {axes.get_xlabel().split(" /")[0] for axes in signature.drawn(found).axes[:1]}
    assert all(found.motions[name] > 2.0 for name in ("identification", "slow_reversals", "multisine"))
    assert found.shares[effect] > 0.99
    assert "```xml\n<general " in text
    signature.draw(found, Path("unbalance.png"))
    assert Path("unbalance.png").stat().st_size > 20_000


def test_the_page_of_a_command_has_all_its_options():
    found = command_pages.commands()
    assert {"identify", "diagnose", "export", "list"} <= set(found)
    for name, command in found.items():
        text = command_pages.page(name, command)
        assert text.startswith(f"# bench {name}\n")
        for parameter in command.params:
            assert parameter.help.split()[0] in text
            assert all(option in text for option in parameter.opts if option.startswith("--"))


def test_docstrings_are_text():
    pytest.importorskip("sphinx", reason="needs Sphinx (pip install -e '.[docs]')")
    import docstrings

    lines = ["Torque - N*m - of `x`, |omega|.", "", "    M = J*alpha", "", "Args:", "    a_b: N*m."]
    docstrings.as_text(ModuleType("app"), "function", "f", None, None, lines)
    assert lines[0] == r"Torque - N\*m - of ``x``, \|omega\|."
    assert lines[2:5] == ["::", "", "    M = J*alpha"]
    assert lines[-1] == r"    a_b: N\*m."
