"""Checks of a student's notebook: what a result must fulfil, without telling it."""

from __future__ import annotations

from collections.abc import Callable


def check(what: str, holds: Callable[..., object], *values: object) -> bool | None:
    """Print whether a condition holds.

    Args:
        what: must hold, in words.
        holds: asked with the values.
        values: of the student; `...` where a cell is not filled in yet.

    Returns:
        Whether it holds; None while a value is open.
    """
    if any(value is ... for value in values):
        print(f"open: {what}")
        return None
    try:
        found = bool(holds(*values))
    except (TypeError, ValueError, IndexError, AttributeError) as error:
        # a value of another kind or shape than was asked for: the condition does not hold, and why is said
        print(f"not yet: {what} ({type(error).__name__}: {error})")
        return False
    print(f"{'ok' if found else 'not yet'}: {what}")
    return found
