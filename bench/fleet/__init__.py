"""Many recordings of many axes: one row for each, and which axes changed."""
