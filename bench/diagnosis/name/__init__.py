"""Name what is missing: forward selection over the catalogue, and doubt of what it found."""
