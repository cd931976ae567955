"""A model to be looked at: the simulated axis and, as a ghost, the one it is held against."""
