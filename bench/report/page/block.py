"""What all parts of a page have in common."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Block(BaseModel):
    """A part of a page: frozen, and an unknown key in it is an error."""

    model_config = ConfigDict(extra="forbid", frozen=True)
