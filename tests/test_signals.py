"""Ctrl-C, SIGTERM and SIGHUP end a run alike: one line, its status, and no half of a file."""

import os
import signal
import subprocess
import sys
import time

import pytest

from tests.hostile import ROOT

#: A signal that comes while the command line is imported, and one that comes while an output is written.
IMPORTING = """
import os, signal, sys
class Stop:
    def find_spec(self, name, *_):
        if name == "bench.cli.lab":
            os.kill(os.getpid(), {number})
sys.meta_path.insert(0, Stop())
sys.argv = ["bench", "effects"]
from bench.__main__ import main
main()
"""
WRITING = """
import os, signal, sys, time
import bench.files
def flush(handle):
    print("writing", flush=True)
    time.sleep(60)
os.fsync = flush
sys.argv = ["bench", "lab", "--notebooks", "out"]
from bench.__main__ import main
main()
"""
STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}


#: Signals as a terminal gives them: a shell's background job, as CI may be one, ignores some.
AS_A_TERMINAL = """
import os, signal, sys
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
    signal.signal(number, signal.SIG_DFL)
os.execv(sys.executable, [sys.executable, "-c", sys.argv[1]])
"""


def start(code, folder):
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", AS_A_TERMINAL, code]
    return subprocess.Popen(command, cwd=folder, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


#: What compiled libraries do that are being imported.
SWALLOWING = IMPORTING.replace("            os.kill", "            try: os.kill").replace(
    "{number})\n", "{number})\n            except BaseException: raise RuntimeError('swallowed') from None\n", 1
)


@pytest.mark.parametrize(
    ("code", "number"), [*((IMPORTING, number) for number in STATUS), (SWALLOWING, signal.SIGINT)], ids=range(4)
)
def test_while_importing(tmp_path, number, code):
    process = start(code.format(number=int(number)), tmp_path)
    _, err = process.communicate(timeout=120)
    assert (process.returncode, err) == (STATUS[number], "bench: interrupted\n")


@pytest.mark.parametrize("number", STATUS, ids=lambda number: number.name)
def test_while_writing(tmp_path, number):
    process = start(WRITING, tmp_path)
    assert process.stdout.readline() == "writing\n"
    time.sleep(0.1)
    process.send_signal(number)
    _, err = process.communicate(timeout=120)
    assert (process.returncode, err) == (STATUS[number], "bench: interrupted\n")
    assert list((tmp_path / "out").iterdir()) == []


def test_whoever_reads_may_stop_reading(tmp_path):
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    line = f"{sys.executable} -m bench effects | true"
    done = subprocess.run(line, shell=True, cwd=tmp_path, env=env, capture_output=True, text=True, check=False)
    assert done.stderr == ""
