from __future__ import annotations

import threading

import pytest

from zavis_bt.mission import DoneJob, InlineJobs, ThreadJobs


class HandClock:
    def __init__(self) -> None:
        self.time = 0.0

    def now(self) -> float:
        return self.time

    def wait_until(self, stamp: float) -> None:
        self.time = max(self.time, stamp)


def test_inline_job_is_done_after_its_latency_and_not_before():
    clock = HandClock()
    job = InlineJobs(clock, {"detect": 0.3}).submit("detect", lambda a, b: a + b, 2, 3)
    assert not job.done()
    clock.wait_until(0.3)
    assert job.done()
    assert job.result() == 5


def test_inline_job_without_listed_latency_is_done_at_once():
    assert InlineJobs(HandClock(), {}).submit("other", int).done()


@pytest.mark.parametrize("make", [lambda: InlineJobs(HandClock(), {}), ThreadJobs])
def test_what_the_work_raises_comes_out_of_result(make):
    jobs = make()
    job = jobs.submit("plan", lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        job.result()
    jobs.close()


def test_thread_jobs_of_one_label_run_in_order_and_labels_do_not_wait_for_each_other():
    jobs, gate, order = ThreadJobs(), threading.Event(), []
    slow = jobs.submit("detect", gate.wait)
    later = jobs.submit("detect", lambda: order.append("detect"))
    assert jobs.submit("plan", lambda: "planned").result() == "planned"
    assert not slow.done()
    assert not later.done()
    gate.set()
    later.result()
    assert order == ["detect"]
    jobs.close()


def test_cancelled_thread_job_never_runs():
    jobs, gate, ran = ThreadJobs(), threading.Event(), []
    jobs.submit("detect", gate.wait)
    waiting = jobs.submit("detect", lambda: ran.append(1))
    waiting.cancel()
    gate.set()
    jobs.close()
    assert ran == []


def test_done_job_holds_its_value():
    assert DoneJob(7).done()
    assert DoneJob(7).result() == 7
