"""Three effects: a torque, a fault of a sensor, a coupling."""
