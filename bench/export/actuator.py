"""A servo as MuJoCo's `<position>` actuator, in a file that another MJCF includes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from xml.sax.saxutils import escape, quoteattr

#: Shortest timestep whose steps a delay is buffered for - s: a buffer that is too short shortens the delay.
TIMESTEP = 0.0005


def position_actuator(joint: str, values: Mapping[str, float]) -> str:
    """Text of the file.

    Args:
        joint: its name.
        values: kp - N*m/rad (N/m) -, kv - N*m*s/rad (N*s/m) -, delay - s -, forcerange - N*m (N) - where the limit is
            known; and of the joint damping - N*m*s/rad (N*s/m) -, frictionloss - N*m (N) -, armature - kg*m**2 (kg).
    """
    attributes = {"kp": values["kp"], "kv": values["kv"]}
    if values["delay"] > 0.0:
        attributes |= {"delay": values["delay"], "nsample": math.ceil(values["delay"] / TIMESTEP) + 1}
    text = " ".join(f'{name}="{value:.6g}"' for name, value in attributes.items())
    if "forcerange" in values:
        text += f' forcerange="{-values["forcerange"]:.6g} {values["forcerange"]:.6g}"'
    of_joint = " ".join(f'{name}="{values[name]:.6g}"' for name in ("armature", "damping", "frictionloss"))
    return (
        "<mujoco>\n"
        f"  <!-- The joint {escape(joint).replace('--', '- -')} is to have {of_joint}. -->\n"
        "  <actuator>\n"
        f"    <position name={quoteattr(f'{joint} servo')} joint={quoteattr(joint)} {text}/>\n"
        "  </actuator>\n"
        "</mujoco>\n"
    )
