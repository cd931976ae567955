"""The last digit of a current that is reported in coarse steps: what rounding hides, and what cutting off takes away.

A current that is rounded errs by up to half a step, evenly; one whose fraction is cut off stands half a step nearer to
zero on average, which a balance of torque takes for friction or saturation. So half a step at most, in the direction
of the torque, is a nuisance of the recording wherever a step could be seen. What is left is noise, white where noise of
the sensor moves the signal over the steps; where it does not, the error follows the signal's slow way through them and
passes the filter: it is then read off the modelled torque, rounded in the same steps.

    e = q*round(M/q) - M, of which noise of a deviation s leaves exp(-2*(pi*s/q)**2)

q - step; M - modelled torque - N*m (N).
Source: B. Widrow, I. Kollar, Quantization Noise, 2008 (characteristic function of a dithered quantiser).
"""

from __future__ import annotations

import numpy as np

from bench.arrays import Array, rms
from bench.effects.signals import Signals
from bench.fit.hypothesis import Hypothesis
from bench.fit.rows import Rows
from bench.trace.filter import Column

#: Share of the filtered white noise below which half a step is not seen.
UNSEEN = 0.1


def plain(rows: Rows) -> Hypothesis:
    """The hypothesis without an effect: with the effort's last digit where half a step of it could be seen."""
    conditioning = rows.conditioning
    noise = conditioning.effort_noise * conditioning.filter.noise_gain(0)
    return Hypothesis(step=conditioning.effort_step if 0.5 * conditioning.effort_step > UNSEEN * noise else 0.0)


def cut_beforehand(step: float) -> tuple[float, float]:
    """What is known of what is cut off before it is measured, no more than a half of a step - N*m (N).

    Args:
        step: of the digit - N*m (N).

    Returns:
        The middle of that range, and the variance of a value that lies anywhere in it.
    """
    return 0.25 * step, (0.5 * step) ** 2 / 12.0


def cut_off(signals: Signals) -> list[Column]:
    """What a fraction that is cut off takes from the effort, per unit of half a step."""
    return [[(-np.sign(signals.effort), 0)]]


def rounding(rows: Rows, step: float, modelled: Array, cut: float) -> float:
    """RMS of what the last digit of an effort leaves in a residual, through the filter - N*m (N).

    Args:
        rows: the recording.
        step: of the digit - N*m (N); 0 where it does not matter.
        modelled: reported effort at the used rows - N*m (N) - (m,).
        cut: what was found to be cut off - N*m (N): from a quarter of a step on it was, below it was rounded.
    """
    if not step:
        return 0.0
    conditioning = rows.conditioning
    free = max(conditioning.effort_noise**2 - step**2 / 12.0, 0.0)
    followed = np.exp(-2.0 * np.pi**2 * free / step**2)
    whole = np.trunc if cut > 0.25 * step else np.round
    errors = []
    for part in rows.stretches:
        torque = np.interp(part.signals.time, rows.time, modelled + cut * np.sign(modelled))
        reported = step * whole(torque / step)
        (error,) = conditioning.filter(reported + cut * np.sign(reported) - torque, 0)
        errors.append(error[part.used])
    return float(followed) * rms(np.concatenate(errors))
