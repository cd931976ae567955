"""What pydantic finds wrong with the tables of a file, as the one line of the bench."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, get_args

from bench.errors import InputError
from bench.names import nearest, short

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError
    from pydantic_core import PydanticCustomError


def refused(found: str, allowed: str) -> PydanticCustomError:
    """What a validator raises: what was found, and what is allowed; pydantic adds the place."""
    from pydantic_core import PydanticCustomError

    return PydanticCustomError("refused", "{found}; {allowed}", {"found": found, "allowed": allowed})


def input_error(
    source: object, error: ValidationError, known: type[BaseModel] | None = None, root: str = ""
) -> InputError:
    """The first complaint of pydantic as one line that names file, key, what was found and what is allowed.

    Args:
        source: of the tables.
        error: what pydantic found.
        known: of the whole file, whose keys are listed where one is unknown.
        root: what the whole of it is called.
    """
    detail = error.errors()[0]
    keys = [str(key) for key in detail["loc"]]
    place = "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in detail["loc"]).lstrip(".") or root
    where = f"{source}: {place}" if place else str(source)
    context: dict[str, Any] = detail.get("ctx", {})
    if detail["type"] == "refused":
        return InputError(where, context["found"], context["allowed"])
    if detail["type"] == "extra_forbidden" and known is not None:
        names = _known_keys(known, keys[:-1])
        return InputError(where, f"unknown key{nearest(keys[-1], names)}", f"allowed: {', '.join(names)}")
    if detail["type"] == "missing":
        return InputError(where, "missing", "this key is required")
    message = detail["msg"].removeprefix("Value error, ")
    tables = isinstance(detail["input"], dict) or not keys
    found = "inconsistent" if tables else f"found {short(repr(detail['input']))}"
    return InputError(where, found, f"allowed: {message[0].lower()}{message[1:]}")


def _known_keys(table: type[BaseModel], keys: list[str]) -> list[str]:
    """Keys of the table that a path of keys leads to."""
    from pydantic import BaseModel

    for key in keys:
        if key in table.model_fields:
            kind = table.model_fields[key].annotation
            tables = [one for one in (kind, *get_args(kind)) if isinstance(one, type) and issubclass(one, BaseModel)]
            table = tables[0] if tables else table
    return [name for name, field in table.model_fields.items() if not field.exclude]
