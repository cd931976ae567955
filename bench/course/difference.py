"""Task 2: backward difference u'[k] = (u[k] - u[k-1])/T of sin(t), t = 0 : 0.001 : 2*pi; beside it the bench's own."""

from __future__ import annotations

import numpy as np

from bench.course.recordings import LabRecordings
from bench.course.result import COMPUTED, Number, TaskResult, chart, curve, panel
from bench.fit.lab import backward_difference
from bench.trace.filter import GaussianFilter

SAMPLE_PERIOD = 1e-3
#: One period, as the course has it: t = 0 : 0.001 : 2*pi.
DURATION = 2.0 * np.pi
#: Width of the bench's filter, as it chooses it for the lab's recordings - s.
WIDTH = 2.0 * SAMPLE_PERIOD


def backward_difference_of_a_sine(recordings: LabRecordings) -> TaskResult:
    """Differentiate sin(t) both ways and compare with cos(t).

    The backward difference belongs half a sample earlier, so it errs by T/2*|u''|: 5e-4 here. The bench's filter is
    even in time and scales a sine by exp(-(omega*width)**2/2): 2e-6 here; it cannot serve the ends, six widths long.
    """
    time = np.arange(0.0, DURATION, SAMPLE_PERIOD)
    backward = backward_difference(np.sin(time), SAMPLE_PERIOD)
    smooth = GaussianFilter(WIDTH, SAMPLE_PERIOD)
    kept = slice(smooth.margin, time.size - smooth.margin)
    error = (backward - np.cos(time))[1:]
    error_of_bench = smooth(np.sin(time), 1)[0] - np.cos(time[kept])
    worst, worst_of_bench = float(np.max(np.abs(error))), float(np.max(np.abs(error_of_bench)))
    findings = (
        f"On sin(t), t = 0 : {SAMPLE_PERIOD:g} : 2π ({time.size} samples), the backward difference is at "
        f"most {worst:.2g} away from cos(t), half a sample of delay; the bench's own derivative "
        f"{worst_of_bench:.2g}. Its first value is 0 by definition."
    )
    numbers = (
        Number("largest error of the backward difference", worst, "1/s", SAMPLE_PERIOD / 2.0, COMPUTED),
        Number("largest error of the bench's derivative", worst_of_bench, "1/s", WIDTH**2 / 2.0, COMPUTED),
    )
    both = curve(time, np.cos(time), "cos(t)", "wide"), curve(time, backward, "backward difference")
    drawn = chart(
        "Derivative of sin(t) against cos(t)",
        panel("time / s", "derivative / (1/s)", *both),
        panel("time / s", "error, backward / (1/s)", curve(time[1:], error)),
        panel("time / s", "error, bench / (1/s)", curve(time[kept], error_of_bench)),
    )
    return TaskResult((findings,), numbers, (drawn,))
