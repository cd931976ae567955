"""The gap: what inertia, viscous and Coulomb friction leave of the torque, beside the hum of the mains."""

from __future__ import annotations

from bench.balance.fit import Fit, fit
from bench.balance.hum import with_hum
from bench.balance.last_digit import plain
from bench.balance.rows import Rows


def gap(rows: Rows) -> Fit:
    """The fit of the empty hypothesis."""
    return with_hum(fit(rows, plain(rows)))
