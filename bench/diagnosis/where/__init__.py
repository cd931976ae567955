"""Where the gap sits, before any effect is assumed."""
