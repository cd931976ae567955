"""A UR5e by the recursive Newton-Euler equations, written out; its MJCF; and a log whose joints hide what that lacks.

Links as robosuite's MJCF of the arm has them. The motion is given in closed form, torque follows from it: nothing of
MuJoCo is in the log, and an integrator, SciPy's, only where the first gear has play (J. J. Craig, Introduction to
Robotics, 3rd ed., 2005, sec. 6.5).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline

GRAVITY = 9.81
TURNED, PLAIN, TILTED = (0.5**0.5, 0.0, 0.5**0.5, 0.0), (1.0, 0.0, 0.0, 0.0), (0.5**0.5, 0.0, 0.0, 0.5**0.5)


@dataclass(frozen=True)
class Link:
    """A body and its joint: place - m - and turn in its parent, axis, mass - kg -, centre - m -, inertia - kg*m**2."""

    joint: str
    place: tuple
    turn: tuple
    axis: tuple
    mass: float
    centre: tuple
    inertia: tuple
    principal: tuple = PLAIN


SMALL = (0.0025599, 0.0025599, 0.0021942)
Y, Z = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
LINKS = (
    Link("shoulder_pan_joint", (0, 0, 0.163), PLAIN, Z, 3.7, (0, 0, 0), (0.0102675, 0.0102675, 0.00666)),
    Link("shoulder_lift_joint", (0, 0.138, 0), TURNED, Y, 8.393, (0, 0, 0.2125), (0.133886, 0.133886, 0.0151074)),
    Link("elbow_joint", (0, -0.131, 0.425), PLAIN, Y, 2.275, (0, 0, 0.196), (0.0311796, 0.0311796, 0.004095)),
    Link("wrist_1_joint", (0, 0, 0.392), TURNED, Y, 1.219, (0, 0.127, 0), SMALL),
    Link("wrist_2_joint", (0, 0.127, 0), PLAIN, Z, 1.219, (0, 0, 0.1), SMALL),
    Link(
        "wrist_3_joint", (0, 0, 0.1), PLAIN, Y, 0.1889, (0, 0.0771683, 0), (1.32134e-4, 9.90863e-5, 9.90863e-5), TILTED
    ),
)
NAMES = tuple(link.joint for link in LINKS)


def mjcf(links=LINKS, inside=""):
    """Of an arm; `inside` the last body more."""
    text, after = "", ""
    for k, link in enumerate(links):
        place, turn, axis, centre, inertia, principal = (
            " ".join(map(str, each))
            for each in (link.place, link.turn, link.axis, link.centre, link.inertia, link.principal)
        )
        text += f'<body name="link {k + 1}" pos="{place}" quat="{turn}"><joint name="{link.joint}" axis="{axis}"'
        text += f' armature="0.3" damping="1" frictionloss="0.1"/><inertial pos="{centre}" quat="{principal}"'
        text += f' mass="{link.mass}" diaginertia="{inertia}"/><geom size=".05" mass="0"/>\n'
        after += "</body>"
    motors = "".join(f'<motor name="{name} motor" joint="{name}"/>' for name in NAMES)
    option = f'<option timestep="0.0005" integrator="implicitfast" gravity="0 0 -{GRAVITY}"/>'
    body = f"<worldbody>{text}{inside}{after}</worldbody>"
    return f'<mujoco model="ur5e">{option}{body}<actuator>{motors}</actuator></mujoco>'


def matrix(quaternion):
    """Of a turn (3, 3)."""
    w, *v = np.asarray(quaternion) / np.linalg.norm(quaternion)
    return np.eye(3) + 2.0 * w * skew(v) + 2.0 * skew(v) @ skew(v)


def skew(v):
    """Of the cross product (3, 3)."""
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def asked(q, w, a, links=LINKS, payload=None):
    """Torque that the links ask of every joint - N*m - (n, 6) - for angles, speeds and accelerations (n, 6).

    The payload of the last link is a point: its mass - kg - and its place - m.
    """
    count = len(q)
    turn, rate, spin = np.tile(np.eye(3), (count, 1, 1)), np.zeros((count, 3)), np.zeros((count, 3))
    place, lift, bodies = np.zeros((count, 3)), np.tile([0.0, 0.0, GRAVITY], (count, 1)), []
    for k, link in enumerate(links):
        reach = turn @ np.array(link.place, dtype=float)
        lift = lift + np.cross(spin, reach) + np.cross(rate, np.cross(rate, reach))
        place = place + reach
        axis = np.array(link.axis)
        sine, cosine = np.sin(q[:, k, None, None]), np.cos(q[:, k, None, None])
        turn = turn @ matrix(link.turn) @ (np.eye(3) + sine * skew(axis) + (1.0 - cosine) * skew(axis) @ skew(axis))
        along = turn @ axis
        spin = spin + along * a[:, k, None] + np.cross(rate, along * w[:, k, None])
        rate = rate + along * w[:, k, None]
        arm = turn @ np.array(link.centre, dtype=float)
        force = link.mass * (lift + np.cross(spin, arm) + np.cross(rate, np.cross(rate, arm)))
        own = matrix(link.principal) @ np.diag(link.inertia) @ matrix(link.principal).T
        whole = turn @ own @ turn.transpose(0, 2, 1)
        momentum = np.einsum("nij,nj->ni", whole, rate)
        moment = np.einsum("nij,nj->ni", whole, spin) + np.cross(rate, momentum)
        bodies.append((place, along, place + arm, force, moment))
    joints = bodies[:]
    if payload is not None:
        arm = turn @ np.array(payload[1], dtype=float)
        force = payload[0] * (lift + np.cross(spin, arm) + np.cross(rate, np.cross(rate, arm)))
        bodies.append((place, along, place + arm, force, np.zeros_like(force)))
    torque = np.empty_like(q)
    for k, (joint, along, *_) in enumerate(joints):
        about = sum(moment + np.cross(centre - joint, force) for _, _, centre, force, moment in bodies[k:])
        torque[:, k] = np.sum(along * about, axis=1)
    return torque


@dataclass(frozen=True)
class Hidden:
    """What a joint has beside its links: kg*m**2, N*m*s/rad, N*m; and an effect with its values."""

    armature: float
    viscous: float
    coulomb: float
    effect: str = ""
    values: dict = field(default_factory=dict)

    def torque(self, q, w, a, links):
        """Of the joint's motor - N*m - (n,)."""
        plain = links + self.armature * a + self.viscous * w + self.coulomb * np.sign(w)
        of, sign = self.values, np.sign(w)
        if self.effect == "cogging_torque":
            return plain + of["amplitude"] * np.sin(of["harmonic"] * q)
        if self.effect == "stribeck_friction":
            return plain + (of["static_friction"] - self.coulomb) * np.exp(-((w / of["stribeck_velocity"]) ** 2)) * sign
        if self.effect == "load_dependent_friction":  # M = rest + mu*|M|*sgn(w), solved for M
            turned = np.sign(plain) * sign * of["load_friction_coefficient"]
            return plain / (1.0 - turned)
        if self.effect == "direction_dependent_friction":
            return plain + of["difference"]
        if self.effect == "quadratic_drag":
            return plain + of["quadratic_drag_coefficient"] * w * np.abs(w)
        return plain


HIDDEN = (
    Hidden(0.80, 6.0, 5.0, "cogging_torque", {"amplitude": 2.0, "harmonic": 12.0}),
    Hidden(0.90, 7.0, 6.0, "stribeck_friction", {"static_friction": 10.0, "stribeck_velocity": 0.2}),
    Hidden(0.80, 5.0, 4.0, "load_dependent_friction", {"load_friction_coefficient": 0.08}),
    Hidden(0.12, 1.2, 1.4, "cogging_torque", {"amplitude": 0.4, "harmonic": 8.0}),
    Hidden(0.11, 1.1, 1.2, "stribeck_friction", {"static_friction": 2.2, "stribeck_velocity": 0.12}),
    Hidden(0.10, 0.9, 1.0),
)


def motion(duration=20.0, period=2e-3, seed=0, scale=1.0):
    """Time (n,), and angles, speeds and accelerations of all joints (n, 6)."""
    rng = np.random.default_rng(100 + seed)
    time = period * np.arange(round(duration / period))
    slow = rng.uniform(0.08, 0.22, 6)
    parts = [(0.9, slow), (0.35, slow * 2.7 + 0.1), (0.12, rng.uniform(1.0, 1.6, 6)), (0.04, rng.uniform(2.2, 3.0, 6))]
    phases = rng.uniform(0.0, 2.0 * np.pi, (len(parts), 6))
    middle = np.array([0.2, -1.2, 1.1, -0.8, 0.5, 0.1])
    q, w, a = np.tile(middle, (time.size, 1)), np.zeros((time.size, 6)), np.zeros((time.size, 6))
    for (size, hertz), phase in zip(parts, phases, strict=True):
        omega = 2.0 * np.pi * hertz
        angle = omega * time[:, None] + phase
        q += scale * size * np.sin(angle)
        w += scale * size * omega * np.cos(angle)
        a -= scale * size * omega**2 * np.sin(angle)
    return time, q, w, a


def behind_play(time, q, w, a, play, payload=None, frequency=40.0, damping=0.2):
    """Motion (3, n, 6) of the links where the first joint's gear has play - rad - and its motor moves as commanded.

    About the vertical the links' momentum is M*w_1 + b, M and b of the other joints alone, and the gear's torque
    changes it: M*a_1 + M'*w_1 + b' = T(p), p the motor's angle less the link's. The teeth are a spring of `frequency` -
    Hz - between armature and median M, damped by `damping`, which push only.
    """

    def first(speed, acceleration):
        put = np.array([speed, acceleration])[:, None, None] * (np.arange(6) == 0)
        others = np.where(np.arange(6) == 0, 0.0, np.stack([w, a]))
        return asked(q, *(others + put), payload=payload)[:, 0]

    still = first(0.0, 0.0)
    inertia, grows = first(0.0, 1.0) - still, first(1.0, 0.0) - still
    of_time = make_interp_spline(time, np.column_stack([inertia, grows, still, q[:, 0], w[:, 0]]), k=5)
    heavy, omega = float(np.median(inertia)), 2.0 * np.pi * frequency
    both = heavy * HIDDEN[0].armature / (heavy + HIDDEN[0].armature)

    def accelerated(moment, angle, speed):
        own, growing, bias, place, rate = of_time(moment).T
        apart = place - angle
        deep = apart - np.clip(apart, -play / 2.0, play / 2.0)
        pushed = both * (omega**2 * deep + 2.0 * damping * omega * (rate - speed) * (deep != 0.0))
        pushed = np.where(pushed * deep > 0.0, pushed, 0.0)
        return (pushed - growing * speed - bias) / own

    found = solve_ivp(
        lambda moment, state: [state[1], float(accelerated(moment, *state))],
        (time[0], time[-1]),
        [q[0, 0] - play / 2.0, w[0, 0]],
        method="LSODA",
        t_eval=time,
        max_step=5e-4,
        rtol=1e-7,
        atol=1e-9,
    )
    moved = np.stack([q, w, a])
    moved[:, :, 0] = *found.y, accelerated(time, *found.y)
    return moved


def log(hidden=HIDDEN, links=LINKS, seed=0, noise=1.0, payload=None, play=0.0, **how):
    """Columns of a log, by their names in its file, as the sensors of the motors have them; `play` - rad - of the first
    joint's gear.
    """
    time, q, w, a = motion(seed=seed, **how)
    beyond = behind_play(time, q, w, a, play, payload) if play else (q, w, a)
    rest, rng, columns = asked(*beyond, links, payload), np.random.default_rng(seed), {"time [s]": time}
    for k, (name, own) in enumerate(zip(NAMES, hidden, strict=True)):
        torque = own.torque(q[:, k], w[:, k], a[:, k], rest[:, k])
        loud = 0.05 if k < 3 else 0.02
        exact = {"position [rad]": (q[:, k], 2e-5), "velocity [rad/s]": (w[:, k], 1e-3), "torque [N*m]": (torque, loud)}
        for signal, (values, error) in exact.items():
            columns[f"{name}.{signal}"] = values + noise * error * rng.standard_normal(time.size)
    return columns
