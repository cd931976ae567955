"""What is to be run: an axis, what is hidden in it, its motion and its sensors, drawn from seed and index alone.

Axes are drawn over all their ranges; of one's own axis, with its rig, motion and sensors, only noise is drawn.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from bench.axis_kind import COULOMB, INERTIA, VISCOUS
from bench.effects.catalogue import catalogue
from bench.errors import InputError
from bench.fit.identify import identify
from bench.names import nearest
from bench.plant.axis_model import AxisParameters, winding_of
from bench.plant.drive import Cascade
from bench.plant.profiles import MotionLimits, plan
from bench.plant.simulate import Sampled, motion_of
from bench.rig.rig import Rig, Simulation, require
from bench.structured import parse_toml
from bench.trace.noise import resolution, white_noise
from bench.trace.trace import Trace
from bench.validation.independent.effects import KINDS, Effect, any_effects
from bench.validation.independent.references import MOTIONS, Motion
from bench.validation.independent.rig import Axis, random_rig, rig_text
from bench.validation.independent.sensors import Noise, Sensors, random_sensors

Plant = Literal["independent", "mujoco"]
PLANTS: tuple[Plant, ...] = ("independent", "mujoco")
#: Of a drawn recording, about - s.
DURATION = (4.0, 8.0)
#: Of every drawn axis' drive, so that axes are integrated side by side - s.
CONTROL_PERIOD = 250e-6
#: Share of drawn axes that are linear, and of drawn motions that are mixed; the others are as many of each kind.
LINEAR, MIXED = 0.12, 0.4
#: How strong a hidden effect is: from just above noise to drastic.
SEVERITY = (0.15, 0.8)


@dataclass(frozen=True)
class Case:
    """What is recorded in one run.

    Attributes:
        index: of the run.
        plant: that moves it.
        axis, rig: its true values, and what is known of it.
        motion, motion_name: that its drive is commanded to make, and its kind.
        sensors: that record it.
        effects, severity: hidden in it, as strong as was drawn.
    """

    index: int
    plant: Plant
    axis: Axis
    rig: Rig
    motion: Motion
    motion_name: str
    sensors: Sensors
    effects: tuple[Effect, ...] = ()
    severity: float = 0.0

    @property
    def hidden(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(effect.name for effect in self.effects)


#: What cases are drawn from: the case of an index, with nothing hidden, by a generator of its own.
Population = Callable[[int, np.random.Generator], Case]


def any_axis(index: int, rng: np.random.Generator) -> Case:
    """Axis, motion and sensors over all their ranges; these stand in `docs/validate.md`."""
    linear = bool(rng.random() < LINEAR)
    axis = replace(random_rig(rng, f"run {index}", linear=linear), control_period=CONTROL_PERIOD)
    others = (1.0 - MIXED) / (len(MOTIONS) - 1)
    name = str(rng.choice([*MOTIONS], p=[MIXED if k == 0 else others for k in range(len(MOTIONS))]))
    motion = MOTIONS[name](axis, rng, float(rng.uniform(*DURATION)))
    rig = Rig.of(parse_toml(rig_text(axis), axis.name), axis.name)
    plant = PLANTS[int(rng.integers(len(PLANTS)))]
    return Case(index, plant, axis, rig, motion, name, random_sensors(axis, rng))


#: Names that can be hidden: those that the independent axis has too.
HIDEABLE = tuple(name for name in KINDS if name in catalogue())
#: Effects at most in one axis.
MOST = 6
COUNTS = re.compile(r"(\d+)(?:-(\d+))?")


@dataclass(frozen=True)
class Hiding:
    """What is hidden.

    Attributes:
        least, most: how many of the catalogue, drawn at random.
        names: instead, one at a time, and after the last of them a run with nothing hidden.
    """

    least: int = 0
    most: int = 0
    names: tuple[str, ...] = ()

    @classmethod
    def parse(cls, text: str) -> Hiding:
        """`2`, `0-3`, `all`, or names separated by commas.

        Raises:
            InputError: none of these.
        """
        counts = COUNTS.fullmatch(text.strip())
        if counts:
            least = int(counts[1])
            most = int(counts[2] or least)
            if not least <= most <= MOST:
                raise InputError("--effects", f"found {text}", f"allowed: 0 to {MOST}, the smaller number first")
            return cls(least, most)
        names = HIDEABLE if text.strip() == "all" else tuple(name.strip() for name in text.split(","))
        for name in names:
            if name not in HIDEABLE:
                found = f"found '{name}'{nearest(name, list(HIDEABLE))}"
                raise InputError("--effects", found, f"allowed: a count as 0-3, all, or some of {', '.join(HIDEABLE)}")
        return cls(names=names)

    @property
    def anything(self) -> bool:
        """Whether any run hides an effect."""
        return self.most > 0 or bool(self.names)

    def drawn(self, index: int, rng: np.random.Generator, axis: Axis) -> tuple[str, ...]:
        """Names hidden in a run, of those that its axis can have."""
        impossible = frozenset(name for name in HIDEABLE if not KINDS[name].possible(axis))
        if self.names:
            place = index % (len(self.names) + 1)
            return tuple(name for name in self.names[place : place + 1] if name not in impossible)
        return any_effects(int(rng.integers(self.least, self.most + 1)), rng, without=impossible)


@dataclass(frozen=True)
class Plan:
    """A Monte Carlo; run k depends on the seed, k and what is drawn from, and on nothing else.

    Attributes:
        seed: of all that is random.
        hiding: effects of the runs.
        diagnose: whether `diagnose` is run too, and not only `identify`.
        population: that cases are drawn from.
    """

    seed: int = 0
    hiding: Hiding = Hiding()
    diagnose: bool = False
    population: Population = any_axis

    def case(self, index: int) -> Case:
        """The case of an index; its effects are all as strong as one draw."""
        rng = np.random.default_rng(np.random.SeedSequence(self.seed, spawn_key=(index,)))
        plain = self.population(index, rng)
        names = self.hiding.drawn(index, rng, plain.axis)
        if not names:
            return plain
        severity = float(rng.uniform(*SEVERITY))
        effects = tuple(KINDS[name].draw(plain.axis, severity, rng, plain.motion.duration) for name in names)
        return replace(plain, effects=effects, severity=severity)


#: Signals of what moved an axis.
EFFORTS = {"current", "torque", "force"}


@dataclass(frozen=True)
class OwnAxis:
    """The same axis in every run; noise and the age of the current are drawn.

    Attributes:
        case: of it, but for what is drawn.
        plants: that can move it.
    """

    case: Case
    plants: tuple[Plant, ...]

    def __call__(self, index: int, rng: np.random.Generator) -> Case:
        """A case of it, as of any population."""
        plant = self.plants[int(rng.integers(len(self.plants)))]
        sensors = replace(self.case.sensors, current_age=int(rng.integers(2)))
        return replace(self.case, index=index, plant=plant, sensors=sensors)


def own_axis(rig: Rig, profile: str, recording: Trace | None) -> OwnAxis:
    """The axis of a rig along a motion of its own.

    What the rig does not state of the simulated axis and its sensors, in `[simulation]`, is taken from the recording.

    Args:
        rig: with `[drive]`; InputError where it or the recording lack something.
        profile: name of a motion (`bench.plant.profiles`), or what the recording is called.
        recording: of the motion; None to take the named one. UndeterminedError where it does not determine what it has
            to.
    """
    if rig.load is not None and rig.load.eccentric_mass is not None:
        raise InputError(f"{rig.source}: load.eccentric_mass", "found one", "allowed: none; the plants do not swing it")
    if rig.simulation is None and recording is not None and EFFORTS & set(recording.signals):
        rig = rig.model_copy(update={"simulation": as_recorded(rig, recording)})
    require(rig, "validate")
    parameters, cascade = AxisParameters.from_rig(rig), Cascade.from_rig(rig)
    if recording is None:
        references = plan(profile, MotionLimits.from_rig(rig, parameters, cascade.control_period))
        motion = Sampled(references.time, references.velocity)
    else:
        motion = motion_of(recording)
    constant, simulation, period = rig.motor.torque_per_ampere, rig.simulated, cascade.control_period
    assert constant is not None  # `require` has seen to it
    sensors = Sensors(
        sample_period=max(1, round(simulation.sample_period / period)) * period,
        encoder_resolution=simulation.encoder_resolution,
        velocity=Noise(white=simulation.velocity_noise, resolution=_step(recording, "velocity")),
        current=Noise(white=simulation.current_noise, resolution=_step(recording, "current")),
        position_recorded=recording is None or "position" in recording,
    )
    # the independent plant has a motor that does not saturate, and no load torque
    plain = simulation.friction == "mechanics" and not simulation.load_torque and not constant.curvature
    axis = _axis(rig, parameters, cascade, motion.top)
    plants = PLANTS if plain else ("mujoco",)
    return OwnAxis(Case(0, plants[0], axis, rig, Motion((motion,)), profile, sensors), plants)


def as_recorded(rig: Rig, recording: Trace) -> Simulation:
    """Inertia and friction of an axis by a recording; UndeterminedError where it does not determine them."""
    found = identify(recording, rig)
    inertia, viscous, coulomb = (found[rig.axis_kind.parameter(term)].value for term in (INERTIA, VISCOUS, COULOMB))
    values = {
        rig.axis_kind.inertia: inertia,
        "viscous_friction_coefficient": max(viscous, 0.0),
        "coulomb_friction": max(coulomb, 0.0),
        "sample_period": recording.sample_period,
        "encoder_resolution": _step(recording, "position"),
        "velocity_noise": white_noise(recording["velocity"]) if "velocity" in recording else 0.0,
        "current_noise": white_noise(recording["current"]) if "current" in recording else 0.0,
    }
    return Simulation().model_copy(update=values)


def _step(recording: Trace | None, name: str) -> float:
    return resolution(recording[name]) if recording is not None and name in recording else 0.0


def _axis(rig: Rig, parameters: AxisParameters, cascade: Cascade, top_speed: float) -> Axis:
    constant, drive, winding = rig.motor.torque_per_ampere, rig.drive, winding_of(rig)
    assert constant is not None and drive is not None  # `require` has seen to it
    emf = {"back_emf_constant": 0.0}
    if winding is not None:
        emf = {name: getattr(winding, name) for name in ("resistance", "inductance", "back_emf_constant")}
    return Axis(
        name=rig.name,
        inertia=parameters.inertia,
        viscous=parameters.viscous_friction_coefficient,
        coulomb=parameters.coulomb_friction,
        rotor_inertia=parameters.motor_inertia,
        torque_constant=constant.constant,
        peak_current=float(cascade.torque_limit) / constant.constant,
        position_gain=drive.position_gain,
        velocity_gain=drive.velocity_gain,
        integral_gain=drive.integral_gain,
        inertia_feedforward=drive.inertia_feedforward,
        control_period=cascade.control_period,
        top_speed=top_speed,
        linear=not rig.axis_kind.turns,
        **emf,
    )
