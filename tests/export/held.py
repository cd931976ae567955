"""Hold an arm softly to a log: the logged torque drives it, a weak cascade keeps the elbow near."""

import mujoco
import numpy as np

#: Bandwidth that holds the elbow - rad/s - as the bench's own velocity gap has it; and the shoulder's.
ELBOW, SHOULDER = 20.0, 300.0


def followed(path, columns, inertia):
    """Speed of the elbow at the samples of a log - rad/s - (n,), of an arm as MJCF.

    Args:
        path: of the MJCF.
        columns: of the log.
        inertia: that the elbow's cascade is laid out for - kg*m**2.
    """
    model = mujoco.MjModel.from_xml_path(str(path))
    time = columns["time [s]"]
    steps = round((time[1] - time[0]) / model.opt.timestep)
    data = mujoco.MjData(model)
    ends = np.arange((time.size - 1) * steps + 1) * model.opt.timestep
    q, w, m = (
        np.stack([np.interp(at, time, columns[f"{joint}.{name}"]) for joint in ("shoulder", "elbow")], axis=1)
        for name, at in (
            ("position [rad]", ends),
            ("velocity [rad/s]", ends),
            ("torque [N*m]", ends + model.opt.timestep / 2.0),
        )
    )
    data.qpos[:], data.qvel[:] = q[0], w[0]
    actuators = [model.actuator(f"{joint} motor").id for joint in ("shoulder", "elbow")]
    gain = np.array([0.3 * SHOULDER, inertia * ELBOW])
    stiffness = np.array([0.3 * SHOULDER**2 / 4.0, inertia * ELBOW**2 / 5.0])
    found = np.empty(time.size)
    for k in range(ends.size):
        if k % steps == 0:
            found[k // steps] = data.qvel[1]
        data.ctrl[actuators] = m[k] + gain * (w[k] - data.qvel) + stiffness * (q[k] - data.qpos)
        mujoco.mj_step(model, data)
    return found
