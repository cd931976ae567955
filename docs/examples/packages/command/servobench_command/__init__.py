"""A command with its document."""
