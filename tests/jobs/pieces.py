"""Pieces of work that go wrong as real ones do: they raise, hang in compiled code, crash, fill memory."""

import ctypes
import os
import re
import signal
import sys
import time

CPU = "of whoever did it"


def work(item):
    kind, number = item
    return ACTS[kind](number)


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


def leave(number):
    sys.exit(number)


def fill(number):
    held = bytearray(number * 2**20)
    held[::4096] = bytes(len(held[::4096]))
    time.sleep(60.0)


def unpicklable(number):
    return lambda: number


def wait(number):
    time.sleep(0.01 * number)
    return number


def process(number):
    return os.getpid()


ACTS = {
    act.__name__: act for act in (square, refuse, hang, sleep, crash, killed, leave, fill, unpicklable, wait, process)
}
