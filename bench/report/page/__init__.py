"""Pages: building blocks of a report, and the one file that shows them without any other."""
