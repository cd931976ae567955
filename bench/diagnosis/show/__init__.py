"""Show the gap shrink, and what to record next."""
