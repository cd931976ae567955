"""Servos as MuJoCo's `<position>` actuator, in a file that another MJCF includes, and as those of mjlab and Isaac Lab.

All take the values that MuJoCo's has. mjlab and Isaac Lab delay by whole physics steps; their files hold the delay in
seconds and the step that it is counted in.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from xml.sax.saxutils import escape, quoteattr

#: Shortest timestep whose steps a delay is buffered for - s: a buffer that is too short shortens the delay.
TIMESTEP = 0.0005


def buffered(delay: float, timestep: float) -> int:
    """Samples that a delay - s - is buffered for; none without one."""
    return math.ceil(delay / min(timestep, TIMESTEP)) + 1 if delay > 0.0 else 0


def position_actuator(joint: str, values: Mapping[str, float]) -> str:
    """Text of the file.

    Args:
        joint: its name.
        values: kp - N*m/rad (N/m) -, kv - N*m*s/rad (N*s/m) -, delay - s -, forcerange - N*m (N) - where the limit is
            known; and of the joint damping - N*m*s/rad (N*s/m) -, frictionloss - N*m (N) -, armature - kg*m**2 (kg).
    """
    attributes = {"kp": values["kp"], "kv": values["kv"]}
    if values["delay"] > 0.0:
        attributes |= {"delay": values["delay"], "nsample": buffered(values["delay"], TIMESTEP)}
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


def mjlab_actuators(servos: Mapping[str, Mapping[str, float]]) -> str:
    """Module with an actuator of mjlab 1.6 for each joint, by values as `position_actuator` takes them."""
    return _module(
        "from mjlab.actuator import BuiltinPositionActuatorCfg",
        "#: For `EntityArticulationInfoCfg(actuators=ACTUATORS)`, with an MJCF that has no actuators at these joints.",
        "ACTUATORS = (",
        *(
            f"    BuiltinPositionActuatorCfg(target_names_expr=({re.escape(name)!r},), {_pd(one)}, "
            f"frictionloss={one['frictionloss']:.6g}, viscous_damping={one['damping']:.6g}, "
            f"delay_min_lag=lag({one['delay']:.6g}), delay_max_lag=lag({one['delay']:.6g})),"
            for name, one in servos.items()
        ),
        ")",
    )


def isaaclab_actuators(servos: Mapping[str, Mapping[str, float]]) -> str:
    """The same with `DelayedPDActuatorCfg` of Isaac Lab 2.3 and later on Isaac Sim 5, where friction is an effort."""
    return _module(
        "from isaaclab.actuators import DelayedPDActuatorCfg",
        "#: For `ArticulationCfg(actuators=ACTUATORS)`.",
        "ACTUATORS = {",
        *(
            f"    {name!r}: DelayedPDActuatorCfg(joint_names_expr=[{re.escape(name)!r}], {_pd(one)}, "
            f"friction={one['frictionloss']:.6g}, dynamic_friction={one['frictionloss']:.6g}, "
            f"viscous_friction={one['damping']:.6g}, "
            f"min_delay=lag({one['delay']:.6g}), max_delay=lag({one['delay']:.6g})),"
            for name, one in servos.items()
        ),
        "}",
    )


def _module(classes: str, *lines: str) -> str:
    """A module with the step that a delay is counted in."""
    return "\n".join(
        (
            classes,
            "",
            "#: Physics step of your simulation - s.",
            "STEP = 0.005",
            "",
            "",
            "def lag(delay: float) -> int:",
            '    """Physics steps of a delay - s."""',
            "    return round(delay / STEP)",
            "",
            "",
            *lines,
            "",
        )
    )


def _pd(values: Mapping[str, float]) -> str:
    """What both have under the same names."""
    limit = f", effort_limit={values['forcerange']:.6g}" if "forcerange" in values else ""
    return f"stiffness={values['kp']:.6g}, damping={values['kv']:.6g}{limit}, armature={values['armature']:.6g}"
