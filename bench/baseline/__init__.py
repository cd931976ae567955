"""Whether an axis, or the model of one, has changed since a baseline."""
