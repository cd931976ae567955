"""What an effect may be: one piece of physics, or one fault of the measurement, with its whole description.

    motor torque = J*alpha + K_w*omega + K_0*sgn(omega) + sum over effects of strength_k * column_k(signals, shape)

Strengths enter linearly; shapes (a Stribeck speed, a harmonic) do not and are searched. An effect derives from the kind
that it is; its attributes declare what else is true of it. The rest of the bench reads both, and refers to no effect by
name.

    without memory          Torque, Friction, Inertia: one function is column and simulation (`bench.effects.torque`)
    over position           Wave, HarmonicTorque (`bench.effects.waves`)
    with memory             Bristles, Coupling and Contact, Lag, DriveLimit
    in one recording only   Occasional
    in the measurement      Distortion, EncoderFault, Lag; and a Torque whose stage is a sensor
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from bench.arrays import NORMAL95, Array, namespace, recursive_filter
from bench.effects.mjcf import Spec
from bench.effects.shape import LAG, Shape, Shapes, grid_of
from bench.effects.signals import Axis, Number, Scope, Signals, Values
from bench.rig.rig import Rig
from bench.trace.filter import Column, GaussianFilter
from bench.trace.trace import Trace
from bench.units import Quantity

#: Share of the inertia that sits behind a coupling, at least and at most.
BEHIND = (0.02, 0.98)
#: Share of the torque that friction takes at most: a worm of one thread at 1.3 degrees and friction of 0.05 passes 0.3
#: (R. G. Budynas, J. K. Nisbett, Shigley's Mechanical Engineering Design, 9th ed., 2011, eq. 13-46).
LOSSIEST = 0.7
#: Lags that a search tries first - s.
LAGS = (3e-4, 8e-4, 2e-3, 4e-3, 8e-3)


class Stage(IntEnum):
    """Where an effect acts, in the order of the signal chain from the recording to the load."""

    RECORDER = 0
    ENCODER = 1
    CURRENT_SENSOR = 2
    CURRENT_LOOP = 3
    TORQUE_CONSTANT = 4
    COMMUTATION = 5
    MECHANICS = 6


@dataclass(frozen=True)
class Proposal:
    """A shape of an effect, and by how much adding it to a fit would reduce the sum of squared residuals."""

    shape: tuple[float, ...]
    gain: float


@dataclass(frozen=True)
class Detected:
    """An effect read from signals directly, without the torque balance.

    Attributes:
        values, errors: its quantities and their half widths at 95 % - SI.
        evidence: the figures that support it.
        mends: whether the faulty signal, once corrected, is wrong by no more than noise.
    """

    values: Mapping[str, float]
    errors: Mapping[str, float]
    evidence: Mapping[str, float] = field(default_factory=dict)
    mends: bool = True


#: Columns of raw signals of a stretch, or of each of a recording's stretches.
ColumnsOf = Callable[[Signals], Sequence[Column]] | Sequence[Sequence[Column]]
#: What makes those of each stretch for shapes (k, s).
TablesOf = Callable[[Sequence[Signals], Shapes], Sequence[Sequence[Column]]]


class Fitted(Protocol):
    """A torque balance fitted to a recording, as far as effects may use it; see `bench.fit.fit.Fit`."""

    @property
    def scope(self) -> Scope: ...
    @property
    def base(self) -> Axis: ...
    @property
    def theta(self) -> Array: ...
    @property
    def columns(self) -> Array: ...
    @property
    def effort(self) -> Array: ...
    @property
    def residual(self) -> Array: ...
    @property
    def floor(self) -> float: ...
    @property
    def chance(self) -> float: ...
    @property
    def time(self) -> Array: ...
    @property
    def determined(self) -> NDArray[np.bool_]: ...
    @property
    def span(self) -> Array: ...
    def places(self, true_of: Callable[[Effect], bool]) -> NDArray[np.intp]: ...
    @property
    def stretches(self) -> Sequence[Signals]: ...
    def seen(self, columns: ColumnsOf, of_motion: bool) -> Array: ...
    def behind(self, tables: TablesOf, shapes: Shapes) -> Array: ...
    def gains(self, columns: Array, width: int) -> Array: ...
    def tried(self, effect: Effect, shapes: Sequence[tuple[float, ...]]) -> list[Proposal]: ...


class Effect(ABC):
    """What every effect is: named, with quantities, searched and reported.

    Attributes:
        name: as in the contract.
        summary: one line.
        quantities: its parameters, with unit and bounds.
        derived: quantities reported too, which follow from them.
        shapes: the nonlinear quantities, in the order in which all methods take them.
        stage: where it acts.
        needed: share of the squared residual above noise that it must explain, where others imitate a part of it.
        looks_like: names of effects without a shape that some recordings cannot distinguish from it, which fits decide.
        repeatable: an axis may have several, each of another shape (harmonics, events).
        replaces: names of effects that it is tried instead of, once no other addition explains more; see `in_place_of`.
        decoy: physics that no catalogue lists: it competes with the names of a search and never gets one.
        copies_torque: its columns are computed from the torque that reaches it, and of the noise of that, see
            `bench.fit.hypothesis.not_reaching`; it is without memory.
        rescales_torque: its one strength is what the torque that acts has more than the reported one, as share of that.
        of_speed: its torque depends only on speed.
        external: a varying torque that depends only on motion and time: behind a coupling it may act on the load as on
            the motor.
        transmitted: a torque of the load, which the transmission carries and friction may follow.
        constant: a transmitted torque that never varies: in motion of one direction it looks like dry friction.
        spring: a transmitted torque that pulls back to a position; its first strength is the stiffness - N*m/rad
            (N/m) -, its second a constant.
        directed: dry friction that differs between the directions.
        scales_friction: dry friction in proportion to the level that other effects make.
        follows_load: dry friction caused by the torque of the load, given by `AxisState.load`.
        filters_motion: noise of the motion passes through it, and so biases its strength or shape.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    quantities: ClassVar[tuple[Quantity, ...]]
    derived: ClassVar[tuple[Quantity, ...]] = ()
    shapes: ClassVar[tuple[Shape, ...]] = ()
    stage: ClassVar[Stage] = Stage.MECHANICS
    needed: ClassVar[float] = 0.0
    looks_like: ClassVar[tuple[str, ...]] = ()
    repeatable: ClassVar[bool] = False
    replaces: ClassVar[frozenset[str]] = frozenset()
    decoy: ClassVar[bool] = False
    copies_torque: ClassVar[bool] = False
    rescales_torque: ClassVar[bool] = False
    of_speed: ClassVar[bool] = False
    external: ClassVar[bool] = False
    transmitted: ClassVar[bool] = False
    constant: ClassVar[bool] = False
    spring: ClassVar[bool] = False
    directed: ClassVar[bool] = False
    scales_friction: ClassVar[bool] = False
    follows_load: ClassVar[bool] = False
    filters_motion: ClassVar[bool] = False

    def __reduce__(self) -> str:
        """Pickled by its name in its module: there is one object of each effect."""
        return "EFFECT"

    @property
    def of_measurement(self) -> bool:
        """Whether it is a fault of the measurement rather than physics of the axis."""
        return self.stage <= Stage.CURRENT_SENSOR

    @property
    def positive(self) -> frozenset[str]:
        """Names of quantities that are known up to a factor."""
        return frozenset(each.name for each in (*self.quantities, *self.derived) if each.positive)

    def null(self, axis: Axis) -> Values:
        """Values of some quantities at which the effect is exactly absent - SI."""
        return {quantity.name: quantity.null for quantity in self.quantities if quantity.null is not None}

    def defaults(self, axis: Axis) -> Values:
        """Values of quantities that may be left out - SI."""
        return {quantity.name: quantity.preset for quantity in self.quantities if quantity.preset is not None}

    def native(self, values: Mapping[str, float], friction_varies: bool) -> bool:
        """Whether MuJoCo simulates it by itself with these values; `friction_varies`: others change friction."""
        return type(self).add is not Effect.add

    def add(self, spec: Spec, name: str, values: Mapping[str, float], axis: Axis) -> None:
        """Add a native effect to the MuJoCo model; `name` is free to name the new elements."""
        raise NotImplementedError(f"{self.name} is not native")

    def least(self, axis: Axis) -> Values:
        """Lower bounds of quantities beyond which it is not this effect on such an axis - SI."""
        return {}

    def sought(self, scope: Scope) -> bool:
        """Whether the torque balance of such a recording can show it."""
        return True

    def propose(self, fitted: Fitted) -> list[Proposal]:
        """Shapes to add to a fit, with the gain of each; by default those of the grid, none of one that replaces."""
        return [] if self.replaces else fitted.tried(self, grid_of(self.shapes, fitted.scope))

    def in_place_of(self, fitted: Fitted, promises: Callable[[float], bool]) -> tuple[float, ...] | None:
        """Its most likely shape in a fit without the effects that it replaces; None where it can be none.

        `promises`: whether the squares that a grid's shape explains make a search from it worth its cost.
        """
        return None

    def unlike(self, fitted: Fitted) -> tuple[float, ...] | None:
        """A shape with which it clearly differs from what it replaces, if that is a form of it; else None."""
        return None

    def detect(self, trace: Trace, rig: Rig, width: float) -> Detected | None:
        """The effect read from signals, smoothed by a filter of this width - s; None if they do not show it directly.

        Without the torque balance; see `smoothed`.
        """
        return None

    def reach(self, shape: Sequence[float], k: int) -> float:
        """First range of a search in the k-th shape quantity; see `Shape.reach`."""
        return self.shapes[k].reach

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> bool:
        """Whether every quantity lies within its physical bounds."""
        found = self.report(strengths, shape, base)
        return all(q.lower <= found[q.name] <= q.upper for q in self.quantities if q.name in found)

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        """Whether its terms, several if it is repeatable, are credible in such a recording."""
        return True

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> Mapping[str, float]:
        """The effect's quantities from fitted strengths and shape - SI; by default these are they."""
        searched = {slot.quantity for slot in self.shapes}
        linear = [quantity.name for quantity in self.quantities if quantity not in searched]
        own = dict(zip(linear, strengths, strict=False))
        return own | {slot.quantity.name: value for slot, value in zip(self.shapes, shape, strict=True)}

    def shape_errors(self, shape: Sequence[float], scope: Scope, time: Array) -> Sequence[float]:
        """Standard deviations of its shape beyond those from noise; `time` of the rows - s (m,)."""
        return [0.0] * len(self.shapes)

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """Names of the effects that such a recording cannot distinguish from it."""
        return ()


# In the torque balance.


class Columns(Effect):
    """Resisting torque that is linear in its strengths.

    Attributes:
        bounded: bounds of strengths in a fit, by their index.
        memoryless: each value of a column is computed from its own sample only, so those of a recording with holes are
            made at once.
    """

    bounded: ClassVar[Mapping[int, tuple[float, float]]] = {}
    memoryless: ClassVar[bool] = False

    @abstractmethod
    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Resisting torque per unit of each strength - N*m (N) per unit - (n,), unfiltered."""

    def columns_of(self, signals: Signals, shapes: Shapes) -> list[Column]:
        """Columns of several shapes, one after the other."""
        return [column for shape in shapes for column in self.columns(signals, shape)]


class Occasional(Columns):
    """It may occur in one recording and not in another, and several times."""

    repeatable = True

    @abstractmethod
    def apart(self, fitted: Fitted) -> list[tuple[tuple[float, ...], tuple[float, float]]]:
        """Those that a residual shows by themselves, whatever else it contains: shapes, and begin and end of the
        stretch of time that distinguishes each from the rest - s."""

    @abstractmethod
    def duration(self, shape: Sequence[float]) -> float:
        """For which it acts - s."""

    @abstractmethod
    def indistinct(self, shape: Sequence[float], time: Array, scope: Scope) -> list[tuple[float, ...]]:
        """Shapes that rows at some times (m,) - s - do not distinguish from one, that one first."""


#: An effect on the load behind a coupling: the effect, its shape, its strengths divided by the load inertia.
Load = tuple[Columns, tuple[float, ...], tuple[float, ...]]


class Coupling(Columns):
    """Motor and load are joined by a spring; an axis has at most one. The column's first strength is the load's
    inertia.

    Its columns are accelerations, which a lag of the reported speed delays as it does that of J.
    """

    def columns_of(self, signals: Signals, shapes: Shapes, loads: Sequence[Load] = ()) -> list[Column]:
        """The same; `loads` act on the load, as far as it lets them."""
        return super().columns_of(signals, shapes)

    def tables_of(self, stretches: Sequence[Signals], shapes: Shapes) -> list[list[Column]]:
        """The same in each of several stretches of a recording."""
        return [self.columns_of(signals, shapes) for signals in stretches]

    @abstractmethod
    def noise_of_motion(self, shape: Sequence[float], omega: Array) -> Array | NDArray[np.complex128]:
        """Transfer from acceleration to its first column at angular frequencies - rad/s (k,) -: (k,)."""

    def resonances(self, shape: Sequence[float]) -> list[tuple[float, float]]:
        """Frequency and half width at half power of each resonance of this transfer - rad/s."""
        return []

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Axis) -> bool:
        """Part of the inertia sits behind it."""
        return BEHIND[0] < strengths[0] / base.inertia < BEHIND[1]

    def credible(self, shape: Sequence[float]) -> bool:
        """Whether a search may end with this shape; it may always pass through it."""
        return True


class Contact(Coupling):
    """Parts that meet and part: the residuals of their impacts come in bursts, and the instant of one depends on the
    last."""

    @abstractmethod
    def wave_number(self, shape: Sequence[float]) -> float:
        """A turn over the width in which they are separate: its product with an error of position is one of phase."""

    @abstractmethod
    def period(self, shape: Sequence[float]) -> float:
        """Of the oscillation of parts in contact - s."""

    @abstractmethod
    def open_torque(self, fitted: Fitted, shape: Sequence[float]) -> Array:
        """By how much its torque is undetermined in each row - N*m (N) per unit of its strength - (m,)."""

    @abstractmethod
    def spread(self, fitted: Fitted, shape: Sequence[float]) -> Array:
        """Covariance of its free shapes, which the curvature of the likelihood does not give."""


# In the recording.


class Distortion(Effect):
    """What is recorded is not what acts or moves, in a way that is no column: a fit sees the recording without it."""

    @abstractmethod
    def without_fault(self, signals: Signals, shape: Sequence[float]) -> Signals:
        """The recording without this fault."""


class EncoderFault(Distortion):
    """The encoder errs, and the drive believes it."""

    stage = Stage.ENCODER

    @abstractmethod
    def measured(self, values: Values, position: Number, velocity: Number) -> tuple[Number, Number]:
        """Position and velocity as the encoder measures them, from the true ones - rad (m), rad/s (m/s)."""

    @abstractmethod
    def actual(self, values: Mapping[str, float], position: Array, velocity: Array) -> tuple[Array, Array]:
        """True position and velocity from those that the encoder measured, (n,) each."""

    def without_fault(self, signals: Signals, shape: Sequence[float]) -> Signals:
        """The recording of the true motion."""
        values = self.report((), shape, signals.unit)
        position, velocity = self.actual(values, signals.position, signals.velocity)
        return replace(signals, position=position, velocity=velocity)


class Lag(Distortion):
    """A first-order lag, T*dy/dt + y = u; two at once show as their difference, so a recording determines only one.

    Attributes:
        signal: that lags: `velocity` or `current` between the drive and the recording, or the `torque` that acts behind
            the reported current.
    """

    quantities = (Quantity("time_constant", "T", "s", lower=0.0, null=0.0),)
    shapes = (Shape(quantities[0], LAGS, reach=1.0, measure=LAG),)
    stage = Stage.RECORDER
    signal: ClassVar[str]

    def lagging(self, values: Mapping[str, float], samples: Array, step: float) -> Array:
        """The signal behind the lag (n,), from the samples before it at a constant step - s."""
        return lagged(samples, values["time_constant"], step)

    def leading(self, values: Mapping[str, float], samples: Array, step: float) -> Array:
        """The signal before the lag (n,), from the samples behind it: y + T*dy/dt, by central differences."""
        return samples + values["time_constant"] * np.gradient(samples, step) if samples.size > 1 else samples

    def stepped(self, values: Values, reported: Number, before: Number, step: float) -> tuple[Number, Number]:
        """Torque that acts of a reported one that is held over a step: at the middle, and at the end of it.

        Exact; `before` is what acts at its start.
        """
        passed = -0.5 * step / values["time_constant"]
        half = namespace(passed).exp(passed)
        return reported + (before - reported) * half, reported + (before - reported) * half**2

    def delays(self, shape: Sequence[float], source: str) -> tuple[float, float, float]:
        """Lags to undo in columns of motion, in others, and in the effort, if speed comes from `source` - s."""
        lag = shape[0]
        if self.signal == "velocity":  # what is computed from the reported speed
            return (lag if source == "velocity" else 0.0), 0.0, 0.0
        return (lag, lag, 0.0) if self.signal == "torque" else (0.0, 0.0, lag)

    def without_fault(self, signals: Signals, shape: Sequence[float]) -> Signals:
        """Where the axis is, as position summed from the reported speed v lags by T*v; or the torque that acts."""
        values, step = self.report((), shape, signals.unit), signals.sample_period
        if self.signal == "velocity":
            return replace(signals, position=signals.position + values["time_constant"] * signals.velocity)
        passed = self.lagging if self.signal == "torque" else self.leading
        return replace(signals, torque=passed(values, signals.torque, step))

    def corrected(self, trace: Trace, values: Mapping[str, float]) -> Trace:
        """The recording with its signal as the drive has it."""
        samples = trace[self.signal].copy()
        for part in trace.segments:
            samples[part] = self.leading(values, samples[part], trace.sample_period)
        return trace.with_signals({self.signal: samples}, {})

    def plausible(self, strengths: Shapes, shapes: Shapes, scope: Scope) -> bool:
        """Whether its corner 1/(2*pi*T) is above the lowest frequency of the recording; below that, it integrates."""
        return all(2.0 * np.pi * shape[0] <= scope.duration for shape in shapes)

    def shape_errors(self, shape: Sequence[float], scope: Scope, time: Array) -> Sequence[float]:
        """By the tick within which current and speed were taken."""
        return [scope.latched / NORMAL95]


def lagged(values: Array, time_constant: float, step: float) -> Array:
    """Values (n,) behind a lag - s -, exact for an input that runs straight between samples; started in equilibrium."""
    decay = np.exp(-step / time_constant)
    mean = time_constant / step * (1.0 - decay)
    now, before = 1.0 - mean, mean - decay
    return recursive_filter([now, before], [1.0, -decay], values, held=values[0] * (1.0 - now))


def smoothed(trace: Trace, smooth: GaussianFilter, name: str, *orders: int) -> Array:
    """Derivatives of such orders of a recorded signal through a filter (k, m), all stretches long enough in a row."""
    parts = [part for part in trace.segments if part.stop - part.start > 4 * smooth.margin]
    found = [smooth(trace[name][part], *orders) for part in parts]
    return np.concatenate([np.empty((len(orders), 0)), *found], axis=1)


# In the drive, and in the joint.


class DriveLimit(Effect):
    """A limit of the drive: visible where the drive runs the model, and hardly where the recording tracks it."""

    stage = Stage.CURRENT_LOOP

    def sought(self, scope: Scope) -> bool:
        """The torque balance is of the effort that flows."""
        return False

    @abstractmethod
    def flowing(
        self, values: Values, axis: Axis, velocity: Number, demand: Number, before: Number, step: float
    ) -> tuple[Number, Number]:
        """Effort that flows at a demand: mean over the step, and at its end; `before` is that at its start."""

    @abstractmethod
    def shown_in(self, trace: Trace, rig: Rig, values: Mapping[str, float]) -> Trace:
        """The part of a recording in which it is visible."""


class Bristles(Columns):
    """It replaces dry friction as a whole, including what other effects add and scale."""

    def sought(self, scope: Scope) -> bool:
        """Not in motion of one direction, where such friction looks like a torque, e.g. like an unbalance."""
        return super().sought(scope) and not scope.one_way
