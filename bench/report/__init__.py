"""Reports: figures, tables and JSON."""
