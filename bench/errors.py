"""The one exception tree of the bench; the command line turns it into one line and an exit status."""

from bench.names import readable


class BenchError(Exception):
    """Anything the bench refuses. `exit_status` is what the command line returns for it."""

    exit_status = 2


class InputError(BenchError):
    """Bad input or bad arguments: names the place, what was found there and what is allowed.

    Args:
        where: file, and line, column or key within it.
        found: what is there.
        allowed: what may stand there, or what to do.
    """

    def __init__(self, where: object, found: str, allowed: str) -> None:
        self.where, self.found, self.allowed = map(readable, (where, found, allowed))
        super().__init__(f"{self.where}: {self.found}; {self.allowed}")


class UndeterminedError(BenchError):
    """A sound recording does not determine a quantity: names it, why, and what to record instead.

    Args:
        quantity: the physical quantity that stays undetermined.
        reason: what the recording lacks.
        record: the recording that would determine it.
    """

    exit_status = 1

    def __init__(self, quantity: str, reason: str, record: str) -> None:
        self.quantity, self.reason, self.record = quantity, reason, record
        super().__init__(f"{quantity} cannot be determined: {reason}; record instead: {record}")


class SimulationError(BenchError):
    """A simulation diverged, or its model cannot do what is requested; never interpreted as "does not fit"."""

    exit_status = 1


class Stopped(BaseException):
    """A signal to stop; no KeyboardInterrupt, which the command line's library turns into an exit without a word."""
