"""Documents are made once, whoever asks meanwhile, and those that fail are made anew."""

from __future__ import annotations

import asyncio
import threading

import pytest

from vibrafeed.app.web.made_once import MadeOnce


def test_who_asks_while_it_is_made_waits_and_it_is_made_once():
    made_once, made, go_on = MadeOnce(), [], threading.Event()

    def make() -> bytes:
        go_on.wait()
        made.append(True)
        return b"{}"

    async def scene() -> list[tuple[bytes, str]]:
        asked = [asyncio.create_task(made_once("one", make)) for _ in range(100)]
        await asyncio.sleep(0)
        go_on.set()
        return await asyncio.gather(*asked, made_once("one", make))

    (reply,) = set(asyncio.run(scene()))
    assert reply[0] == b"{}"
    assert made == [True]


def test_what_could_not_be_made_is_made_anew():
    made_once = MadeOnce()

    async def scene() -> tuple[bytes, str]:
        with pytest.raises(ZeroDivisionError):
            await made_once("one", lambda: b"%d" % (1 // 0))
        return await made_once("one", lambda: b"1")

    assert asyncio.run(scene())[0] == b"1"
