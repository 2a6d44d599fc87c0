"""Firefox by WebDriver BiDi, which it speaks by itself: no driver stands between."""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import aiohttp

from waiting import PATIENCE

LISTENING = re.compile(rb"WebDriver BiDi listening on (ws://\S+)")
PREFERENCES = {
    "browser.download.folderList": 2,  # the folder of the next line
    "browser.download.always_ask_before_handling_new_types": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "app.update.disabledForTesting": True,
    "browser.shell.checkDefaultBrowser": False,
    "toolkit.startup.max_resumed_crashes": -1,
    "remote.log.level": '"Error"',
}


class Tab:
    """A tab of a browser, driven over a socket.

    Attributes
    ----------
    told : list of str
        What the page told the console, and errors of its scripts.
    asked : list of str
        The addresses that it asked for.
    """

    def __init__(self, socket: aiohttp.ClientWebSocketResponse):
        self.socket = socket
        self.numbers = itertools.count(1)
        self.context = ""
        self.told: list[str] = []
        self.asked: list[str] = []

    async def send(self, method: str, **parameters: Any) -> Any:
        """Return the result of a command; events that come before it are noted."""
        number = next(self.numbers)
        await self.socket.send_json({"id": number, "method": method, "params": parameters})
        while True:
            reply = await asyncio.wait_for(self.socket.receive_json(), PATIENCE)
            if reply.get("id") == number:
                assert reply["type"] == "success", reply
                return reply["result"]
            if reply.get("method") == "log.entryAdded":
                self.told.append(reply["params"]["text"])
            if reply.get("method") == "network.beforeRequestSent":
                self.asked.append(reply["params"]["request"]["url"])

    async def begin(self) -> None:
        """Open the session, and listen to what the page tells and asks for."""
        await self.send("session.new", capabilities={})
        events = ["log.entryAdded", "network.beforeRequestSent"]
        await self.send("session.subscribe", events=events)
        tree = await self.send("browsingContext.getTree")
        self.context = tree["contexts"][0]["context"]

    async def go(self, address: str) -> None:
        """Load an address."""
        await self.send(
            "browsingContext.navigate", context=self.context, url=address, wait="complete"
        )

    async def evaluate(self, expression: str) -> Any:
        """Return the text, number or truth that an expression has; it may be a promise."""
        found = await self.send(
            "script.evaluate",
            expression=expression,
            target={"context": self.context},
            awaitPromise=True,
            userActivation=True,
        )
        assert found["type"] == "success", found
        return found["result"].get("value")

    async def until(self, expression: str) -> None:
        """Wait until an expression is true."""
        async with asyncio.timeout(PATIENCE):
            while not await self.evaluate(f"Boolean({expression})"):
                await asyncio.sleep(0.05)

    async def click(self, x: float, y: float) -> None:
        """Press the mouse at a place of the window, as a hand does."""
        actions = [
            {"type": "pointerMove", "x": round(x), "y": round(y)},
            {"type": "pointerDown", "button": 0},
            {"type": "pointerUp", "button": 0},
        ]
        source = {"type": "pointer", "id": "mouse", "actions": actions}
        await self.send("input.performActions", context=self.context, actions=[source])


@asynccontextmanager
async def firefox(program: str, folder: Path) -> AsyncIterator[Tab]:
    """Yield a tab of a Firefox with an empty profile; it saves files in `folder`/saved."""
    profile, saved = folder / "profile", folder / "saved"
    profile.mkdir()
    saved.mkdir()
    lines = [f'user_pref("browser.download.dir", "{saved}");']
    for name, value in PREFERENCES.items():
        lines.append(
            f'user_pref("{name}", {str(value).lower() if value in (True, False) else value});'
        )
    (profile / "user.js").write_text("\n".join(lines))
    process = await asyncio.create_subprocess_exec(
        program, "--headless", "--no-remote", "--profile", str(profile),
        "--remote-debugging-port", "0",
        stdout=asyncio.subprocess.DEVNULL,
        stderr=asyncio.subprocess.PIPE,
        env={"HOME": str(folder), "PATH": "/usr/bin:/bin"},
    )  # fmt: skip
    draining = None
    try:
        address = await asyncio.wait_for(_listening(process), PATIENCE)
        draining = asyncio.create_task(_drained(process))
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(f"{address}/session", max_msg_size=0) as socket,
        ):
            tab = Tab(socket)
            await tab.begin()
            yield tab
            await tab.send("browser.close")
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.terminate()
        await process.wait()
        if draining is not None:
            await draining


async def _listening(process: asyncio.subprocess.Process) -> str:
    assert process.stderr is not None
    async for line in process.stderr:
        if found := LISTENING.search(line):
            return found[1].decode()
    raise AssertionError("Firefox ended before it listened")


async def _drained(process: asyncio.subprocess.Process) -> None:
    assert process.stderr is not None
    while await process.stderr.read(1 << 16):
        pass
