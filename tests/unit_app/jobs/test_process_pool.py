"""What runs in the processes of a pool comes back, is ended, or has ended by itself."""

from __future__ import annotations

import ast
import asyncio
import contextlib
import gc
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from vibrafeed.app.jobs.process_pool import CALLS, ENVIRONMENT, SHARED, EndedError, ProcessPool
from vibrafeed.core.errors import LimitError, Problem, StoppedError, StudyError
from waiting import wait_for


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


def die():
    os.kill(os.getpid(), signal.SIGKILL)


def local_lambda():
    return lambda: None


def carried_out(*calls):
    """Return what each coroutine function, given a pool, returns or raises, one after another."""

    async def main():
        pool = ProcessPool(2, (__name__,))
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


def test_results_come_back_as_they_were():
    results = [bytes(range(256)) * 4_000, b"", b"value", bytearray(b"error"), None, {"a": [1.5]}]
    calls = [lambda pool, result=result: pool(same, result, seconds=60) for result in results]
    found = carried_out(*calls)
    assert found == results
    assert [type(one) for one in found] == [type(one) for one in results]


def files_in_memory():
    """Return how many results this process still holds open; other files come and go."""
    gc.collect()
    found = 0
    for link in list(Path("/proc/self/fd").iterdir()):
        with contextlib.suppress(FileNotFoundError):  # closed meanwhile
            found += "memfd:result" in str(link.readlink())
    return found


def test_a_large_result_is_memory_of_both_processes_and_no_file_of_theirs_stays():
    large = bytes(range(256)) * (SHARED // 256)

    async def taken(pool):
        first = await pool(same, large, seconds=60)
        assert isinstance(first, memoryview)
        assert first.readonly
        second = await pool(same, large[::-1], seconds=60)
        assert first == large
        assert second == large[::-1]

    # The thread that has taken a result lets go of it a moment later.
    async def held(pool):
        result = await pool(same, large, seconds=60)
        wait_for(lambda: files_in_memory() == 1)
        del result
        wait_for(lambda: files_in_memory() == 0)
        return await pool(files_in_memory, seconds=60)

    assert carried_out(taken, held) == [None, 0]


def test_processes_have_one_thread_each_and_give_memory_back():
    # In a process of its own: here others may have started the server that all are forked from.
    code = (
        "import asyncio\n"
        "from vibrafeed.app.jobs.process_pool import ProcessPool\n"
        "from test_process_pool import environment\n"
        "pool = ProcessPool(1, ())\n"
        "pool.open()\n"
        "print(asyncio.run(pool(environment, seconds=600)))\n"
        "pool.close()"
    )
    places = os.pathsep.join([*sys.path, str(Path(__file__).parent)])
    bare = {name: value for name, value in os.environ.items() if name not in ENVIRONMENT}
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True, text=True, check=True, env=bare | {"PYTHONPATH": places},
    )  # fmt: skip
    assert ast.literal_eval(done.stdout) == ENVIRONMENT


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
        wait_for(lambda: not any(process.is_alive() for process in pool._idle))
        return pid, await pool(os.getpid, seconds=60)

    [(first, second)] = carried_out(killed)
    assert first != second


def test_memory_does_not_pile_up():
    async def many(pool):
        first = await pool(os.getpid, seconds=60)
        pool._idle[0].calls = CALLS - 1
        return first, await pool(os.getpid, seconds=60), await pool(os.getpid, seconds=60)

    [(first, last, other)] = carried_out(many)
    assert first == last != other
