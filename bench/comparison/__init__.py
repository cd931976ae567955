"""Do two states of an axis differ: by their uncertainties, by what recordings differ by anyway, and by when."""
