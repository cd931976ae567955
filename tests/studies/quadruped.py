"""Twelve joints of a quadruped on a stand, by plain MuJoCo; what `bench robot` finds from goals and positions alone.

The legs are those of a quadruped of 15 kg. Every joint has hidden armature, viscous, Coulomb and static friction, and a
bias between the zeros of its goal and its position; all goals arrive late by one dead time. The goals are chirps of 0.1
to 2 Hz of drawn size and phase, held from sample to sample. The truth is stepped at 0.25 ms by MuJoCo's RK4. Positions
have noise of 0.2 mrad and 14 bit.

    python -m tests.studies.quadruped --logs 4 --seed 1

prints how often intervals of 95 % contain the truth, the errors, and the CPU time of a log. With `--cma SECONDS` also
what CMA-ES (the package `cma`) finds of the same log in so much CPU time, by simulations of the whole robot in MuJoCo.
"""

from __future__ import annotations

import argparse
import math
import tempfile
import time
from contextlib import suppress
from importlib import import_module
from itertools import chain
from pathlib import Path

import mujoco
import mujoco.rollout
import numpy as np

import bench
from tests.studies.frame import cpu, running, table

KP, KD, RATE, STEP = 40.0, 1.0, 400.0, 0.25e-3
#: Noise of a position, and its step - rad.
NOISE, RESOLUTION = 2e-4, 2.0 * np.pi / 2**14
LEGS = ("FL", "FR", "RL", "RR")
PARTS = ("hip", "thigh", "calf")
#: Centres of the motion - rad.
HOME = (0.0, 0.8, -1.5)
#: What CMA-ES fits, with its bounds - SI -, all but the bias by logarithms; and its timestep - s.
FITTED = {
    "armature": (1e-3, 0.1),
    "viscous_friction_coefficient": (0.01, 1.0),
    "coulomb_friction_torque": (0.02, 1.0),
    "dead_time": (1e-4, 0.02),
    "joint_bias": (-0.1, 0.1),
}
COARSE = 1e-3
#: Speed below which a joint is at rest - rad/s: above the creep of MuJoCo's friction, far below that of any motion.
RESTS = 3e-5
BODIES = """<body name="{leg}_hip" pos="{x} {y} 0"><joint name="{leg}_hip_joint" axis="1 0 0"/>
  <inertial pos="-.005 0 0" mass=".68" diaginertia=".0005 .0008 .0006"/>
  <body name="{leg}_thigh" pos="0 {out} 0"><joint name="{leg}_thigh_joint" axis="0 1 0"/>
    <inertial pos="-.004 {inward} -.033" mass="1.15" diaginertia=".0059 .0058 .001"/>
    <body name="{leg}_calf" pos="0 0 -.213"><joint name="{leg}_calf_joint" axis="0 1 0"/>
      <inertial pos=".005 0 -.13" mass=".24" diaginertia=".0017 .0017 .00005"/></body></body></body>
"""


def mjcf(legs: tuple[str, ...] = LEGS, actuators: bool = True) -> str:
    """Of the robot on its stand."""
    bodies = ""
    for leg in legs:
        side = 1.0 if leg[1] == "L" else -1.0
        x = 0.19 if leg[0] == "F" else -0.19
        bodies += BODIES.format(leg=leg, x=x, y=0.047 * side, out=0.095 * side, inward=-0.022 * side)
    drives = "".join(
        f'<position name="{one}" joint="{one}" kp="{KP}" kv="{KD}"/>' for one in joints_of(legs) if actuators
    )
    return (
        f'<mujoco><option timestep="{STEP}" integrator="RK4"/><worldbody><body name="trunk" pos="0 0 1">'
        f'<inertial pos="0 0 0" mass="6.9" diaginertia=".025 .1 .11"/>'
        f"{bodies}</body></worldbody><actuator>{drives}</actuator></mujoco>"
    )


def joints_of(legs: tuple[str, ...]) -> list[str]:
    """Names of the joints of legs."""
    return [f"{leg}_{part}_joint" for leg in legs for part in PARTS]


def hidden(joints: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
    """What the joints have (joints,) - kg*m**2, N*m*s/rad, N*m, rad, s -; a dead time of whole steps of the truth."""
    coulomb = rng.uniform(0.1, 0.5, joints)
    return {
        "armature": rng.uniform(0.008, 0.03, joints),
        "viscous_friction_coefficient": rng.uniform(0.05, 0.4, joints),
        "coulomb_friction_torque": coulomb,
        "static_friction_torque": coulomb + rng.uniform(0.02, 0.25, joints),
        "joint_bias": rng.uniform(-0.05, 0.05, joints),
        "dead_time": np.full(joints, STEP * rng.integers(8, 60)),
    }


def moved(
    of: dict[str, np.ndarray],
    rng: np.random.Generator,
    seconds: float = 20.0,
    legs: tuple[str, ...] = LEGS,
    limit: float = math.inf,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time (n,), goals and measured positions (n, joints) of a log; `limit` of every controller - N*m."""
    model = mujoco.MjModel.from_xml_string(mjcf(legs))
    model.dof_armature[:], model.dof_damping[:] = of["armature"], of["viscous_friction_coefficient"]
    model.dof_solimp[:], model.dof_solref[:] = [0.9999, 0.9999, 0.001, 0.5, 2.0], [2.0 * STEP, 1.0]
    if math.isfinite(limit):
        model.actuator_forcelimited[:], model.actuator_forcerange[:] = 1, [-limit, limit]
    time = np.arange(round(seconds * RATE)) / RATE
    phase = 2.0 * np.pi * (0.1 * time + 0.5 * 1.9 / seconds * time**2)
    size = rng.uniform(0.25, 0.45, model.nv) * rng.choice([-1.0, 1.0], model.nv)
    goal = np.tile(HOME, len(legs)) + size * np.sin(phase[:, None] + rng.uniform(0.0, 2.0 * np.pi, model.nv))
    data, position = mujoco.MjData(model), np.empty_like(goal)
    data.qpos[:] = goal[0]
    late, every = float(of["dead_time"][0]), round(1.0 / (RATE * STEP))
    for step in range(time.size * every):
        if step % every == 0:
            position[step // every] = data.qpos
        known = max(0, math.floor((step * STEP - late) * RATE + 1e-9))
        data.ctrl[:] = goal[known] + of["joint_bias"]
        rests = np.abs(data.qvel) < RESTS
        model.dof_frictionloss[:] = np.where(rests, of["static_friction_torque"], of["coulomb_friction_torque"])
        mujoco.mj_step(model, data)
    measured = position + NOISE * rng.standard_normal(position.shape)
    return time, goal, RESOLUTION * np.round(measured / RESOLUTION)


def write_log(path: Path, recorded: tuple[np.ndarray, ...], legs: tuple[str, ...] = LEGS) -> Path:
    """The log as a file, by the names of the joints."""
    time, goal, position = recorded
    names = ["time [s]", *(f"{joint}.{one} [rad]" for one in ("goal", "position") for joint in joints_of(legs))]
    np.savetxt(path, np.column_stack([time, goal, position]), "%.9g", ",", header=",".join(names), comments="")
    return path


class SpentError(Exception):
    """The CPU time of a search is over."""


def by_cma(recorded: tuple[np.ndarray, ...], seconds: float) -> dict[str, np.ndarray]:
    """What CMA-ES finds in so much CPU time: FITTED of each joint (joints,), one dead time of all."""
    times, goal, position = recorded
    model = mujoco.MjModel.from_xml_string(mjcf())
    model.opt.timestep, model.opt.integrator = COARSE, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    model.dof_solimp[:], model.dof_solref[:] = [0.9999, 0.9999, 0.001, 0.5, 2.0], [2.0 * COARSE, 1.0]
    data, joints = mujoco.MjData(model), model.nv
    steps = COARSE * np.arange(round(float(times[-1]) / COARSE) + 1)
    start = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    start[1 : 1 + joints] = position[0]
    best, end = (math.inf, np.empty(0)), time.process_time() + seconds

    def values(point: np.ndarray) -> dict[str, np.ndarray]:
        shares = np.split(point[1:], len(FITTED) - 1)
        shares.insert([*FITTED].index("dead_time"), np.full(joints, point[0]))
        return {
            name: low + share * (high - low) if low < 0.0 else low * (high / low) ** share
            for (name, (low, high)), share in zip(FITTED.items(), shares, strict=True)
        }

    def misfit(point: np.ndarray) -> float:
        nonlocal best
        if time.process_time() > end:
            raise SpentError
        of = values(point)
        model.dof_armature[:], model.dof_damping[:] = of["armature"], of["viscous_friction_coefficient"]
        model.dof_frictionloss[:] = of["coulomb_friction_torque"]
        known = np.clip(((steps - of["dead_time"][0]) * RATE + 1e-9).astype(int), 0, times.size - 1)
        state, _ = mujoco.rollout.rollout(model, data, start, goal[known] + of["joint_bias"])
        at = np.rint(times[1:] / COARSE).astype(int) - 1
        error = float(np.mean((np.asarray(state)[0, at, 1 : 1 + joints] - position[1:]) ** 2))
        best = min(best, (error, point), key=lambda one: one[0])
        return math.log(error)

    options = {"bounds": [0.0, 1.0], "seed": 1, "verbose": -9}
    with suppress(SpentError):  # the best so far is the answer
        import_module("cma").fmin2(misfit, np.full(1 + (len(FITTED) - 1) * joints, 0.5), 0.2, options)
    return values(best[1])


def judged(seed: int, number: int, cma: float = 0.0) -> list[tuple[str, float, float, bool]]:
    """Of every parameter of a log: name, truth, error, whether its interval contains the truth; and of its CPU time.

    The dead time counts once, as all joints have the same.
    """
    rng = np.random.default_rng([seed, number])
    of = hidden(len(joints_of(LEGS)), rng)
    recorded = moved(of, rng)
    with tempfile.TemporaryDirectory() as folder:
        log, robot = write_log(Path(folder) / "log.csv", recorded), Path(folder) / "robot.xml"
        robot.write_text(mjcf(), encoding="utf-8")
        before = cpu()
        found = bench.robot(log, robot)
        rows = [("cpu", 0.0, cpu() - before, True)]
    for k, joint in enumerate(found.joints.values()):
        for name, truth in of.items():
            one = joint.parameters.get(name)
            if name == "dead_time" and k:
                continue
            if one is None:
                rows.append((f"{name} refused", float(truth[k]), math.nan, True))
                continue
            low, high = one.ci95
            rows.append((name, float(truth[k]), float(one.value - truth[k]), bool(low <= truth[k] <= high)))
        if joint.diagnosis is None or joint.diagnosis.effects or joint.diagnosis.verdict != "nothing_missing":
            rows.append(("effects found that are not there", 0.0, math.nan, False))
    if cma:
        for name, found in by_cma(recorded, cma).items():
            away = (found - of[name])[: 1 if name == "dead_time" else None]
            rows += [
                (f"{name} by CMA-ES", float(truth), float(off), False)
                for truth, off in zip(of[name], away, strict=False)
            ]
    return rows


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--logs", type=int, default=4)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cma", type=float, default=0.0, help="CPU time of CMA-ES on the same log - s")
    options = parser.parse_args()
    with running(1) as run:
        asked = [(options.seed, k, options.cma) for k in range(options.logs)]
        rows = [*chain.from_iterable(run.each("log", judged, asked))]
    lines, whole = [], [row for row in rows if row[0] != "cpu"]
    answered = [row for row in whole if math.isfinite(row[2]) and not row[0].endswith(" by CMA-ES")]
    for name in (*dict.fromkeys(row[0] for row in whole), "all"):
        own = answered if name == "all" else [row for row in whole if row[0] == name]
        shares = [abs(row[2] / row[1]) for row in own if row[1]]
        inside = f"{sum(row[3] for row in own)} of {len(own)}" if not name.endswith(" by CMA-ES") else "no interval"
        error = f"{100.0 * float(np.median(shares)):.2g} %" if name != "all" and shares else ""
        lines.append((name, inside, error, f"{max(abs(r[2]) for r in own):.3g}"))
    print(table(("parameter", "in the interval of 95 %", "median error", "largest error, SI"), lines))
    cpu = [row[2] for row in rows if row[0] == "cpu"]
    print(f"CPU time of a log: median {np.median(cpu):.3g} s, largest {max(cpu):.3g} s")


if __name__ == "__main__":
    main()
