"""Monte Carlo on synthetic data: how often results for an axis are right."""
