"""Firefox by WebDriver BiDi, which it speaks by itself: Playwright wants a newer one."""

import asyncio
import itertools
import re
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import aiohttp

from waiting import PATIENCE, awaited

LISTENING = re.compile(r"WebDriver BiDi listening on (ws://\S+)")
PREFERENCES = """
user_pref("browser.download.dir", "{}");
user_pref("browser.download.folderList", 2);  // the folder of the line before
user_pref("browser.download.always_ask_before_handling_new_types", false);
"""


class Tab:
    """A tab of a browser; it notes what the page tells the console, and the addresses it asks."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse):
        self.socket, self.context = socket, ""
        self.numbers = itertools.count()
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

    async def go(self, address: str) -> None:
        """Load an address."""
        asked = {"context": self.context, "url": address, "wait": "complete"}
        await self.send("browsingContext.navigate", **asked)

    async def evaluate(self, expression: str) -> Any:
        """Return the text, number or truth that an expression has; it may be a promise."""
        target = {"context": self.context}
        asked = {"expression": expression, "awaitPromise": True, "userActivation": True}
        found = await self.send("script.evaluate", target=target, **asked)
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
    log = folder / "log"
    (folder / "saved").mkdir()
    (folder / "user.js").write_text(PREFERENCES.format(folder / "saved"))
    with log.open("wb") as file:
        process = await asyncio.create_subprocess_exec(
            program, "--headless", "--no-remote", "--profile", str(folder),
            "--remote-debugging-port", "0", stdout=file, stderr=file,
            env={"HOME": str(folder), "PATH": "/usr/bin:/bin"},
        )  # fmt: skip
    try:
        address = (await awaited(lambda: LISTENING.search(log.read_text())))[1]
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(f"{address}/session", max_msg_size=0) as socket,
        ):
            tab = Tab(socket)
            await tab.send("session.new", capabilities={})
            events = ["log.entryAdded", "network.beforeRequestSent"]
            await tab.send("session.subscribe", events=events)
            tab.context = (await tab.send("browsingContext.getTree"))["contexts"][0]["context"]
            yield tab
            await tab.send("browser.close")
    finally:
        if process.returncode is None:
            process.terminate()
        await process.wait()
