"""What runs in the processes of a pool comes back, is ended, or has ended by itself."""

from __future__ import annotations

import asyncio
import gc
import os
import signal
import struct
import subprocess
import sys
import time
from multiprocessing.connection import Connection
from pathlib import Path

import pytest

from vibrafeed.app.jobs.process_pool import (
    CALLS,
    ENVIRONMENT,
    EndedError,
    ProcessPool,
    SlowError,
    _Process,
)
from vibrafeed.core.errors import LimitError, Problem, StoppedError, StudyError
from waiting import PATIENCE, awaited, wait_for


def hold(path=None):
    """Hold the interpreter; nothing but the end of the process ends it."""
    if path is not None:
        path.write_text(str(os.getpid()))
    pow(7, 7 ** (10**7))


def fail(error):
    raise error


def same(result):
    return result


def environment():
    return {name: os.environ.get(name) for name in ENVIRONMENT}


def write_and_sleep(path, seconds):
    path.write_text(str(os.getpid()))
    time.sleep(seconds)


def die():
    os.kill(os.getpid(), signal.SIGKILL)


def die_amid_the_reply():
    (pipe,) = (one for one in gc.get_objects() if isinstance(one, Connection))
    os.write(pipe.fileno(), struct.pack("!i", 1000) + b"half of it")
    die()


def local_lambda():
    return lambda: None


def carried_out(*calls):
    """Return what each coroutine function, given a pool, returns or raises, one after another."""

    async def main():
        pool = ProcessPool(1, ())
        pool.open()
        try:
            return [(await asyncio.gather(call(pool), return_exceptions=True))[0] for call in calls]
        finally:
            pool.close()

    return asyncio.run(main())


def is_there(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_a_function_returns_from_another_process_which_is_used_again():
    first, second = carried_out(*[lambda pool: pool(os.getpid, seconds=60)] * 2)
    assert first == second != os.getpid()
    wait_for(lambda: not is_there(first))  # the pool is closed


def test_a_process_that_dies_amid_its_reply_is_replaced():
    ended, found = carried_out(
        lambda pool: pool(die_amid_the_reply), lambda pool: pool(same, "another")
    )
    assert isinstance(ended, EndedError)
    assert found == "another"


def test_results_come_back_as_they_were():
    results = [bytes(range(256)) * 4_000, b"", b"value", bytearray(b"error"), None, {"a": [1.5]}]
    calls = [lambda pool, result=result: pool(same, result, seconds=60) for result in results]
    found = carried_out(*calls)
    assert found == results
    assert [type(one) for one in found] == [type(one) for one in results]


def test_processes_have_one_thread_each_and_give_memory_back(monkeypatch):
    for name in ENVIRONMENT:
        monkeypatch.delenv(name, raising=False)
    [found] = carried_out(lambda pool: pool(environment))
    assert found == ENVIRONMENT


@pytest.mark.parametrize(
    "error",
    [
        StudyError([Problem("parameters.beta", "it is too steep", "Use less", about="beta")]),
        LimitError("cells", 10, 5, "Use fewer"),
        StoppedError("It takes too long."),
        ValueError("a mistake of ours"),
    ],
)
def test_errors_come_back_as_they_were(error):
    [found] = carried_out(lambda pool: pool(fail, error, seconds=60))
    assert type(found) is type(error)
    assert str(found) == str(error)
    assert getattr(found, "problems", None) == getattr(error, "problems", None)


def test_what_cannot_be_sent_is_told():
    found, after = carried_out(
        lambda pool: pool(local_lambda, seconds=60), lambda pool: pool(os.getppid, seconds=60)
    )
    assert "lambda" in str(found)
    assert after


def test_what_takes_too_long_is_ended_and_others_go_on(tmp_path):
    path = tmp_path / "pid"
    held, after = carried_out(
        lambda pool: pool(hold, path, seconds=2), lambda pool: pool(os.getpid, seconds=60)
    )
    assert isinstance(held, StoppedError)
    if path.exists():  # on a busy machine it may not have begun
        assert after != int(path.read_text())
        wait_for(lambda: not is_there(int(path.read_text())))


@pytest.mark.parametrize(("busy", "error"), [(0.4, SlowError), (0.6, StoppedError)])
def test_a_busy_machine_is_not_what_takes_too_long(busy, error, monkeypatch):
    spent = iter([1.0, 1.0 + busy])
    monkeypatch.setattr(_Process, "busy_seconds", lambda self: next(spent))
    [held] = carried_out(lambda pool: pool(time.sleep, 1e6, seconds=1))
    assert type(held) is error


def test_what_nobody_wants_any_more_is_ended():
    async def look():
        raise InterruptedError

    told = []

    async def left(pool):
        asyncio.get_running_loop().set_exception_handler(lambda _, context: told.append(context))
        with pytest.raises(InterruptedError):
            await pool(hold, seconds=10**6, look=look)
        gc.collect()  # an error that nobody has asked a future for is told as the future goes

    assert carried_out(left) == [None]
    assert told == []


def test_a_process_that_dies_is_told_and_replaced():
    died, after = carried_out(
        lambda pool: pool(die, seconds=60), lambda pool: pool(os.getpid, seconds=60)
    )
    assert isinstance(died, EndedError)
    assert isinstance(after, int)


def test_an_idle_process_that_died_is_not_used():
    async def killed(pool):
        pid = await pool(os.getpid, seconds=60)
        os.kill(pid, signal.SIGKILL)
        wait_for(lambda: not is_there(pid))
        return pid, await pool(os.getpid, seconds=60)

    [(first, second)] = carried_out(killed)
    assert first != second


def test_memory_does_not_pile_up():
    async def many(pool):
        first = await pool(os.getpid)
        pool._idle[0].calls = CALLS - 1
        return first, await pool(os.getpid), await pool(os.getpid)

    [(first, last, other)] = carried_out(many)
    assert first == last != other


def test_what_is_given_up_may_end_by_itself(tmp_path):
    path = tmp_path / "pid"

    async def given_up(pool):
        call = asyncio.create_task(pool(write_and_sleep, path, 0.3, grace=PATIENCE))
        await awaited(path.exists)
        call.cancel()
        await asyncio.wait({call})
        return int(path.read_text()), await pool(os.getpid)

    [(first, second)] = carried_out(given_up)
    assert first == second


def test_processes_end_with_their_service(tmp_path):
    path = tmp_path / "pid"
    code = (
        "import test_process_pool as t\n"
        f"t.carried_out(lambda pool: pool(t.write_and_sleep, t.Path({str(path)!r}), 1e6))"
    )
    places = os.pathsep.join([*sys.path, str(Path(__file__).parent)])
    service = subprocess.Popen(
        [sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": places}
    )
    wait_for(lambda: path.exists() and path.read_text())
    service.kill()
    service.wait()
    wait_for(lambda: not is_there(int(path.read_text())))
