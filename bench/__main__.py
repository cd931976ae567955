"""Command line, and `python -m bench`."""

import os

# Many small least-squares problems: BLAS threads only wait for one another (a diagnosis took 9.7 s with one thread, 14
# to 26 s with two on two cores). Read when numpy is first imported, so it stands before everything else.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from bench.cli import main

if __name__ == "__main__":
    main()
