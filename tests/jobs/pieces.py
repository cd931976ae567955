"""Pieces of work that go wrong as real ones do: they raise, hang in compiled code, crash, fill memory."""

import ctypes
import os
import re
import signal
import sys
import time


def work(item):
    """One of these with its number."""
    piece, number = item
    return piece(number)


def square(number):
    return number**2


def refuse(number):
    raise ValueError(f"{number} is not for me")


def hang(number):
    """In compiled code that holds the interpreter: no signal handler and no other thread runs."""
    return re.match("(a|aa)+$", "a" * 200 + "b")


def sleep(number):
    time.sleep(3600.0)


def crash(number):
    ctypes.string_at(0)


def killed(number):
    os.kill(os.getpid(), signal.SIGKILL)


def parricide(number):
    """Ends the worker that it works beside, as a machine that is switched off does."""
    os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(1.0)


def leave(number):
    sys.exit(number)


def fill(number):
    held = b"1" * (number * 2**20)
    time.sleep(60.0)
    return len(held)


def unpicklable(number):
    return lambda: number


def process(number):
    return os.getpid()


def slowly(number):
    time.sleep(number)
    return os.getpid()
