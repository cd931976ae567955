"""Many pieces of work, each with its own deadline, in one worker process or on Dask."""
