"""An effect: one piece of physics, or one fault of the measurement, with everything the bench needs to know about it.

    motor torque = J*alpha + K_w*omega + K_0*sgn(omega) + sum over effects of strength_k * column_k(signals, shape)

Strengths enter linearly; shapes (a Stribeck speed, a harmonic) do not and are searched. An effect overrides what is not
neutral for it; the rest of the bench knows no effect by name. How effects act in a simulation: `bench.effects.kinds`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array
from bench.effects.grids import is_pitch, places
from bench.effects.signals import Base, Scope, Shape, Shapes, Signals
from bench.rig.rig import Rig
from bench.trace.filter import Column
from bench.trace.trace import Trace
from bench.units import Quantity

if TYPE_CHECKING:
    from bench.effects.kinds import Axis, Number

#: Share of the squared residual above noise that an effect must explain (see `tests.studies.blind.margins`), and
#: that of a pitch with more than MANY half cycles in a linear axis' travel, which no smooth error imitates.
SHARE, PITCH_SHARE, MANY = 0.25, 0.1, 20.0

#: An effect on the load behind a coupling: the effect, its shape, its strengths divided by the load inertia.
Load = tuple["Effect", tuple[float, ...], tuple[float, ...]]


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


class FittedTerm(Protocol):
    """A term of a fitted balance: an effect of a shape."""

    @property
    def effect(self) -> Effect: ...  # noqa: D102
    @property
    def shape(self) -> tuple[float, ...]: ...  # noqa: D102


class Fitted(Protocol):
    """A torque balance fitted to a recording, as far as effects may use it; see `bench.fit.fit.Fit`."""

    @property
    def theta(self) -> Array: ...  # noqa: D102
    @property
    def owners(self) -> NDArray[np.object_]: ...  # noqa: D102
    @property
    def scope(self) -> Scope: ...  # noqa: D102
    @property
    def terms(self) -> Sequence[FittedTerm]: ...  # noqa: D102
    @property
    def columns(self) -> Array: ...  # noqa: D102
    @property
    def effort(self) -> Array: ...  # noqa: D102
    @property
    def residual(self) -> Array: ...  # noqa: D102
    @property
    def floor(self) -> float: ...  # noqa: D102
    @property
    def time(self) -> Array: ...  # noqa: D102
    @property
    def span(self) -> Array: ...  # noqa: D102
    def seen(self, columns: Callable[[Signals], Sequence[Column]], of_motion: bool) -> Array: ...  # noqa: D102
    def gains(self, columns: Array, width: int) -> Array: ...  # noqa: D102
    def tried(self, effect: Effect, shapes: Sequence[tuple[float, ...]]) -> list[Proposal]: ...  # noqa: D102


class Effect:
    """Base class of everything in the catalogue.

    Attributes:
        name: as in the contract.
        summary: one line.
        quantities: its parameters, with unit and bounds.
        derived: quantities reported too, which follow from them.
        shapes: the nonlinear quantities, in the order in which all methods take them.
        of_motion: whether its columns are accelerations, which a lag of the reported speed delays as it does that of J.
        copies_torque: whether its columns are computed from the measured torque, and so contain its noise.
        scales_friction: whether it multiplies the level of dry friction, including what other effects add to it.
        carries_friction: whether it replaces dry friction as a whole, including what other effects add and scale.
        bounded: bounds of strengths in a fit, by their index.
        may_load: whether it may act on the load of a coupling rather than on the motor.
        couples: whether it joins motor and load; an axis has at most one such effect.
        turning_only: whether it is meaningless on a linear axis.
        of_speed_alone: whether its torque depends on speed alone.
        repeatable: whether an axis may have several, each with another shape (harmonics, events).
        occasional: whether it may occur in one recording and not in another.
        bursts: whether the residual it leaves comes in bursts.
        biased_by_noise: whether noise of the motion biases its strength or shape, and not only scatters it.
        not_beside: effects it is not searched together with, as a recording can identify only one of them.
        replaces: effects that it is tried instead of, once no other addition explains more.
        faulty_signal: the signal that `corrected` repairs; empty if none.
        shows_under_drive: whether it is visible if the drive runs the model, and hardly if the recording tracks it.
        tolerates: share of the first gap that may remain with it, if that differs from other effects.
        fixed_in_simulation: quantities that a fit by simulation leaves alone: whole numbers, instants between samples.
        undiagnosed: why no recording can show it; empty if one can, which a test demonstrates.
    """

    name: ClassVar[str]
    summary: ClassVar[str]
    quantities: ClassVar[tuple[Quantity, ...]]
    derived: ClassVar[tuple[Quantity, ...]] = ()
    shapes: ClassVar[tuple[Shape, ...]] = ()
    of_motion: ClassVar[bool] = False
    copies_torque: ClassVar[bool] = False
    scales_friction: ClassVar[bool] = False
    carries_friction: ClassVar[bool] = False
    bounded: ClassVar[Mapping[int, tuple[float, float]]] = {}
    may_load: ClassVar[bool] = False
    couples: ClassVar[bool] = False
    turning_only: ClassVar[bool] = False
    of_speed_alone: ClassVar[bool] = False
    repeatable: ClassVar[bool] = False
    occasional: ClassVar[bool] = False
    bursts: ClassVar[bool] = False
    biased_by_noise: ClassVar[bool] = False
    not_beside: ClassVar[frozenset[str]] = frozenset()
    replaces: ClassVar[frozenset[str]] = frozenset()
    faulty_signal: ClassVar[str] = ""
    shows_under_drive: ClassVar[bool] = False
    tolerates: ClassVar[float | None] = None
    fixed_in_simulation: ClassVar[frozenset[str]] = frozenset()
    undiagnosed: ClassVar[str] = ""

    def null(self, axis: Axis) -> Mapping[str, Number]:
        """Values of some quantities at which the effect is exactly absent - SI."""
        return {quantity.name: quantity.null for quantity in self.quantities if quantity.null is not None}

    def defaults(self, axis: Axis) -> Mapping[str, Number]:
        """Values of quantities that may be left out - SI."""
        return {quantity.name: quantity.preset for quantity in self.quantities if quantity.preset is not None}

    def see(self, signals: Signals, shape: Sequence[float]) -> Signals:
        """The recording without this fault of its sensors."""
        return signals

    def delays(self, shape: Sequence[float], source: str) -> tuple[float, float]:
        """Lags to undo in columns of motion, and in all others, if speed comes from `source` - s."""
        return 0.0, 0.0

    def effort_lag(self, shape: Sequence[float]) -> float:
        """Lag to undo in the reported effort - s."""
        return 0.0

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Resisting torque per unit of each strength - N*m (N) per unit - (n,), unfiltered."""
        return []

    def columns_of(self, signals: Signals, shapes: Shapes, loads: Sequence[Load] = ()) -> list[Column]:
        """Columns of several shapes, one after the other; `loads` act behind the effect if it couples."""
        return [column for shape in shapes for column in self.columns(signals, shape)]

    def level(self, signals: Signals, shape: Sequence[float], strengths: Sequence[float]) -> Array | float:
        """Signed dry friction in addition to Coulomb friction, at these strengths - the strengths' unit - (n,)."""
        return 0.0

    def stiffness(self, strengths: Sequence[float]) -> float:
        """Stiffness with which it pulls the load back - N*m/rad (N/m)."""
        return 0.0

    def load_inertia(self, strengths: Sequence[float]) -> float:
        """Inertia of the load, if it couples - kg*m**2 (kg)."""
        return 0.0

    def noise_of_motion(self, shape: Sequence[float], omega: Array) -> Array | NDArray[np.complex128]:
        """Transfer from acceleration to its first column at angular frequencies - rad/s (k,) -: (k,)."""
        return np.zeros_like(omega)

    def open_torque(self, fitted: Fitted, index: int) -> Array | None:
        """By how much its torque is undetermined, in each row - N*m (N) - (m,); None: it is not."""
        return None

    # How a search finds it.

    def sought(self, scope: Scope) -> bool:
        """Whether the torque balance of such a recording can show it."""
        return scope.kind.turns or not self.turning_only

    def grid(self, scope: Scope) -> list[tuple[float, ...]]:
        """Shapes that a search tries first."""
        return list(product(*(places(shape, scope) for shape in self.shapes)))

    def propose(self, fitted: Fitted) -> list[Proposal]:
        """Shapes to add to a fit, with the gain of each; by default those of the grid."""
        return fitted.tried(self, self.grid(fitted.scope))

    def in_place_of(self, fitted: Fitted) -> tuple[float, ...] | None:
        """Its most likely shape in a fit without the effects that it replaces."""
        return None

    def reach(self, shape: Sequence[float], k: int) -> float:
        """First range of a search in the k-th shape quantity; see `Shape.reach`."""
        return self.shapes[k].reach

    def needed_share(self, shape: Sequence[float], scope: Scope) -> float:
        """Share of the squared residual above the noise floor that it must explain to be accepted."""
        pitches = [value for slot, value in zip(self.shapes, shape, strict=True) if is_pitch(slot, scope)]
        return PITCH_SHARE if any(value > MANY * scope.spacing for value in pitches) else SHARE

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> bool:
        """Whether every quantity lies within its physical bounds."""
        found = self.report(strengths, shape, base)
        return all(q.lower <= found[q.name] <= q.upper for q in self.quantities if q.name in found)

    def plausible(self, strengths: Sequence[Sequence[float]], shapes: Shapes, scope: Scope) -> bool:
        """Whether its terms, several if it is repeatable, are credible in such a recording."""
        return True

    def credible(self, shape: Sequence[float]) -> bool:
        """Whether a search may end with this shape; it may always pass through it."""
        return True

    def wave_number(self, shape: Sequence[float]) -> float | None:
        """Wave number of its torque over position - 1 (rad/m); None if it is no wave."""
        return None

    def simpler_forms(self) -> tuple[str, ...]:
        """Names of the effects that it reduces to where some of its strengths are zero."""
        return ()

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """The effect's quantities from fitted strengths and shape - SI."""
        return {slot.quantity.name: value for slot, value in zip(self.shapes, shape, strict=True)}

    def shape_errors(self, shape: Sequence[float], scope: Scope, time: Array) -> Sequence[float]:
        """Standard deviations of its shape beyond those from noise; `time` of the rows - s (m,)."""
        return [0.0] * len(self.shapes)

    def spread(self, fitted: Fitted, index: int) -> Array | None:
        """Covariance of its free shapes where the curvature of the likelihood does not give it; else None."""
        return None

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """Names of the effects that such a recording cannot distinguish from it."""
        return ()

    # Effects outside the torque balance.

    def detect(self, trace: Trace, rig: Rig, width: float) -> Detected | None:
        """The effect read directly from signals, smoothed by a filter of this width - s; None if not visible."""
        return None

    def corrected(self, trace: Trace, values: Mapping[str, float]) -> Trace:
        """The recording with the faulty signal corrected."""
        return trace

    def shown_in(self, trace: Trace, rig: Rig, values: Mapping[str, float]) -> Trace:
        """The part of a recording in which it is visible, if it `shows_under_drive`."""
        return trace

    def counterpart(self, name: str, values: Mapping[str, float]) -> Mapping[str, float] | None:
        """Values of an effect it is `ambiguous` with at which both look alike; None if they do in every motion."""
        return None

    def instead_of_dry_friction(self, torque: float) -> Mapping[str, float] | None:
        """Values at which it looks like dry friction of this signed torque - N*m (N) - in motion of one direction."""
        return None

    @property
    def kind(self) -> str:
        """`physics`, or `measurement` for a fault of a sensor."""
        return "physics"

    @classmethod
    def overrides(cls, hook: str) -> bool:
        """Whether the effect overrides a hook of its base class."""
        neutral: Any = next((vars(base)[hook] for base in cls.__mro__[::-1] if hook in vars(base)), None)
        return getattr(cls, hook, None) is not neutral
