"""Friction over steady speeds: several recordings, each at one speed."""
