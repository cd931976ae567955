"""Names from outside are text: whatever characters they hold, a terminal, a log or a page shows them and obeys none."""

from __future__ import annotations

import difflib
import inspect
import os
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import wraps
from numbers import Integral, Real
from pathlib import Path
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

#: Control characters (a terminal obeys them), those that turn the direction of text, and halves of surrogates (no
#: encoding has them; Python reads file names that are not UTF-8 so). Line ends and tabs are not among them.
_OBEYED = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")
#: Persons after whom something is called.
_PERSONS = re.compile(r"\b(coulomb|stribeck)\b")
#: What a cut may have left of a word; what is longer is none.
_FIRST_WORD, _LAST_WORD = re.compile(r"^\S{0,19}\s+"), re.compile(r"\s+\S{0,19}$")
#: Words of a quantity's name that may be left out, and symbols of the equation of motion.
_FILLING = frozenset(("moment", "of", "moving", "coefficient", "torque", "force"))
_SYMBOLS = {"J": "inertia", "m": "mass", "K_w": "viscous_friction", "K_0": "coulomb_friction"}
#: Shares below it are not distinguished.
LEAST_SHARE = 1e-3
#: Words of pandas, scikit-learn, statsmodels and of signal processing, and the bench's for the same.
OTHER_WORDS = {
    "ci": "ci95", "std": "std_error", "stderr": "std_error", "params": "parameters", "r2": "explained",
    "residual": "residuals", "probability": "probabilities", "fs": "sample_rate", "sampling_rate": "sample_rate",
    "dt": "sample_period", "t": "time", "to_pandas": "to_frame", "to_dataframe": "to_frame", "to_csv": "save",
    "read_csv": "read", "load": "read", "version": "__version__", "report": "summary", "to_dict": "model_dump",
    "residuals": "torque_residuals", "rsquared": "explained", "score": "explained", "fittedvalues": "fitted_values",
    "cov": "covariance", "corr": "correlation", "coef_": "parameters", "resid": "residuals",
    "from_dataframe": "from_arrays", "from_pandas": "from_arrays", "from_dict": "from_arrays", "from_arrays": "of",
}  # fmt: skip
#: Methods of a data frame that a result has through its own.
OF_FRAMES = frozenset(("describe", "head", "sample", "tail"))
#: What other libraries have under a name that is none here, and what does the same; arguments end with `=`.
INSTEAD = {
    "before": ".torque and .velocity, each with .identify (before, after) and .holdout",
    "compare": "bench.check(recording, rig, baseline)",
    "conf_int": ".to_frame() has low and high, and .ci95 of each parameter",
    "effects": "bench.list_effects() of the catalogue, bench.diagnose(recording, rig).effects of an axis",
    "error": ".velocity_residuals and .torque_residuals",
    "from_csv": "bench.read(path)",
    "iloc": "[first:last], or .to_frame().iloc",
    "load": "bench.read(path) of a recording, bench.load_rig(path) of a rig",
    "loc": ".between(start, stop), or .to_frame().loc",
    "plot": ".plot() of a trace or a result",
    "plot_forest": "bench.check(recording, rig, baseline).plot()",
    "predict": "bench.replay(found, recording, rig)",
    "rigs": "bench.load_rig(name), with a name that the command bench list prints",
    "replay": "bench.replay(found, recording, rig)",
    "simulate": "bench.replay(found, recording, rig)",
    "color=": "the axes that plot() returns: axes.lines[0].set_color(...)",
    "to_toml": ".to_dict(), whose tables bench.Rig(**tables) takes",
    "kt=": 'rig={"motor": {"torque_constant": kt}}',
    "time=": 'all signals in one, {"time": ..., "velocity": ...}',
    "torque_constant=": 'rig={"motor": {"torque_constant": ...}}',
    "verbose=": "print(result), .checks, .warnings",
    "x=": 'plot("velocity"): all signals are over time',
    "y=": 'plot("velocity")',
}
#: Types by the words of annotations, and in words.
_KINDS: dict[str, tuple[type, str]] = {
    "None": (type(None), "None"),
    "bool": (bool, "True or False"),
    "int": (Integral, "a whole number"),
    "float": (Real, "a number"),
    "str": (str, "a text"),
    "Path": (os.PathLike, "a path"),
    "Collection": (Collection, "several in a list"),
    "Mapping": (Mapping, "a dictionary"),
    "Sequence": (Sequence, "several in a list"),
    "Size": (tuple, "width and height in inch, e.g. (7, 4)"),
}
#: The innermost brackets of an annotation.
_WITHIN = re.compile(r"\[[^][]*\]")
_NUMBER = re.compile(r"[+-]?\d+([.,]\d+)?([eE][+-]?\d+)?")


def plain(text: str) -> str:
    r"""The text with such characters written out, e.g. `\x1b`."""
    text = _OBEYED.sub(lambda match: match[0].encode("unicode_escape").decode("ascii"), text)
    # by `##[` GitHub recognises an old command anywhere in a line
    return text.replace("##[", "## [") if "GITHUB_ACTIONS" in os.environ else text


def words(name: str) -> str:
    """A name of the bench in words, e.g. `Coulomb friction torque` for `coulomb_friction_torque`."""
    return _PERSONS.sub(lambda match: match[0].capitalize(), name.replace("_", " ").replace("back emf", "back-EMF"))


def percent(share: float) -> str:
    """A share in per cent, with two digits below ten."""
    if 0.0 < share < LEAST_SHARE:
        return f"< {100.0 * LEAST_SHARE:g} %"
    text = f"{100.0 * share:z.0f}" if not 0.0 < share < 0.1 else f"{100.0 * share:.2g}"
    return f"{text} %".replace("-", "−")


def counted(count: int, one: str, many: str = "") -> str:
    """A count and what it is of: `1 recording`, `2 recordings`; `many` where an s is not enough."""
    return f"{count} {one if count == 1 else many or f'{one}s'}"


def cell(text: str) -> str:
    """The text as a cell of a CSV that no spreadsheet takes for a formula: an apostrophe is put before one."""
    formula = text[:1] in ("=", "+", "-", "@", "\t", "\r") and _NUMBER.fullmatch(text) is None
    return f"'{text}" if formula else text


def readable(path: object) -> str:
    r"""A path, or any text, on one line in any encoding: control characters and bytes that are not UTF-8 written out.

    Those of a file name are `\xff`; a line end is `\n`.
    """
    text = str(path).encode("utf-8", errors="surrogateescape").decode("utf-8", errors="backslashreplace")
    return plain(text).replace("\n", r"\n").replace("\t", r"\t")


def in_a_row(paths: Iterable[Path]) -> str:
    """Names of files as text, without their folders, e.g. for a title."""
    return ", ".join(readable(path.name) for path in paths)


def short(text: str, most: int = 200) -> str:
    """The text in at most `most` characters: beginning and end where it is longer, of whole words."""
    if len(text) <= most:
        return text
    half = (most - 5) // 2
    return f"{_LAST_WORD.sub('', text[:half])} ... {_FIRST_WORD.sub('', text[-half:])}"


def meant(name: str, known: Mapping[str, T]) -> T:
    """The entry of a name, or of one without the words that distinguish no two entries; KeyError with the nearest.

    `inertia` or `J` is the moment of inertia, `coulomb_friction` or `K_0` the Coulomb friction torque.
    """
    if not isinstance(name, str):
        raise KeyError(f"found {name!r}; allowed: one of {', '.join(map(str, known)) or 'none'}")
    if name not in known:
        alike = [each for each in known if _telling(each) == _telling(_SYMBOLS.get(name, name))]
        if len(alike) != 1:
            raise KeyError(f"{name}: found none{nearest(name, [*known])}; allowed: {', '.join(known) or 'none'}")
        (name,) = alike
    return known[name]


def _telling(name: str) -> frozenset[str]:
    return frozenset(name.split("_")) - _FILLING


def same_as(name: str, known: Collection[str]) -> str | None:
    """What the bench calls an attribute that other libraries call `name`; None where none of `known` is that."""
    while (name := OTHER_WORDS.get(name, "")) and name not in known:
        pass
    return name or None


def instead(name: str, known: Sequence[str]) -> str:
    """What does the same as an attribute or argument that is not there, or the nearest, and all that are."""
    other = f"; instead: {INSTEAD[name]}" if name in INSTEAD else nearest(name.rstrip("="), [*known])
    return f"{other}; allowed: {', '.join(known) or 'no argument'}"


def nearest(name: str, names: list[str]) -> str:
    """`, did you mean ...?` for a mistyped name, or nothing when no known name is near."""
    match = difflib.get_close_matches(name, names, n=1)
    return f", did you mean '{match[0]}'?" if match else ""


def with_known_arguments(function: Callable[P, T]) -> Callable[P, T]:
    """The function, whose error for an argument that it does not take is one line with those that it takes."""

    @wraps(function)
    def called(*args: P.args, **given: P.kwargs) -> T:
        try:
            return function(*args, **given)
        except (AttributeError, TypeError, ValueError) as error:
            said = mistake(function, args, given)
            if said is None:
                raise
            raise TypeError(said) from error

    return called


def mistake(function: Callable[..., object], args: Sequence[object], given: Mapping[str, object]) -> str | None:
    """What is wrong with the arguments of a call, by the function's signature; None where nothing is."""
    signature = inspect.signature(function)
    known = [name for name in signature.parameters if name not in ("self", "cls")]
    name = function.__name__ if function.__name__ != "__init__" else function.__qualname__.split(".")[-2]
    takes_any = any(each.kind is each.VAR_KEYWORD for each in signature.parameters.values())
    for argument in () if takes_any else given:
        if argument not in known:
            return f"{name}() has no argument '{argument}'{instead(f'{argument}=', known)}"
    try:
        bound = signature.bind(*args, **given)
    except TypeError as error:
        return f"{name}(): {error}; allowed: {', '.join(known) or 'no argument'}"
    for argument, value in bound.arguments.items():
        kinds = _kinds(signature.parameters[argument], getattr(inspect.unwrap(function), "__globals__", {}))
        if kinds and not isinstance(value, tuple(kind for kind, _ in kinds)):
            allowed = " or ".join(word for _, word in kinds)
            return f"{name}(): {argument}: found {short(repr(value), 60)}; allowed: {allowed}"
    return None


def _kinds(parameter: inspect.Parameter, known: Mapping[str, object]) -> list[tuple[type, str]]:
    """Types that an annotation names, each in words; none of one that names anything else."""
    found = []
    outer = _WITHIN.sub("", _WITHIN.sub("", str(parameter.annotation)))
    for word in map(str.strip, outer.split("|")):
        module, _, name = word.rpartition(".")
        kind = _KINDS.get(word) or (getattr(known.get(module), name, known.get(word)), f"a {word}")
        protocol = getattr(kind[0], "_is_protocol", False)
        if parameter.kind is parameter.VAR_POSITIONAL or protocol or not isinstance(kind[0], type):
            return []
        found.append(kind)
    return found
