"""Whatever one item does, it gets its row and the others theirs: beside this process and on Dask alike."""

import os
import socket

import pytest

from bench.errors import InputError
from bench.jobs.each import each
from bench.jobs.on_dask import on_dask
from bench.jobs.process import Failure, Limits, WorkerProcess
from tests.jobs.pieces import refuse, work

LIMITS = Limits(deadline=5.0, memory=300 * 2**20)
ITEMS = [
    ("square", 3),
    ("refuse", 7),
    ("hang", 0),
    ("crash", 0),
    ("killed", 0),
    ("fill", 400),
    ("leave", 3),
    ("unpicklable", 1),
    ("square", 5),
]
OUTCOMES = {
    0: 9,
    1: Failure("failed", f"ValueError: 7 is not for me (at pieces.py:{refuse.__code__.co_firstlineno + 1})"),
    2: Failure("timed_out", "no result within 5 s"),
    3: Failure("failed", "its worker was killed (SIGSEGV)"),
    4: Failure("failed", "its worker was killed (SIGKILL)"),
    5: Failure("failed", "its worker was killed (it took more than 300 MB)"),
    6: Failure("failed", "its worker was killed (exit status 3)"),
    8: 25,
}


def compared(outcomes):
    found = dict(outcomes)
    unpicklable = found.pop(7)
    assert unpicklable.status == "failed"
    assert "pickle" in unpicklable.reason
    return found


def test_every_item_has_its_outcome_beside_this_process():
    assert compared(each(work, ITEMS, LIMITS, workers=1)) == OUTCOMES


def test_the_same_on_dask(cluster):
    assert compared(each(work, ITEMS, LIMITS, scheduler=cluster.scheduler_address)) == OUTCOMES


@pytest.mark.slow
def test_a_worker_that_is_lost_is_dasks_matter_and_ends_no_run(cluster):
    items = [("parricide", 0), *[("square", number) for number in range(20)]]
    found = dict(each(work, items, LIMITS, scheduler=cluster.scheduler_address))
    assert found.pop(0) == Failure("failed", "its worker was killed (Dask tried it as often as it is allowed to)")
    assert found == {1 + number: number**2 for number in range(20)}


def test_short_jobs_have_one_process():
    short = dict(each(work, [("process", 0)] * 5, LIMITS, workers=2, starts=60.0))
    assert len(set(short.values())) == 1


def test_long_jobs_have_several_processes():
    long = dict(each(work, [("slowly", 2.0)] * 4, LIMITS, workers=2, starts=0.05))
    assert len(set(long.values())) == 2


def test_processes_are_ended_with_the_run():
    found = dict(each(work, [("process", 0)] * 40, LIMITS, workers=2, starts=1e-9))
    assert sorted(found) == list(range(40))
    ended(found.values())


def test_a_run_that_is_left_ends_what_is_still_done():
    running = each(work, [("process", 0), *[("hang", 0)] * 3], Limits(deadline=600.0), workers=1)
    place, process = next(running)
    running.close()
    assert place == 0
    ended([process])


def ended(processes):
    for process in processes:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


def test_one_process_does_all_items_that_go_well():
    with WorkerProcess(work, LIMITS) as beside:
        processes = {beside.do(("process", 0)) for _ in range(3)}
        beside.do(("killed", 0))
        after = beside.do(("process", 0))
    assert len(processes) == 1
    assert after not in {*processes, os.getpid()}


def test_what_is_stopped_is_gone():
    with WorkerProcess(work, Limits(deadline=1.5)) as beside:
        process = beside.do(("process", 0))
        assert beside.do(("sleep", 0)).status == "timed_out"
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_work_that_cannot_be_loaded_says_so(tmp_path, monkeypatch):
    (tmp_path / "passing.py").write_text("def work(item):\n    return item\n")
    monkeypatch.syspath_prepend(tmp_path)
    import passing

    (tmp_path / "passing.py").unlink()
    with WorkerProcess(passing.work, LIMITS) as beside:
        assert "No module named 'passing'" in beside.do(1).reason


def test_a_scheduler_that_is_not_there_is_named():
    with pytest.raises(InputError, match=r"--scheduler tcp://127.0.0.1:9: no Dask scheduler answers"):
        list(on_dask(work, [*enumerate(ITEMS)], LIMITS, "tcp://127.0.0.1:9", answers=0.5))


def test_a_scheduler_that_accepts_and_says_nothing_is_named():
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(InputError, match=r"no Dask scheduler answers \(nothing within 0.5 s\)"):
            list(on_dask(work, [*enumerate(ITEMS)], LIMITS, address, answers=0.5))


def test_no_item_is_no_work():
    """No process is started: it could not be sent this work."""
    assert list(each(lambda item: item, [])) == []
