"""Command line, and `python -m bench`."""

import os
import sys

# Many small least-squares problems: BLAS threads only wait for one another (a diagnosis took 9.7 s with one thread, 14
# to 26 s with two on two cores). Read when numpy is first imported, so it stands before everything else.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from bench import __version__


def main() -> None:
    """Entry point of `bench`."""
    if sys.argv[1:] == ["--version"]:
        print(__version__)  # 0.03 s of CPU; 0.2 s with the command line's library
        return
    from bench.cli import main as run

    run()


if __name__ == "__main__":
    main()
