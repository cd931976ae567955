"""Many pieces of work, each with its own deadline, in one process beside this one or on Dask."""
