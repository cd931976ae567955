"""What a video shows: the model of an axis, and a translucent copy of what moves in it."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.effects.acting import AXIS, MOTOR
from bench.plant.axis_model import AxisParameters, build_spec
from bench.rig.rig import Load
from bench.view.side_by_side import SideBySide

#: Names of the ghost's parts begin with it.
GHOST = "ghost "
#: Colour of its parts, and of the marks on them; what carries a mark is of this material.
COLOUR, MARKED, MARK = (0.45, 0.65, 0.95, 0.3), (0.1, 0.25, 0.85, 1.0), "mark"
#: A disk's ghost floats in front of it - m -, a slide's is this much larger, so that neither hides the other.
IN_FRONT, LARGER = 0.011, 1.06
#: Way that a slide has on its rail - m.
TRAVEL = 0.5


@dataclass(frozen=True)
class Scene:
    """The compiled model with its ghost, and where it is seen from.

    Attributes:
        model, data: of MuJoCo; only places are computed.
        axis, ghost: where the positions of both stand in `qpos`.
        middle, scale: of a slide, which is drawn in the middle of its rail, and smaller than it is where that is short.
        camera: name of it.
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    axis: int
    ghost: int
    middle: float
    scale: float
    camera: str = "front"

    @classmethod
    def of(cls, shown: SideBySide, load: Load | None) -> Scene:
        """Scene of a motion; `load` draws the disk to size."""
        kind = shown.kind
        looks = AxisParameters(inertia=1.0, motor_inertia=0.5, kind=kind)  # which moves nothing here
        spec, other = build_spec(looks, 1e-3, load), build_spec(looks, 1e-3, load)
        for geom in other.body(MOTOR).find_all("geom"):
            geom.material, geom.rgba = "", MARKED if geom.material == MARK else COLOUR
            if not kind.turns:
                geom.size = LARGER * np.asarray(geom.size)
        frame = spec.body(MOTOR).parent.add_frame(pos=[IN_FRONT if kind.turns else 0.0, 0.0, 0.0])
        frame.attach_body(other.body(MOTOR), GHOST, "")
        model = spec.compile()
        axis, ghost = (int(model.joint(name).qposadr[0]) for name in (AXIS, GHOST + AXIS))
        middle, scale = 0.0, 1.0
        if not kind.turns:
            both = np.concatenate([shown.ghost, shown.position])
            low, high = float(np.nanmin(both)), float(np.nanmax(both))
            middle, scale = 0.5 * (low + high), TRAVEL / max(TRAVEL, high - low)
        return cls(model, mujoco.MjData(model), axis, ghost, middle, scale)

    def placed(self, position: float, ghost: float) -> mujoco.MjData:
        """Everything where it is with model and ghost at positions - rad (m); one that is nan stays where it was."""
        for at, value in ((self.axis, position), (self.ghost, ghost)):
            if np.isfinite(value):
                self.data.qpos[at] = self.scale * (value - self.middle)
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)
        return self.data
