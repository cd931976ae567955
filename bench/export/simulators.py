"""A model as other simulators take a joint: for each of them a file as it documents it, and what that cannot carry.

All values are on the joint's side of a gear, as `bench.export.mjcf` has them, but where a simulator has the gear too.
Effects give the part that MuJoCo has natively, by building the axis with one at a time; for their friction in
others' words (`bench.effects.torque.FrictionLaw`).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco

from bench.effects.mjcf import AXIS, DRIVE, LOAD_TORQUE
from bench.effects.torque import Friction, FrictionLaw
from bench.errors import InputError
from bench.export.mjcf import armature_of
from bench.names import plain
from bench.plant.model_file import SEEN, STEPPED, TIMESTEP, StoredModel
from bench.structured import json_text

#: Constant and resistance of a motor whose torque is its voltage: it brakes by 1e-9 N*m*s/rad.
UNIT_MOTOR = 1e-9
#: What a simulator has no word for, but MuJoCo: natively, or as a step of its own.
NATIVE = "MuJoCo has it: --mjcf ROBOT"


@dataclass(frozen=True)
class SimulatedJoint:
    """A joint of a robot as simulators take it, on its side of the gear - SI."""

    name: str
    stored: StoredModel

    @property
    def ratio(self) -> float:
        """Of the gear, motor turns per turn of the joint."""
        return self.stored.mounting.gear_ratio

    @property
    def armature(self) -> float:
        """kg*m**2 (kg); InputError where the model has none."""
        return armature_of(self.stored).value

    @property
    def damping(self) -> float:
        """N*m*s/rad (N*s/m)."""
        return self.stored.model.parameters.viscous_friction_coefficient * self.ratio**2

    @property
    def coulomb(self) -> float:
        """N*m (N)."""
        return self.stored.model.parameters.coulomb_friction * self.ratio

    @property
    def limit(self) -> float | None:
        """Largest torque (force) that the rig or the robot's MJCF states - N*m (N); None where neither does."""
        return self.stored.mounting.effort_limit

    @property
    def unlimited(self) -> list[str]:
        """That no limit of the torque is known, and how to state one."""
        remedy = "set forcerange at its actuator in the MJCF, or motor.peak_torque in the rig, and identify it again"
        return [] if self.limit is not None else [f"no effort_limit: neither MJCF nor rig states one; {remedy}"]

    def native(self) -> Iterator[tuple[str, mujoco.MjSpec]]:
        """The axis with each effect alone that MuJoCo makes by itself, behind the effect's name."""
        for present in self.stored.model.native:
            yield present.name, self.stored.model.with_effects([present]).spec(TIMESTEP)

    def passive(self) -> Iterator[tuple[str, mujoco.MjsActuator]]:
        """Passive motors of effects, behind the effects' names; they are behind the gear themselves."""
        for name, spec in self.native():
            for actuator in spec.actuators:
                if actuator.name not in (DRIVE, LOAD_TORQUE):
                    yield name, actuator

    def friction(self) -> tuple[FrictionLaw, dict[str, str]]:
        """Dry friction in addition to Coulomb's; and the effects that are its `rise` and its share of the `load`, the
        first."""
        model, found, names = self.stored.model, {"rise": FrictionLaw(), "load": FrictionLaw()}, {}
        for effect, values in model.acting(Friction):
            law = effect.law(values, model.axis)
            kind = "rise" if law is not None and law.rise else "load"
            if law is not None and kind not in names:
                found[kind], names[kind] = law, effect.name
        rising, loaded = found["rise"], found["load"]
        rise, velocity = rising.rise * self.ratio, rising.velocity / self.ratio
        return FrictionLaw(rise, velocity, rising.exponent, loaded.motor, loaded.external), names

    def summary(self, carried: Sequence[str], *notes: str) -> list[str]:
        """What a file contains of the joint, and what not, in sentences."""
        model, left = self.stored.model, [present.name for present in self.stored.model.effects]
        for name in carried:
            left.remove(name)
        stepped, native = {one.name for one in model.stepped}, model.structure
        why = {name: STEPPED if name in stepped else NATIVE if name in native else SEEN for name in left}
        head = f"armature {self.armature:.4g} {model.parameters.kind.inertia_unit}, {armature_of(self.stored).origin}"
        held = [f"carried: {', '.join(carried)}"] if carried else []
        lines = [head, *held, *(f"not carried: {name} ({why[name]})" for name in left), *notes]
        return [f"{self.name}: {line}" for line in lines]


Written = tuple[str, list[str]]


def simulator_file(target: str, models: Mapping[str, StoredModel], actuator: str | None) -> Written:
    """Text of the file of joints for a simulator of `TARGETS`, and what it contains and lacks in sentences.

    `actuator` is BAM's that makes the torque. InputError: no such simulator, or it does not take such joints.
    """
    if target not in TARGETS:
        raise InputError("--to", f"found '{target}'", f"allowed: mjcf, {', '.join(TARGETS)}, drive")
    if actuator is not None and target != "bam":
        raise InputError("--actuator", f"found with --to {target}", "allowed: with --to bam")
    return TARGETS[target]([SimulatedJoint(*each) for each in models.items()], actuator)


def _mjlab(joints: Sequence[SimulatedJoint], _: str | None) -> Written:
    """`BuiltinDcMotorActuatorCfg` of mjlab 1.6, which has one wave of cogging, and LuGre's bristles."""
    entries, lines = [], []
    for joint in joints:
        effort = {} if joint.limit is None else {"effort_limit": joint.limit / joint.ratio}
        found: dict[str, Any] = {"cogging": None, "lugre": None}
        carried = []
        for name, motor in sorted(joint.passive(), key=lambda each: -abs(each[1].biasprm[0])):  # the largest wave
            rate = [float(value) for value in (*motor.dynprm[5:7], *motor.biasprm[3:6])]
            kind, values = ("lugre", rate) if rate[0] else ("cogging", [float(value) for value in motor.biasprm[:3]])
            if found[kind] is None:
                found[kind] = tuple(values)
                carried.append(name)
        steps = [f"its bristles are laid out for steps of {TIMESTEP:g} s"] if found["lugre"] else []
        notes = "its input is torque of the motor, before the gear, in N*m", *steps, *joint.unlimited
        lines += joint.summary(carried, *notes)
        values = {"armature": joint.armature, "frictionloss": 0.0 if found["lugre"] else joint.coulomb}
        entries.append(
            {"target_names_expr": (re.escape(joint.name),), "gear": joint.ratio, **effort, **values}
            | {"viscous_damping": joint.damping, **found}
        )
    motor = "motor_params=TORQUE, mode=DcMotorInputMode.VOLTAGE"
    return _python(
        lines,
        "from mjlab.actuator import BuiltinDcMotorActuatorCfg, DcMotorInputMode, DcMotorPhysicalParams\n",
        "#: A motor whose torque in N*m is its voltage in V.",
        f"TORQUE = DcMotorPhysicalParams(kt={UNIT_MOTOR}, ke={UNIT_MOTOR}, resistance={UNIT_MOTOR})",
        "#: For `EntityArticulationInfoCfg(actuators=ACTUATORS)`, with an MJCF that has no actuators at these joints.",
        "ACTUATORS = (",
        *(f"    BuiltinDcMotorActuatorCfg({motor}, {_arguments(entry)})," for entry in entries),
        ")",
    )


def _bam(joints: Sequence[SimulatedJoint], actuator: str | None) -> Written:
    """Parameters of BAM 1.0, of the least of its models M1 to M5 that has what was found."""
    if len(joints) != 1 or not joints[0].stored.model.parameters.kind.turns:
        found = "found several joints" if len(joints) > 1 else "found a joint that slides"
        raise InputError("--to bam", found, "allowed: one joint that turns, by --joint")
    if actuator is None:
        raise InputError("--actuator", "missing", "allowed: BAM's name of the actuator that makes the torque, as xl330")
    joint = joints[0]
    law, names = joint.friction()
    values = {"armature": joint.armature, "friction_base": joint.coulomb, "friction_viscous": joint.damping}
    name = "m2" if law.rise else "m1"
    if law.motor:
        name = "m5" if law.motor != law.external else "m4" if law.rise else "m3"
    if name in ("m2", "m4", "m5"):
        speed = law.velocity if law.rise else 1.0
        values |= {"friction_stribeck": law.rise, "dtheta_stribeck": speed, "alpha": law.exponent}
    if name in ("m3", "m4"):
        values |= {"load_friction_base": law.motor} | ({"load_friction_stribeck": 0.0} if law.rise else {})
    if name == "m5":
        values |= {"load_friction_motor": law.motor, "load_friction_external": law.external}
        values |= {"load_friction_motor_stribeck": 0.0, "load_friction_external_stribeck": 0.0}
    notes = [f"model {name.upper()}"]
    winding = joint.stored.model.winding
    if winding is None:
        notes.append(f"kt and R are not known: BAM takes those of its {actuator}")
    else:
        values |= {"kt": float(winding.torque_constant) * joint.ratio, "R": float(winding.resistance)}
    content = {**values, "q_offset": 0.0, "model": name, "actuator": actuator}
    return json_text(content) + "\n", joint.summary(list(names.values()), *notes)


def _isaaclab(joints: Sequence[SimulatedJoint], _: str | None) -> Written:
    """`ImplicitActuatorCfg` of Isaac Lab 2.3 and later on Isaac Sim 5 and later, where friction is an effort."""
    entries, lines = [], []
    for joint in joints:
        law, names = joint.friction()
        risen = [names["rise"]] if law.rise else []
        lines += joint.summary(risen, *["of its rise towards standstill the static level, at no speed" for _ in risen])
        values = {"armature": joint.armature, "friction": joint.coulomb + max(law.rise, 0.0)}
        values |= {"dynamic_friction": joint.coulomb, "viscous_friction": joint.damping}
        entries.append(
            (joint.name, {"joint_names_expr": [re.escape(joint.name)], "stiffness": 0.0, "damping": 0.0} | values)
        )
    return _python(
        lines,
        "from isaaclab.actuators import ImplicitActuatorCfg\n",
        "#: For `ArticulationCfg(actuators=ACTUATORS)`; stiffness and damping are those of your drive.",
        "ACTUATORS = {",
        *(f"    {name!r}: ImplicitActuatorCfg({_arguments(entry)})," for name, entry in entries),
        "}",
    )


def _newton(joints: Sequence[SimulatedJoint], _: str | None) -> Written:
    """Attributes of Newton's `ModelBuilder`, 1.8: `joint_armature`, `joint_friction` and so on, of each coordinate."""
    entries, lines = {}, []
    for joint in joints:
        found = [(name, spec.joint(AXIS)) for name, spec in joint.native()]
        springs = {name: float(spring.stiffness[0]) for name, spring in found if not spring.springref}
        carried = [name for name, stiffness in springs.items() if stiffness]
        lines += joint.summary(carried, *joint.unlimited)
        values = {"armature": joint.armature, "friction": joint.coulomb, "damping": joint.damping}
        values["stiffness"] = sum(springs.values()) * joint.ratio**2
        entries[joint.name] = values | ({} if joint.limit is None else {"effort_limit": joint.limit})
    return _python(
        lines,
        "from newton import ModelBuilder\n",
        f"JOINTS = {entries!r}\n\n",
        "def onto(builder: ModelBuilder) -> None:",
        '    """Set the joints of a builder, before `finalize`; they are known by the end of their labels."""',
        "    for label, start in zip(builder.joint_label, builder.joint_qd_start):",
        '        for name, value in JOINTS.get(label.rpartition("/")[2], {}).items():',
        '            getattr(builder, f"joint_{name}")[start] = value',
    )


def _python(lines: Sequence[str], *code: str) -> Written:
    """A module with sentences before its code, and these sentences."""
    said = "".join(f"# {' '.join(plain(line).split())}\n" for line in lines)
    return said + "\n".join(code) + "\n", list(lines)


def _arguments(values: Mapping[str, Any]) -> str:
    return ", ".join(f"{name}={value!r}" for name, value in values.items())


#: What writes the file of each simulator.
TARGETS: dict[str, Callable[[Sequence[SimulatedJoint], str | None], Written]] = {
    "mjlab": _mjlab,
    "bam": _bam,
    "isaaclab": _isaaclab,
    "newton": _newton,
}
