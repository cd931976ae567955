"""Recordings as drives and loggers export them, beside the project: inspected, identified, and held to their truth."""
