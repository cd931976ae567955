"""`python in_bam.py PARAMETERS.json STATES.json`: BAM's dry friction and damping at both torques, and speed."""

import json
import sys
from pathlib import Path

from bam.model import load_model

parameters, states = sys.argv[1:]
model = load_model(parameters)
print(
    json.dumps(
        [[float(value) for value in model.compute_frictions(*state)] for state in json.loads(Path(states).read_text())]
    )
)
