"""Export of a model, one file a target.

Into another MJCF: `mjcf`; a simulation of one's own: `effects`; a drive, in its units: `feedforward`;
domain randomisation: `ranges`. The motion to record next: `plan`.
"""
