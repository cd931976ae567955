"""Export of a model, one file a target.

Into another MJCF, with ranges for domain randomisation: `mjcf`; other simulators: `simulators`; a simulation of one's
own: `effects`; a drive, in its units: `feedforward`. The motion to record next: `plan`.
"""
