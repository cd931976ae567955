"""The gap: what inertia, viscous and Coulomb friction leave of the torque, beside the hum of the mains."""

from __future__ import annotations

from bench.fit.fit import Fit, fit
from bench.fit.hum import with_hum
from bench.fit.last_digit import plain
from bench.fit.rows import Rows


def gap(rows: Rows) -> Fit:
    """The fit of the empty hypothesis."""
    return with_hum(fit(rows, plain(rows)))
