"""How the pages are built: `python -m sphinx -W -j auto -b html docs docs/_build/html`."""

import hashlib
import logging
import shutil
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "_ext"), str(HERE.parent)]

# before a highlighter of the theme sets logging up to tell everything
logging.basicConfig(level=logging.ERROR)

from pygments.lexers.special import TextLexer
from sphinx.highlighting import lexers

from bench import __version__

# a git host colours tables in text; here they stay plain
lexers["csv"] = TextLexer()

project = "servobench"
author = copyright = "the authors of servobench"  # noqa: A001 - as Sphinx calls it
release = version = __version__
extensions = ["myst_nb", "docstrings", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml", "generated", "outside"]
exclude_patterns = ["_build", "_ext", "jupyter_execute"]
html_theme = "furo"
smartquotes = False
html_title = "servobench"
html_static_path = ["_static"]
html_css_files = ["pages.css"]
html_js_files = ["pages.js"]
html_copy_source = False
# nothing is fetched when a page is read
html_math_renderer = "mathml"
nb_ipywidgets_js = {}
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
# a notebook runs again once it or anything that it runs has changed
made_from = (path for name in ("bench", "data/rigs", "data/motors", "mjcf") for path in (HERE.parent / name).rglob("*"))
digest = hashlib.sha256(
    b"".join(path.read_bytes() for path in sorted(made_from) if path.suffix in (".py", ".toml", ".xml"))
)
nb_execution_mode = "cache"
nb_execution_cache_path = str(HERE / "_build" / "notebooks" / digest.hexdigest()[:16])
for earlier in (HERE / "_build" / "notebooks").glob("*"):
    if str(earlier) != nb_execution_cache_path:
        shutil.rmtree(earlier)
nb_execution_raise_on_error = True
nb_execution_timeout = 120
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
default_role = "code"
napoleon_custom_sections = ["Source"]
