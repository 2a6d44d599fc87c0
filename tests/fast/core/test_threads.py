"""Kept threads carry out every task once, tell the first error, and leave nothing running."""

import threading

import pytest

from vibrafeed.core.plan.evaluate import share_out
from waiting import PATIENCE


def test_every_task_once_and_by_the_same_threads_each_time():
    names: set[str] = set()
    for _ in range(20):
        done: list[int] = []

        def call(task, done=done):
            names.add(threading.current_thread().name)
            done.append(task)

        share_out(call, range(6), 2)
        assert sorted(done) == list(range(6))
    assert len(names) <= 2  # no more at a time than asked


def test_the_caller_takes_part_and_does_all_where_others_are_busy():
    held, free = threading.Event(), threading.Event()

    def call(task):
        if threading.current_thread() is not threading.main_thread():
            held.set()
            free.wait(PATIENCE)

    blocked = threading.Thread(target=lambda: share_out(lambda _: call(0), range(2), 2))
    blocked.start()  # has both the kept thread and its own wait
    held.wait(PATIENCE)
    done: list[str] = []
    share_out(lambda _: done.append(threading.current_thread().name), range(5), 2)
    free.set()
    blocked.join(PATIENCE)
    assert done == [threading.current_thread().name] * 5


def test_tasks_may_share_out_tasks_of_their_own():
    done: list[int] = []
    share_out(lambda _: share_out(done.append, range(3), 2), range(4), 2)
    assert sorted(done) == sorted([0, 1, 2] * 4)


def test_the_first_error_comes_after_what_has_begun_and_the_rest_is_left_out():
    begun, ended, released = [], [], threading.Event()

    def call(task):
        begun.append(task)
        if task == 0:
            released.set()
            raise ValueError("of the first task")
        released.wait(PATIENCE)
        ended.append(task)

    with pytest.raises(ValueError, match="of the first task"):
        share_out(call, range(1000), 2)
    assert set(begun) - {0} == set(ended)  # nothing goes on
    before = len(begun)
    share_out(lambda _: None, range(4), 2)
    assert len(begun) == before < 1000
