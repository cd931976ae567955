"""What a video shows: the model of an axis or a whole robot, and a translucent copy of what moves in it."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.arrays import Array
from bench.effects.mjcf import AXIS, MOTOR
from bench.plant.axis_model import AxisParameters, build_spec
from bench.plant.mjcf_file import read_spec
from bench.rig.rig import Load
from bench.view.side_by_side import RobotAlong, SideBySide

#: Names of the ghost's parts begin with it.
GHOST = "ghost "
#: Colour of its parts, and of the marks on them; what carries a mark is of this material.
COLOUR, MARKED, MARK = (0.45, 0.65, 0.95, 0.3), (0.1, 0.25, 0.85, 1.0), "mark"
#: A disk's ghost floats in front of it - m -, a slide's is this much larger, so that neither hides the other.
IN_FRONT, LARGER = 0.011, 1.06
#: Way that a slide has on its rail - m.
TRAVEL = 0.5
#: Pixels that a robot's MJCF, which may ask for less, is rendered in at most; a camera that MuJoCo places by itself.
LARGEST, FREE = (1600, 1200), -1
#: Colours of what is not to be seen, and of the background where the MJCF has none.
UNSEEN, SKY = (0.0, 0.0, 0.0, 0.0), (0.95, 0.96, 0.97)


@dataclass(frozen=True)
class Scene:
    """The compiled model with its ghost, and where it is seen from.

    Attributes:
        model, data: of MuJoCo; only places are computed.
        axis, ghost: where the positions of both stand in `qpos`.
        middle, scale: of a slide, which is drawn in the middle of its rail, and smaller than it is where that is short.
        camera: name of it.
        others: when, and where the other coordinates of a robot were then - s, rad (m) - (n,), (n, nq).
    """

    model: mujoco.MjModel
    data: mujoco.MjData
    axis: int
    ghost: int
    middle: float
    scale: float
    camera: str | int = "front"
    others: tuple[Array, Array] | None = None

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

    @classmethod
    def of_robot(cls, robot: RobotAlong) -> Scene:
        """A robot with its meshes, and the measured one as its ghost."""
        (spec, _), (other, _) = read_spec(str(robot.mjcf)), read_spec(str(robot.mjcf))
        carried = other.joint(robot.joint).parent.find_all("geom")  # the rest is the same in both
        for geom in other.geoms:
            geom.material, geom.rgba = "", COLOUR if geom in carried else UNSEEN
        spec.attach(other, prefix=GHOST, frame=spec.worldbody.add_frame())
        spec.visual.global_.offwidth, spec.visual.global_.offheight = LARGEST
        spec.visual.headlight.ambient = spec.visual.headlight.diffuse = [0.5] * 3
        if not any(one.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX for one in spec.textures):
            sky = spec.add_texture(name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=64, height=64)
            sky.builtin, sky.rgb1, sky.rgb2 = mujoco.mjtBuiltin.mjBUILTIN_GRADIENT, SKY, SKY
        model = spec.compile()
        others = np.tile(model.qpos0, (robot.times.size, 1))
        for name, values in robot.poses.items():
            for each in (name, GHOST + name):
                others[:, model.joint(each).qposadr[0]] = values
        axis, ghost = (int(model.joint(each).qposadr[0]) for each in (robot.joint, GHOST + robot.joint))
        return cls(model, mujoco.MjData(model), axis, ghost, 0.0, 1.0 / robot.ratio, FREE, (robot.times, others))

    def placed(self, position: float, ghost: float, time: float = 0.0) -> mujoco.MjData:
        """Everything where it is with model and ghost at positions - rad (m); one that is nan stays where it was.

        Other joints of a robot are where they were at a time - s.
        """
        if self.others is not None:
            times, others = self.others
            kept = self.data.qpos[[self.axis, self.ghost]]
            self.data.qpos[:] = [np.interp(time, times, each) for each in others.T]
            self.data.qpos[[self.axis, self.ghost]] = kept
        for at, value in ((self.axis, position), (self.ghost, ghost)):
            if np.isfinite(value):
                self.data.qpos[at] = self.scale * (value - self.middle)
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)
        return self.data
