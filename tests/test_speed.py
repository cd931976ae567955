"""How fast: printed and never asserted. `pytest tests/test_speed.py -m '' --benchmark-only -s` shows all of it."""

import resource
import statistics
import subprocess
import sys
import time

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.fit.identify import identify
from bench.rig.rig import load_rig
from bench.trace.read import read
from bench.trace.write import write
from tests.fit.motions import RIG, recording

SAMPLES = 10_000_000

STREAMED = """
import re, sys, time
from pathlib import Path
from bench.fit.identify import identify
from bench.trace.stream import stream
from tests.fit.motions import RIG
began = time.perf_counter()
found = identify(stream(sys.argv[1]), RIG)
seconds = time.perf_counter() - began
peak = re.search(r"VmHWM:\\s+(\\d+)", Path("/proc/self/status").read_text())
print(seconds, int(peak.group(1)) / 1024, found["moment_of_inertia"].value)
"""

READ = """
import sys, time
import pyarrow.parquet as pq
began = time.perf_counter()
pq.read_table(sys.argv[1])
print(time.perf_counter() - began)
"""


@pytest.mark.slow
def test_identify_two_seconds_at_a_kilohertz_in_memory(benchmark):
    trace = recording(np.random.default_rng(0), duration=2.0)
    assert benchmark(identify, trace, RIG).samples_read == 2000


@pytest.fixture(scope="module")
def long_recording(tmp_path_factory):
    path = tmp_path_factory.mktemp("long") / "long.parquet"
    trace = recording(np.random.default_rng(1), duration=SAMPLES * 1e-3)
    columns = {"time [s]": trace.time, "velocity [rad/s]": trace["velocity"], "current [A]": trace["current"]}
    pq.write_table(pa.table(columns), path)
    return path


@pytest.mark.slow
def test_ten_million_samples_are_streamed_in_bounded_memory(long_recording):
    def run(script):
        command = [sys.executable, "-c", script, str(long_recording)]
        return [
            float(word) for word in subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
        ]

    run(READ)  # so that both find the file in the page cache
    ratios = []
    for _ in range(3):
        (reading,) = run(READ)
        seconds, megabytes, inertia = run(STREAMED)
        ratios.append(seconds / reading)
        print(
            f"\nread {reading:.2f} s, identified {seconds:.2f} s ({ratios[-1]:.2f} times), {megabytes:.0f} MB", end=""
        )
    assert inertia == pytest.approx(1.5e-3, rel=1e-3)
    assert megabytes < 1024


def cpu_of_command(*arguments):
    """User and system seconds of `bench` in a process of its own, the median of nine."""

    def run():
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-m", "bench", *map(str, arguments)], check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    return statistics.median(run() for _ in range(9))


@pytest.mark.slow
def test_what_a_command_costs_beside_its_work_in_process(benchmark, tmp_path):
    rig, trace = tmp_path / "rig.toml", tmp_path / "run.csv.gz"
    rig.write_text('name = "axis"\nkind = "rotary"\n[motor]\ntorque_constant = "0.8 N*m/A"\n', encoding="utf-8")
    write(recording(np.random.default_rng(0), duration=4.0), trace)

    def work():
        began = time.process_time()
        estimate = identify(read(trace), load_rig(rig))
        return time.process_time() - began, estimate

    seconds, estimate = benchmark(work)
    version, command = cpu_of_command("--version"), cpu_of_command("identify", trace, "--rig", rig)
    print(f"\nCPU: --version {version:.3f} s; identify {command:.3f} s, its work in process {seconds:.3f} s", end="")
    assert estimate.samples_read == 4000
