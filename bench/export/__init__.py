"""A model taken along: into somebody else's MJCF, into his simulation, and into the drive."""
