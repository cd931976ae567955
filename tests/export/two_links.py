"""A two-link arm by Lagrange's equations, written out; its MJCF; and a log of it whose elbow hides what the MJCF lacks.

The motion is given in closed form and the torque follows from it exactly, dry friction's sign included: no integrator
and nothing of MuJoCo is in the log. Angles are zero where the arm hangs; the elbow's is relative to the upper arm.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass

import numpy as np

from tests.docs.pages import run_commands

GRAVITY = 9.81
#: Upper arm: mass, length, centre, inertia about it; forearm: the same without length.
M1, L1, C1, I1 = 1.3, 0.35, 0.16, 0.014
M2, C2, I2 = FOREARM = 0.8, 0.15, 0.006


@dataclass(frozen=True)
class Hidden:
    """What the elbow has beside its links: kg*m**2, N*m*s/rad, N*m, N*m, cycles per turn."""

    armature: float = 0.02
    viscous: float = 0.06
    coulomb: float = 0.4
    cogging: float = 0.15
    harmonic: float = 8.0

    def torque(self, q, w, a):
        """Of the elbow's motor beyond what the links ask for - N*m."""
        friction = self.viscous * w + self.coulomb * np.sign(w)
        return self.armature * a + friction + self.cogging * np.sin(self.harmonic * q)


HIDDEN = Hidden()
MJCF = f"""<mujoco model="two links"><option timestep="0.0005" gravity="0 0 -{GRAVITY}"/><worldbody>
  <body name="upper arm"><joint name="shoulder" axis="0 1 0"/>
    <inertial pos="0 0 -{C1}" mass="{M1}" diaginertia="{I1} {I1} 1e-3"/>
    <body name="forearm" pos="0 0 -{L1}">
      <joint name="elbow" axis="0 1 0" armature="0.5" damping="1" frictionloss="3"/>
      <inertial pos="0 0 -{C2}" mass="{M2}" diaginertia="{I2} {I2} 1e-3"/></body></body></worldbody>
  <actuator><motor name="shoulder motor" joint="shoulder"/>
    <motor name="elbow motor" joint="elbow"/></actuator></mujoco>"""


def waves(time, amplitudes, frequencies, phases):
    """Angle, speed and acceleration of a sum of sines - rad, s - (n,) each."""
    omega = 2.0 * np.pi * np.asarray(frequencies)[:, None]
    angle = omega * time + np.asarray(phases)[:, None]
    size = np.asarray(amplitudes)[:, None]
    return (
        (size * np.sin(angle)).sum(0),
        (size * omega * np.cos(angle)).sum(0),
        -(size * omega**2 * np.sin(angle)).sum(0),
    )


def shoulder_torque(q1, w1, a1, q2, w2, a2, forearm=FOREARM):
    """What the shoulder has to make for a motion - N*m - (n,)."""
    mass, centre, inertia = forearm
    coupled = mass * L1 * centre
    m12 = inertia + mass * centre**2 + coupled * np.cos(q2)
    m11 = I1 + M1 * C1**2 + mass * L1**2 + coupled * np.cos(q2) + m12
    falls = (M1 * C1 + mass * L1) * GRAVITY * np.sin(q1) + mass * centre * GRAVITY * np.sin(q1 + q2)
    return m11 * a1 + m12 * a2 - coupled * np.sin(q2) * (2.0 * w1 * w2 + w2**2) + falls


def elbow_torque(q1, w1, a1, q2, w2, a2, forearm=FOREARM):
    """What the links ask of the elbow - N*m - (n,)."""
    mass, centre, inertia = forearm
    coupled = mass * L1 * centre
    m12 = inertia + mass * centre**2 + coupled * np.cos(q2)
    falls = mass * centre * GRAVITY * np.sin(q1 + q2)
    return m12 * a1 + (inertia + mass * centre**2) * a2 + coupled * np.sin(q2) * w1**2 + falls


def motion(duration=12.0, period=1e-3, phase=0.0):
    """Time, and angle, speed and acceleration of shoulder and elbow."""
    time = period * np.arange(round(duration / period))
    shoulder = waves(time, (0.5, 0.12), (0.31, 1.3), (0.2 + phase, 1.1))
    elbow = waves(time, (1.1, 0.25, 0.03), (0.43, 1.7, 5.3), (0.0, 0.7 + phase, 2.0))
    return time, shoulder, elbow


def log(hidden=HIDDEN, seed=0, noise=1.0, **how):
    """Columns of a log, by their names in its file, as the sensors have them."""
    return sensed(*motion(**how), hidden, seed, noise)


def sensed(time, shoulder, elbow, hidden=HIDDEN, seed=0, noise=1.0):
    """The same of a motion."""
    rng, (q1, w1, a1), (q2, w2, a2) = np.random.default_rng(seed), shoulder, elbow
    drive = elbow_torque(q1, w1, a1, q2, w2, a2) + hidden.torque(q2, w2, a2)
    lift = shoulder_torque(q1, w1, a1, q2, w2, a2)
    exact = {
        "shoulder.position [rad]": (q1, 5e-5),
        "shoulder.velocity [rad/s]": (w1, 2e-3),
        "shoulder.torque [N*m]": (lift, 2e-2),
        "elbow.position [rad]": (q2, 5e-5),
        "elbow.velocity [rad/s]": (w2, 2e-3),
        "elbow.torque [N*m]": (drive, 1e-2),
    }
    noisy = {name: value + noise * error * rng.standard_normal(time.size) for name, (value, error) in exact.items()}
    return {"time [s]": time, **noisy}


def write_log(path, columns):
    """The log as CSV."""
    np.savetxt(path, np.column_stack(list(columns.values())), "%.9g", ",", header=",".join(columns), comments="")
    return path


def ran(folder, page):
    """A folder with the arm and its log, in which the commands of a page have run."""
    (folder / "robot.xml").write_text(MJCF)
    write_log(folder / "log.csv", log())
    with contextlib.chdir(folder):
        run_commands(page)
    return folder
