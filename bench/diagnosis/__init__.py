"""Diagnosis: where model and recording disagree, which effect is missing, and proof that it closes the gap."""
