"""`[check]` of a rig file: which changes of the axis matter."""

from __future__ import annotations

from pydantic import Field

from bench.rig.values import Table


class Check(Table):
    """What `bench check` allows; quantities by name, each a share such as `"2 %"` or a number with its unit.

    Attributes:
        margin: changes below it do not matter.
        between: standard deviation of one axis from recording to recording.
    """

    margin: dict[str, str] = Field(default_factory=dict)
    between: dict[str, str] = Field(default_factory=dict)
