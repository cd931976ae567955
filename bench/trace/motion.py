"""Motion: angle, speed, acceleration and effort of a recording, all through one zero-phase filter.

The filter is chosen from the recording itself: source of speed, noise, cut-off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bench.arrays import Array, hann, rms, spectra
from bench.axis_kind import INERTIA
from bench.errors import InputError, UndeterminedError
from bench.trace.filter import LEAST_WIDTH, Column, GaussianFilter
from bench.trace.noise import TOP, common_step, resolution, rounding_spectrum, varying_noise, white_noise
from bench.trace.signals import KNOWN_INERTIA, KNOWN_MOMENTUM, KNOWN_TORQUE
from bench.trace.trace import Trace, less_known

#: Where effort and acceleration share half of their power, signal and noise are equal.
COHERENCE = 0.5
#: Speeds this many standard deviations of the noise from zero have a known sign.
SIGN_CONFIDENCE = 4.0
#: Share of the rows that a narrow filter would keep and the chosen one must keep too.
KEPT = 0.9
#: Widths from a reversal at which the filtered sign is within 1e-3 of one: 1 - erf(3.1/sqrt(2)) = 2e-3.
SIGN_REACH = 3.1
#: Number of samples sufficient for noise and spectrum; of longer recordings pieces spread over them are taken.
ENOUGH, PIECE = 2**17, 2**13
#: Share of the fastest stretch's RMS speed above which a stretch moves. At standstill, coarse signals hide
#: their noise and effort is unrelated to motion.
MOVES = 0.1
#: A filtered sign further than this from +-1 has seen speeds of the other sign, or of none.
ONE_SIGN = 1e-3
#: What to do where a recording lacks all signals of a kind.
MAP_ONE = (
    "identification needs one of them; `bench inspect` lists likely columns; map one in [trace.columns] of the rig"
)


@dataclass(frozen=True)
class Conditioning:
    """Filter and noise of a recording.

    Attributes:
        filter: the one filter of every column.
        source: signal that speed and acceleration come from, `velocity` or `position`.
        source_noise: white noise of that signal - its SI unit.
        effort_noise: white noise of torque or force - the effort's unit.
        effort_step: between the values it takes; 0 where hardly one occurs twice - the effort's unit.
        speed_noise: of the raw speed whose sign is taken (central difference of a position) - rad/s (m/s).
        coherence: highest coherence of effort and acceleration over frequency.
        known_noise: white noise of the momentum that is known in addition to that of the speed, which it has by the
            known inertia - N*m*s (N*s); 0 where none is.
        source_spectrum: angular frequencies (k,) - rad/s - and power of rounding there (k,) - the source's
            unit squared; None where it is white.
    """

    filter: GaussianFilter
    source: str
    source_noise: float
    effort_noise: float
    effort_step: float
    speed_noise: float
    coherence: float
    known_noise: float = 0.0
    source_spectrum: tuple[Array, Array] | None = field(default=None, compare=False)

    def source_power(self, omega: Array) -> Array:
        """Power of the source's noise around angular frequencies (k,), increasing - its SI unit squared."""
        if self.source_spectrum is None:
            return np.full(omega.size, self.source_noise**2)
        known, power = self.source_spectrum
        step = known[1] - known[0]
        below = np.concatenate([[0.0], np.cumsum(power)]) * step
        edges = np.concatenate([omega[:1] - 0.5 * step, 0.5 * (omega[1:] + omega[:-1]), omega[-1:] + 0.5 * step])
        held = np.interp(edges, np.append(known, known[-1] + step) - 0.5 * step, below)
        return np.diff(held) / np.maximum(np.diff(np.clip(edges, -0.5 * step, known[-1] + 0.5 * step)), 1e-300)

    @property
    def order(self) -> int:
        """Derivative of the source that is speed: 0 for velocity, 1 for position."""
        return 1 if self.source == "position" else 0

    @property
    def sign_threshold(self) -> float:
        """Speed below which noise may have made the sign - rad/s (m/s)."""
        return SIGN_CONFIDENCE * self.speed_noise


def condition(trace: Trace, effort: Array, cutoff: float | None = None) -> Conditioning:
    """Choose source, filter and thresholds for a recording.

    All are read from the stretches that move. The cut-off is the frequency up to which effort and acceleration are
    coherent above one half; beyond it they no longer agree, because of noise or for dynamics that a rigid
    axis does not have. It is raised where the filter's reach around reversals would cost more than a tenth of the rows.
    Of velocity and position, the one whose noise makes less of the acceleration is taken.

    Args:
        trace: the recording.
        effort: torque or force over it - (n,).
        cutoff: half-power frequency to take instead of the chosen one - Hz.

    Raises:
        InputError: neither velocity nor position.
        UndeterminedError: the recording is too short.
    """
    least = GaussianFilter(LEAST_WIDTH * trace.sample_period, trace.sample_period)
    longest = max(part.stop - part.start for part in trace.segments)
    if longest < 8 * least.margin:
        raise UndeterminedError(
            trace.axis_kind.in_words(INERTIA),
            f"the longest stretch without a hole has {longest} samples",
            f"at least {8 * least.margin} samples without a hole",
        )
    recorded = [name for name in ("velocity", "position") if name in trace]
    if not recorded:
        raise InputError(trace.origin, "contains neither velocity nor position", MAP_ONE)
    parts = moving(trace, recorded[0], 2 * least.margin)
    noise = {name: white_noise(*(trace[name][part] for part in parts)) for name in recorded}
    rank = {name: noise[name] * least.noise_gain(2 if name == "position" else 1) for name in noise}
    source = min(rank, key=lambda name: rank[name])
    explained = less_known(trace, effort)
    pairs = [(trace[source][part], explained[part]) for part in parts]
    frequency, coherence = _coherence(pairs, trace.sample_period, 2 - (source != "position"))
    peak = int(np.argmax(coherence))
    speed_noise = noise[source] / (np.sqrt(2.0) * trace.sample_period) if source == "position" else noise[source]
    if cutoff is None:
        below = np.flatnonzero(np.append(coherence[peak:], 0.0) < COHERENCE)[0]
        coherent = float(frequency[min(peak + below, frequency.size - 1)])
        speeds = (raw_speed(values, source, trace.sample_period) for values, _ in pairs)
        signs = [known_sign(speed, SIGN_CONFIDENCE * speed_noise) for speed in speeds]
        cutoff = max(coherent, _least_cutoff(signs, trace.sample_period))
    chosen = GaussianFilter.from_cutoff(cutoff, trace.sample_period)
    efforts = [effort[part] for part in parts]
    loud, step = white_noise(*efforts), resolution(np.concatenate(efforts))
    known = _noise_of_known(trace, parts, source) if KNOWN_MOMENTUM in trace else 0.0
    spectrum = _rounded([trace[source][part] for part in parts], chosen, noise[source])
    highest = float(coherence[peak])
    return Conditioning(chosen, source, noise[source], loud, step, speed_noise, highest, known, spectrum)


def _noise_of_known(trace: Trace, parts: Sequence[slice], source: str) -> float:
    """White noise of the known momentum less the mean inertia by which it has the noise of the speed.

    It is the noise of the other joints, as large as poses make it.
    """
    inertia = float(np.mean(np.concatenate([trace[KNOWN_INERTIA][part] for part in parts])))
    speeds = (raw_speed(trace[source][part], source, trace.sample_period) for part in parts)
    momentum = (trace[KNOWN_MOMENTUM][part] for part in parts)
    return varying_noise(*(p - inertia * speed for p, speed in zip(momentum, speeds, strict=True)))


def _rounded(stretches: Sequence[Array], smooth: GaussianFilter, noise: float) -> tuple[Array, Array] | None:
    """Spectrum of a source that is reported in steps; None where they are lost in its noise, which makes them white."""
    step = common_step(np.concatenate(stretches), noise)
    if not step:
        return None
    omega, power = rounding_spectrum(stretches, smooth, step)
    if not power.any():
        return None
    other = max(noise**2 - float(np.mean(power[omega > (1.0 - TOP) * omega[-1]])), 0.0)
    followed = np.exp(-((2.0 * np.pi / step) ** 2) * other)  # the characteristic function of a normal dither
    return omega, followed * (power + other) + (1.0 - followed) * noise**2


def moving(trace: Trace, source: str, least: int) -> list[slice]:
    """Stretches of at least `least` samples in which the axis moves, ENOUGH samples of them at most, in order.

    Noise and spectrum are read where they matter: the longest stretch of a recording in many may be one at rest.
    """
    parts = [part for part in trace.segments if part.stop - part.start >= least]
    if sum(part.stop - part.start for part in parts) > ENOUGH:
        parts = [
            slice(start, min(start + PIECE, part.stop))
            for part in parts
            for start in range(part.start, part.stop - least + 1, PIECE)
        ]
    speeds = np.array([rms(raw_speed(trace[source][part], source, trace.sample_period)) for part in parts])
    fast = [part for part, speed in zip(parts, speeds, strict=True) if speed >= MOVES * speeds.max()]
    few = max(1, ENOUGH // PIECE) if sum(part.stop - part.start for part in fast) > ENOUGH else len(fast)
    return [fast[k] for k in np.linspace(0, len(fast) - 1, min(few, len(fast))).astype(int)]


def raw_speed(values: Array, source: str, sample_period: float) -> Array:
    """Unfiltered speed (n,) of a source (n,): itself, or the central difference of a position - rad/s (m/s)."""
    return np.gradient(values, sample_period) if source == "position" else values


def slope(values: Array, sample_period: float) -> Array:
    """Derivative of regular samples (n, ...) along the first axis, by differences of fourth order but for the ends.

    The error of a central difference, a share of (omega*T)**2/6, delays a joint's balance on moving links by 40 us at
    2 Hz and 400 Hz of sampling; that of this one, (omega*T)**4/30, by none.
    """
    found = np.gradient(values, sample_period, axis=0)
    if len(values) > 4:
        found[2:-2] = (8.0 * (values[3:-1] - values[1:-3]) - (values[4:] - values[:-4])) / (12.0 * sample_period)
    return found


def known_sign(speed: Array, threshold: float) -> Array:
    """Sign of a speed (n,), 0 where it is within `threshold` of zero - rad/s (m/s)."""
    return np.sign(speed) * (np.abs(speed) > threshold)


def _least_cutoff(signs: Sequence[Array], sample_period: float) -> float:
    """Lowest cut-off that still keeps KEPT of the rows, by the signs of the speed in each stretch - Hz.

    A filter of width s loses 3.1*s at both ends of each run of one sign, where its reach spans a reversal.
    """
    found = []
    for sign in signs:
        edges = np.r_[0, np.flatnonzero(np.diff(sign) != 0.0) + 1, sign.size]
        found.append(np.diff(edges)[sign[edges[:-1]] != 0.0])
    runs = np.sort(np.concatenate(found)) * sample_period
    widths = LEAST_WIDTH * sample_period * 1.1 ** np.arange(80)
    lost = 2.0 * SIGN_REACH * widths
    longer = np.searchsorted(runs, lost)
    kept = np.append(np.cumsum(runs[::-1])[::-1], 0.0)[longer] - lost * (runs.size - longer)
    widest = float(widths[np.flatnonzero(kept >= KEPT * kept[0])[-1]])
    return GaussianFilter(widest, sample_period).cutoff


def _coherence(pairs: Sequence[tuple[Array, Array]], sample_period: float, order: int) -> tuple[Array, Array]:
    """Magnitude-squared coherence of effort and the source's derivative over frequency - Hz, Welch's estimate.

    At least sixteen half-overlapping windows, as the estimate's bias is about one over their number; none spans a hole,
    so no longer than the stretches that hold most of the samples. As `scipy.signal.coherence` has it (Hann windows,
    each less its mean); importing that costs 0.3 s. Pairs are source and effort of a stretch, the order is that of the
    source's derivative that is acceleration.
    """
    sizes = np.sort([effort.size - order for _, effort in pairs])[::-1]
    usual = int(sizes[np.searchsorted(np.cumsum(sizes), 0.5 * sizes.sum())])
    length = int(np.clip(2 ** int(np.log2(min((sizes.sum() + order) / 8, usual))), 16, 1024))
    long = [(np.diff(source, order), effort[order:]) for source, effort in pairs if effort.size - order >= length]
    one, other = (np.concatenate([spectra(pair[k], hann(length)) for pair in long]) for k in (0, 1))
    shared = np.abs(np.sum(one.conj() * other, axis=0)) ** 2
    power = np.sum(np.abs(one) ** 2, axis=0) * np.sum(np.abs(other) ** 2, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):  # a signal that never changes has no power to share
        coherence = np.nan_to_num(shared / power)
    return np.arange(1, length // 2) / (length * sample_period), coherence[1:-1]


@dataclass(frozen=True)
class Motion:
    """Filtered columns of one recording, rows without a hole in reach of the filter; all arrays (m,).

    Attributes:
        time: s.
        velocity: omega - rad/s (m/s).
        acceleration: alpha - rad/s**2 (m/s**2).
        effort: motor torque M - N*m (force - N, or what the rig allows).
        effort_rate: dM/dt of what the recorded signal gives - effort's unit per s.
        direction: filtered sgn(omega), within ONE_SIGN of +-1; 0 where the filter's reach contains both signs or none.
        conditioning: how it was filtered.
    """

    time: Array
    velocity: Array
    acceleration: Array
    effort: Array
    effort_rate: Array
    direction: Array
    conditioning: Conditioning

    def __len__(self) -> int:
        return self.time.size


def motion(trace: Trace, effort: Array, driven: Array, conditioning: Conditioning) -> Motion:
    """Filter a recording; stretches shorter than the filter's two margins are left out.

    `driven`: what of the effort the recorded signal gives, the motion aside, whose rate it is (n,).
    """
    smooth, order = conditioning.filter, conditioning.order
    parts = []
    for part in trace.segments:
        source, torque = trace[conditioning.source][part], effort[part]
        if source.size > 2 * smooth.margin:
            speed = raw_speed(source, conditioning.source, trace.sample_period)
            sign = known_sign(speed, conditioning.sign_threshold)
            made = ((source, order), (source, order + 1), (torque, 0), (driven[part], 1), (sign, 0))
            rows = smooth.columns([[term] for term in made])
            rows[-1][np.abs(rows[-1]) < 1.0 - ONE_SIGN] = 0.0
            parts.append((trace.time[part][smooth.margin : source.size - smooth.margin : smooth.stride], *rows))
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)] if parts else [np.empty(0)] * 6
    return Motion(*columns, conditioning=conditioning)


def known_column(trace: Trace, part: slice) -> Column:
    """Known torque along a stretch as a column of the torque balance; () if there is none."""
    if KNOWN_TORQUE not in trace:
        return ()
    return (trace[KNOWN_TORQUE][part], 0), (trace[KNOWN_MOMENTUM][part], 1)


def known_along(trace: Trace, part: slice, signal: str) -> Array | float:
    """KNOWN_INERTIA or KNOWN_SLOPE along a stretch - SI - (n,); 0 if there is none."""
    return trace[signal][part] if signal in trace else 0.0


def stretches_of(trace: Trace) -> tuple[slice, ...]:
    """Stretches without holes that a model can be held to; a lone sample shows no motion."""
    return tuple(part for part in trace.segments if part.stop - part.start > 1)


def windows_of(trace: Trace, length: float) -> list[slice]:
    """Windows of a length - s -, one after the other; the last one of each stretch without holes may be shorter."""
    samples = max(round(length / trace.sample_period), 2)
    return [
        slice(start, min(start + samples, part.stop))
        for part in stretches_of(trace)
        for start in range(part.start, part.stop - 1, samples)
    ]


def in_stretches(trace: Trace) -> NDArray[np.bool_]:
    """Samples at which a model coupled to a recording predicts something, (n,): those of `stretches_of`."""
    found = np.zeros(len(trace), dtype=np.bool_)
    for part in stretches_of(trace):
        found[part] = True
    return found


def measured_velocity(trace: Trace) -> Array:
    """Reported velocity, or the central difference of a reported position - rad/s (m/s) - (n,).

    A lone sample between holes has none of its own; it takes the mean speed between its neighbours.
    """
    if "velocity" in trace:
        return trace["velocity"]
    position, velocity = trace["position"], np.empty(len(trace))
    for part in trace.segments:
        if part.stop - part.start > 1:
            velocity[part] = np.gradient(position[part], trace.sample_period)
        else:
            around = [max(part.start - 1, 0), min(part.stop, len(trace) - 1)]
            velocity[part] = np.diff(position[around]) / np.diff(trace.time[around])
    return velocity


def measured_position(trace: Trace) -> Array:
    """Reported position, or the integral of a reported velocity from zero in each stretch - rad (m) - (n,)."""
    if "position" in trace:
        return trace["position"]
    position = np.full(len(trace), np.nan)
    for part in stretches_of(trace):
        position[part] = integrated(trace["velocity"][part], trace.sample_period)
    return position


def integrated(velocity: Array, sample_period: float) -> Array:
    """Position from zero, by the trapezoidal rule - rad (m) - (n,)."""
    return np.concatenate([[0.0], np.cumsum((velocity[1:] + velocity[:-1]) / 2.0) * sample_period])
