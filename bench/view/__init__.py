"""View of a model in motion: the simulated axis, with the measured one as a ghost."""
