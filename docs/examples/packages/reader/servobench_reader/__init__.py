"""A reader of a drive's memory."""
