"""Export of a model: into another MJCF, another simulation, or the drive."""
