"""Plant: the MuJoCo model of the axis with its drive, and the motions it runs."""
