"""`vibrafeed mcp`: tools for agents, over standard input and output."""

from __future__ import annotations

import asyncio
from importlib import import_module
from typing import Annotated

import typer

from vibrafeed.app.cli.console import needing
from vibrafeed.app.cli.serve import settings_in_force


def mcp(
    url: Annotated[
        str | None,
        typer.Option(
            "--url",
            help="Address of a running service; by default the service runs in this process.",
            show_default=False,
        ),
    ] = None,
    key: Annotated[
        str | None,
        typer.Option(
            envvar="VIBRAFEED_KEY", help="Access key of that service.", show_default=False
        ),
    ] = None,
) -> None:
    """Offer scenes, checks, runs and jobs to an agent as tools of the Model Context Protocol.

    The agent's program starts this command and talks to it over standard input and output.
    """
    with needing("plot", "matplotlib"):
        import_module("vibrafeed.core.plots.drawing")
    with needing("mcp"):
        import_module("mcp")
    from vibrafeed.app.mcp_server import service_at, service_within, tools_for

    async def serve() -> None:
        """Serve until standard input ends."""
        service = service_at(url, key) if url else service_within(settings_in_force())
        async with service as client:
            await tools_for(client).run_stdio_async()

    asyncio.run(serve())
