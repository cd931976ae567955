"""What an effect is: one piece of physics, or one fault of the measurement, with all that anybody has to know of it.

    motor torque = J*alpha + K_w*omega + K_0*sgn(omega) + sum over effects of strength_k * column_k(signals, shape)

Strengths enter linearly; shapes (a Stribeck speed, a harmonic, a time constant) do not and are profiled. An effect
overrides what is not neutral in it; the rest of the bench asks the object. In a simulation: `bench.effects.kinds`.
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
from bench.effects.signals import Base, Scope, Shape, Signals
from bench.rig.rig import Rig
from bench.trace.filter import Column
from bench.trace.trace import Trace
from bench.units import Quantity

if TYPE_CHECKING:
    from bench.effects.kinds import Axis, Number

#: Share of what stands above noise that an effect must explain; one alone explains 0.90 (`tests.blind.margins`).
SHARE = 0.25
#: The same for a pitch that repeats so many half cycles over a linear axis' travel that no smooth error copies it.
PITCH_SHARE, MANY = 0.1, 20.0

#: What acts on the load behind a coupling: effect, its shape, its strengths over load inertia.
Load = tuple["Effect", tuple[float, ...], tuple[float, ...]]


@dataclass(frozen=True)
class Proposal:
    """A shape of an effect that was tried beside a fit, and the squares it would take from the residual."""

    shape: tuple[float, ...]
    gain: float


@dataclass(frozen=True)
class Detected:
    """An effect read from signals that the torque balance does not hold.

    Attributes:
        values, errors, evidence: of its quantities, their half widths at 95 % - SI -, and figures that speak for it.
        mends: whether undoing it leaves no more in the faulty signal than noise does.
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
    """A torque balance fitted to a recording, as effects may ask it; see `bench.balance.fit.Fit`."""

    @property
    def theta(self) -> Array: ...  # noqa: D102
    @property
    def owners(self) -> NDArray[np.int64]: ...  # noqa: D102
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
    """Anything the catalogue lists.

    Attributes:
        name: as in the contract.
        summary: one line.
        quantities: its parameters, with unit and bounds.
        derived: what is reported beside them, and follows from them.
        shapes: the nonlinear quantities, in the order in which all methods take them.
        of_motion: whether its columns are accelerations, which a lag of the reported speed delays as J's.
        copies_torque: whether its columns are made of the measured torque, and so hold its noise.
        scales_friction: whether it multiplies the level of dry friction, what other effects add to it included.
        carries_friction: whether it carries all of dry friction, what other effects add and scale included.
        bounded: lowest and highest value of strengths that physics bounds, by their places: a fit holds them there.
        may_load: whether it may act on the load of a coupling rather than on the motor.
        couples: whether it joins motor and load; an axis has one such effect.
        turning_only: whether it has no meaning on a linear axis.
        of_speed_alone: whether its torque depends on speed alone.
        repeatable: whether an axis may have several of it, each of another shape (harmonics, events).
        occasional: whether it happens in one recording and not in another.
        bursts: whether what it leaves unexplained comes in bursts.
        biased_by_noise: whether noise of the motion biases its strength, and not only scatters it.
        not_beside: names of effects beside which it is not sought, as a recording tells but one of them.
        replaces: names of effects that it is tried in the place of, once nothing else explains more.
        faulty_signal: name of the signal that `corrected` mends; empty if it mends none.
        shows_under_drive: whether it shows where the drive runs the model, and hardly where the recording holds it.
        tolerates: share of the first gap that may be left beside it, if it is unlike that of other effects.
        fixed_in_simulation: quantities that a fit by simulation leaves alone: whole numbers, instants between samples.
        undiagnosed: why no recording names it, a sentence; empty if one does, which a test then carries out.
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
        """Values of some quantities at which the effect is exactly absent."""
        return {quantity.name: quantity.null for quantity in self.quantities if quantity.null is not None}

    def defaults(self, axis: Axis) -> Mapping[str, Number]:
        """Values of quantities that need not be given."""
        return {quantity.name: quantity.preset for quantity in self.quantities if quantity.preset is not None}

    def see(self, signals: Signals, shape: Sequence[float]) -> Signals:
        """The recording as it is without this fault of its sensors."""
        return signals

    def delays(self, shape: Sequence[float], source: str) -> tuple[float, float]:
        """Lags to undo on the columns of motion, and on all others, where speed comes from `source` - s."""
        return 0.0, 0.0

    def effort_lag(self, shape: Sequence[float]) -> float:
        """Lag to undo on the reported effort - s."""
        return 0.0

    def columns(self, signals: Signals, shape: Sequence[float]) -> list[Column]:
        """Resisting torque per unit of each strength - N*m (N) per unit, raw samples before the filter."""
        return []

    def columns_of(
        self, signals: Signals, shapes: Sequence[Sequence[float]], loads: Sequence[Load] = ()
    ) -> list[Column]:
        """Columns of several shapes, one shape after the other; `loads` act behind it if it couples."""
        return [column for shape in shapes for column in self.columns(signals, shape)]

    def level(self, signals: Signals, shape: Sequence[float], strengths: Sequence[float]) -> Array | float:
        """Dry friction beside Coulomb's, with its sign, that strengths make - the strengths' unit - (n,)."""
        return 0.0

    def stiffness(self, strengths: Sequence[float]) -> float:
        """Torque per position by which it pulls the load back - N*m/rad (N/m)."""
        return 0.0

    def load_inertia(self, strengths: Sequence[float]) -> float:
        """Inertia behind it, if it couples - kg*m**2 (kg)."""
        return 0.0

    def noise_of_motion(self, shape: Sequence[float], omega: Array) -> Array | NDArray[np.complex128]:
        """What white noise of the acceleration becomes in its first column, over angular frequency."""
        return np.zeros_like(omega)

    def open_torque(self, fitted: Fitted, index: int) -> Array | None:
        """Per row, how far its torque moves within what the recording does not tell - N*m (N) - (m,)."""
        return None

    # How it is suspected.

    def sought(self, scope: Scope) -> bool:
        """Whether such a recording can show it in the torque balance."""
        return scope.kind.turns or not self.turning_only

    def grid(self, scope: Scope) -> list[tuple[float, ...]]:
        """Shapes that a search tries first."""
        return list(product(*(places(shape, scope) for shape in self.shapes)))

    def propose(self, fitted: Fitted) -> list[Proposal]:
        """Shapes beside a fit, with what each would take from its residual; by default those of the grid."""
        return fitted.tried(self, self.grid(fitted.scope))

    def in_place_of(self, fitted: Fitted) -> tuple[float, ...] | None:
        """The likeliest shape beside a fit that lacks what this effect replaces."""
        return None

    def reach(self, shape: Sequence[float], k: int) -> float:
        """How far a search of the k-th quantity goes at first; see `Shape.reach`."""
        return self.shapes[k].reach

    def needed_share(self, shape: Sequence[float], scope: Scope) -> float:
        """Share of what stands above the noise floor that it must explain to be taken up."""
        pitches = [value for slot, value in zip(self.shapes, shape, strict=True) if is_pitch(slot, scope)]
        return PITCH_SHARE if any(value > MANY * scope.spacing for value in pitches) else SHARE

    def physical(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> bool:
        """Whether physics allows these values: every quantity within its bounds."""
        found = self.report(strengths, shape, base)
        return all(q.lower <= found[q.name] <= q.upper for q in self.quantities if q.name in found)

    def plausible(self, strengths: Sequence[Sequence[float]], shapes: Sequence[Sequence[float]], scope: Scope) -> bool:
        """Whether its terms, several if it is repeatable, are credible in such a recording."""
        return True

    def credible(self, shape: Sequence[float]) -> bool:
        """Whether a search may end with this shape, which it may pass on its way."""
        return True

    def wave_number(self, shape: Sequence[float]) -> float | None:
        """Of its torque over position, if it is a wave - 1 (rad/m)."""
        return None

    def simpler_forms(self) -> tuple[str, ...]:
        """Names of effects that it becomes where some of its strengths are nil."""
        return ()

    def report(self, strengths: Sequence[float], shape: Sequence[float], base: Base) -> Mapping[str, float]:
        """The effect's quantities from fitted strengths and shape - SI."""
        return {slot.quantity.name: value for slot, value in zip(self.shapes, shape, strict=True)}

    def shape_errors(self, shape: Sequence[float], scope: Scope, time: Array) -> Sequence[float]:
        """Standard deviations of its shape that no noise shows: of an instant between rows at times (m,) - s."""
        return [0.0] * len(self.shapes)

    def spread(self, fitted: Fitted, index: int) -> Array | None:
        """Covariance of its free shapes beyond what scores tell, where the likelihood's curvature tells too little."""
        return None

    def ambiguous(self, scope: Scope) -> tuple[str, ...]:
        """Names of effects that such a recording cannot tell from it."""
        return ()

    # Where the torque balance does not hold it.

    def detect(self, trace: Trace, rig: Rig, width: float) -> Detected | None:
        """The effect read from signals directly, through a filter of a width - s; None if they do not show it."""
        return None

    def corrected(self, trace: Trace, values: Mapping[str, float]) -> Trace:
        """The recording with its fault undone."""
        return trace

    def shown_in(self, trace: Trace, rig: Rig, values: Mapping[str, float]) -> Trace:
        """The part of a recording in which it shows, if it `shows_under_drive`."""
        return trace

    # What motion tells it from another explanation.

    def counterpart(self, name: str, values: Mapping[str, float]) -> Mapping[str, float] | None:
        """Values of an effect it is `ambiguous` with that looks the same in this motion; None if in every motion."""
        return None

    def instead_of_dry_friction(self, torque: float) -> Mapping[str, float] | None:
        """Values at which it looks as dry friction does in one direction, torque as signed there - N*m (N)."""
        return None

    @property
    def kind(self) -> str:
        """`physics`, or `measurement` of a sensor's fault."""
        return "physics"

    @classmethod
    def overrides(cls, hook: str) -> bool:
        """Whether the effect has a hook of its own rather than the neutral one of its kind."""
        neutral: Any = next((vars(base)[hook] for base in cls.__mro__[::-1] if hook in vars(base)), None)
        return getattr(cls, hook, None) is not neutral
