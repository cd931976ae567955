"""Readers of recordings, a file for each format or family of formats."""
