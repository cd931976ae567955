"""A joint among the links of an MJCF, which gives gravity and the links' inertia: its armature and friction."""

from pathlib import Path

import numpy as np

import bench
from bench.plant.robot import Robot, read_log, rig_within

ARMATURE, VISCOUS, COULOMB = 0.02, 0.06, 0.4  # kg*m**2, N*m*s/rad, N*m
MASS, LENGTH, INERTIA, GRAVITY = 0.8, 0.15, 0.006, 9.81  # kg, m, kg*m**2 about the centre, m/s**2
MJCF = f"""<mujoco><option gravity="0 0 -{GRAVITY}"/><worldbody><body><joint name="elbow" axis="0 1 0"/>
  <inertial pos="0 0 -{LENGTH}" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} 1e-3"/></body></worldbody></mujoco>"""
Path("robot.xml").write_text(MJCF, encoding="utf-8")

time = np.arange(12000) * 1e-3
waves = [(1.1, 2.7, 0.0), (0.25, 10.7, 0.7), (0.03, 33.3, 2.0)]  # rad, rad/s, rad
angle = sum(a * np.sin(w * time + p) for a, w, p in waves)
speed = sum(a * w * np.cos(w * time + p) for a, w, p in waves)
acceleration = sum(-a * w**2 * np.sin(w * time + p) for a, w, p in waves)
links = (INERTIA + MASS * LENGTH**2) * acceleration + MASS * GRAVITY * LENGTH * np.sin(angle)
torque = links + ARMATURE * acceleration + VISCOUS * speed + COULOMB * np.sign(speed)
noise = np.random.default_rng(0).normal(size=(2, time.size))
columns = np.column_stack([time, angle, speed + 2e-3 * noise[0], torque + 0.01 * noise[1]])
head = "time [s],elbow.position [rad],elbow.velocity [rad/s],elbow.torque [N*m]"
np.savetxt("log.csv", columns, delimiter=",", header=head, comments="", fmt="%.9g")

robot = Robot.of(Path("robot.xml"), "elbow")
rig = rig_within(bench.Rig.of({"name": "elbow", "kind": "rotary"}), robot)
estimate = bench.identify(read_log(Path("log.csv"), rig, robot, {}), rig)
for name, found in estimate.parameters.items():
    print(f"{name}: {found.value:.5g} {found.unit}")
