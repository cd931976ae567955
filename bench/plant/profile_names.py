"""Names of the motion profiles, separate from the profiles so that the command line lists them without loading
numpy."""

DEFAULT = "identification"
NAMES = ("identification", "fast_reversals", "full_torque", "speed_staircase", "slow_reversals", "multisine", "chirp")
