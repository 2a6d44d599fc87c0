"""What runs in the processes of a pool comes back, is ended, or has ended by itself."""

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

import psutil
import pytest

from services import wait_for_end
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

pytestmark = pytest.mark.anyio


def hold():
    """Hold the interpreter; nothing but the end of the process ends it."""
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


def die(amid_the_reply=False):
    if amid_the_reply:
        (pipe,) = (one for one in gc.get_objects() if isinstance(one, Connection))
        os.write(pipe.fileno(), struct.pack("!i", 1000) + b"half of it")
    os.kill(os.getpid(), signal.SIGKILL)


def local_lambda():
    return lambda: None


@pytest.fixture
async def pool(monkeypatch):
    for name in ENVIRONMENT:
        monkeypatch.delenv(name, raising=False)
    pool = ProcessPool(1, ())
    pool.open()
    yield pool
    pool.close()


async def test_results_and_errors_come_back_as_they_were(pool):
    """From another process, which is used again."""
    process = psutil.Process(await pool(os.getpid))
    assert process.pid != os.getpid()
    # Of one thread; what is freed goes back to the machine.
    assert await pool(environment) == ENVIRONMENT
    for result in (bytes(range(256)) * 4_000, b"", bytearray(b"error"), None, {"a": [1.5]}):
        found = await pool(same, result, seconds=60)
        assert found == result
        assert type(found) is type(result)
    for error in (
        StudyError([Problem("parameters.beta", "it is too steep", "Use less", about="beta")]),
        LimitError("cells", 10, 5, "Use fewer"),
        StoppedError("It takes too long."),
        ValueError("a mistake of ours"),
    ):
        with pytest.raises(type(error)) as raised:
            await pool(fail, error)
        assert str(raised.value) == str(error)
        assert getattr(raised.value, "problems", None) == getattr(error, "problems", None)
    with pytest.raises(RuntimeError, match="lambda"):
        await pool(local_lambda)  # it cannot be sent
    assert await pool(os.getpid) == process.pid
    pool.close()
    wait_for_end([process])


@pytest.mark.parametrize("arguments", [(), (True,)])
async def test_a_process_that_dies_is_told_and_replaced(pool, arguments):
    first = await pool(os.getpid)
    with pytest.raises(EndedError):
        await pool(die, *arguments)
    second = await pool(os.getpid)
    os.kill(second, signal.SIGKILL)  # while it is idle
    wait_for(lambda: not pool._idle[0]._process.is_alive())
    assert len({first, second, await pool(os.getpid)}) == 3


@pytest.mark.parametrize(("busy", "error"), [(0.04, SlowError), (0.06, StoppedError)])
async def test_what_takes_too_long_is_ended_and_others_go_on(pool, busy, error, monkeypatch):
    """On a busy machine it has not had its time, and is not to blame."""
    first, spent = await pool(os.getpid), iter([1.0, 1.0 + busy])
    monkeypatch.setattr(_Process, "busy_seconds", lambda self: next(spent, 9.0))
    with pytest.raises(StoppedError) as held:
        await pool(hold, seconds=0.1)
    assert type(held.value) is error
    assert await pool(os.getpid) != first


async def test_what_nobody_wants_any_more_is_ended(pool):
    async def look():
        raise InterruptedError

    told = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: told.append(context))
    with pytest.raises(InterruptedError):
        await pool(hold, seconds=10**6, check=look)
    gc.collect()  # an error that nobody has asked a future for is told as the future goes
    assert told == []


async def test_memory_does_not_pile_up(pool):
    first = await pool(os.getpid)
    pool._idle[0].calls = CALLS - 1
    assert await pool(os.getpid) == first
    assert await pool(os.getpid) != first


async def test_what_is_given_up_may_end_by_itself(pool, tmp_path):
    path = tmp_path / "pid"
    call = asyncio.create_task(pool(write_and_sleep, path, 0.3, grace=PATIENCE))
    await awaited(lambda: path.exists() and path.read_text())
    call.cancel()
    await asyncio.wait({call})
    assert int(path.read_text()) == await pool(os.getpid)


def test_processes_end_with_their_service(tmp_path):
    path = tmp_path / "pid"
    code = f"""
import asyncio, test_process_pool as t
asyncio.run(t.ProcessPool(1, ())(t.write_and_sleep, t.Path({str(path)!r}), 1e6))
"""
    places = os.pathsep.join([*sys.path, str(Path(__file__).parent)])
    service = subprocess.Popen(
        [sys.executable, "-c", code], env=os.environ | {"PYTHONPATH": places}
    )
    process = psutil.Process(int(wait_for(lambda: path.exists() and path.read_text())))
    service.kill()
    service.wait()
    wait_for_end([process])
