"""Whatever one item does, it gets its row and the others theirs: beside this process and on Dask alike."""

import os
import socket

import pytest

from bench.errors import InputError
from bench.jobs.each import each
from bench.jobs.on_dask import on_dask
from bench.jobs.process import Failure, Limits, WorkerProcess
from tests.jobs import pieces
from tests.jobs.pieces import work

LIMITS = Limits(deadline=5.0, memory=300 * 2**20)
REFUSAL = f"ValueError: 7 is not for me (at pieces.py:{pieces.refuse.__code__.co_firstlineno + 1})"
#: What is done, and its outcome.
OUTCOMES = {
    (pieces.square, 3): 9,
    (pieces.refuse, 7): Failure("failed", REFUSAL),
    (pieces.hang, 0): Failure("timed_out", "no result within 5 s"),
    (pieces.crash, 0): Failure("failed", "its worker was killed (SIGSEGV)"),
    (pieces.killed, 0): Failure("failed", "its worker was killed (SIGKILL)"),
    (pieces.fill, 400): Failure("failed", "its worker was killed (it took more than 300 MB)"),
    (pieces.leave, 3): Failure("failed", "its worker was killed (exit status 3)"),
    (pieces.square, 5): 25,
}


def assert_outcomes(**where):
    """In any order, and a result that cannot be sent is a failure, too."""
    items = [*OUTCOMES, (pieces.unpicklable, 1)]
    found = dict(each(work, items, LIMITS, **where))
    unpicklable = found.pop(len(OUTCOMES))
    assert unpicklable.status == "failed" and "pickle" in unpicklable.reason
    assert {items[place]: outcome for place, outcome in found.items()} == OUTCOMES


def test_every_item_has_its_outcome_beside_this_process():
    assert_outcomes(workers=1)


def test_the_same_on_dask(cluster):
    assert_outcomes(scheduler=cluster.scheduler_address)


@pytest.mark.slow
def test_a_worker_that_is_lost_is_dasks_matter_and_ends_no_run(cluster):
    items = [(pieces.parricide, 0), *[(pieces.square, number) for number in range(20)]]
    found = dict(each(work, items, LIMITS, scheduler=cluster.scheduler_address))
    assert found.pop(0) == Failure("failed", "its worker was killed (Dask tried it as often as it is allowed to)")
    assert found == {1 + number: number**2 for number in range(20)}


@pytest.mark.parametrize(("seconds", "starts", "processes"), [(0.0, 60.0, 1), (2.0, 0.05, 2)])
def test_long_jobs_have_several_processes_and_short_ones_one(seconds, starts, processes):
    found = dict(each(work, [(pieces.slowly, seconds)] * 4, LIMITS, workers=2, starts=starts))
    assert len(set(found.values())) == processes


def ended(processes):
    for process in processes:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)


def test_processes_are_ended_with_the_run():
    found = dict(each(work, [(pieces.process, 0)] * 40, LIMITS, workers=2, starts=1e-9))
    assert sorted(found) == list(range(40))
    ended(found.values())


def test_a_run_that_is_left_ends_what_is_still_done():
    running = each(work, [(pieces.process, 0), *[(pieces.hang, 0)] * 3], Limits(deadline=600.0), workers=1)
    place, process = next(running)
    running.close()
    assert place == 0
    ended([process])


def test_one_process_does_all_items_that_go_well():
    with WorkerProcess(work, LIMITS) as beside:
        processes = {beside.do((pieces.process, 0)) for _ in range(3)}
        beside.do((pieces.killed, 0))
        after = beside.do((pieces.process, 0))
    assert len(processes) == 1
    assert after not in {*processes, os.getpid()}


def test_what_is_stopped_is_gone():
    with WorkerProcess(work, Limits(deadline=1.5)) as beside:
        process = beside.do((pieces.process, 0))
        assert beside.do((pieces.sleep, 0)).status == "timed_out"
    ended([process])


def test_work_that_cannot_be_loaded_says_so(tmp_path, monkeypatch):
    (tmp_path / "passing.py").write_text("def work(item):\n    return item\n")
    monkeypatch.syspath_prepend(tmp_path)
    import passing

    (tmp_path / "passing.py").unlink()
    with WorkerProcess(passing.work, LIMITS) as beside:
        assert "No module named 'passing'" in beside.do(1).reason


def test_a_scheduler_that_is_not_there_or_says_nothing_is_named():
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        for where, words in (("tcp://127.0.0.1:9", ""), (address, r" \(nothing within 0.5 s\)")):
            with pytest.raises(InputError, match=rf"--scheduler {where}: no Dask scheduler answers{words}"):
                list(on_dask(work, [(0, (pieces.square, 3))], LIMITS, where, answers=0.5))


def test_no_item_is_no_work():
    """No process is started: it could not be sent this work."""
    assert list(each(lambda item: item, [])) == []
