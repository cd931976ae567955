"""Lab: the tasks of the course "Industrial Drives, Part 2", one module a task, on any recordings of the axis."""
