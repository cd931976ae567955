"""A figure of statistics that is used all over the bench."""

from __future__ import annotations

from statistics import NormalDist

#: Half width of a normal distribution's 95 % interval in standard deviations.
NORMAL95 = NormalDist().inv_cdf(0.975)
