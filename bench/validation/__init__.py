"""Monte Carlo on synthetic data: how often what the bench says of an axis holds."""
