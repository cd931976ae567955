"""Export of a model, one file a target.

Into another MJCF: `mjcf`; a simulation of one's own: `effects`; a drive: `feedforward`, in its units `drive_units`;
domain randomisation: `ranges`. The motion to record next: `plan`.
"""
