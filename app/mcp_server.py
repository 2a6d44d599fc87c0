"""The door for agents: routes of the service as tools of the Model Context Protocol."""

from __future__ import annotations

import asyncio
import contextlib
import io
import json
import tempfile
import time
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Annotated, Any

import httpx2
from mcp.server.mcpserver import Image, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from pydantic import Field

from vibrafeed import core
from vibrafeed.app.jobs.ledger import ACTIVE
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.plots import drawing
from vibrafeed.core.plots.pictures import PlotError

POLL = 0.5  # s between looks at a job that an agent waits for
INSTRUCTIONS = """Compute how parts move on vibratory feeder tracks.

Find a scene with `scenes`, write a study, try it with `check`, then `run` it if it is small, or
`submit` it and read its `result`. A value of a parameter is a number in SI units or degrees, text
with a unit such as "0.5 mm", a list of them, or a range such as {"start": 0, "stop": 60, "num": 7}.
Lists and ranges become axes of the result.

Kinds of study:
""" + "\n".join(
    f"- {name}: {kind.description} Example: {json.dumps(kind.example)}"
    for name, kind in KINDS.items()
)
Study = Annotated[
    dict[str, Any],
    Field(description="The study: kind, scene, parameters, outputs, and what its kind needs."),
]


@contextlib.asynccontextmanager
async def service_at(url: str, key: str | None) -> AsyncIterator[httpx2.AsyncClient]:
    """Open a client of a running service, with an access key if it needs one."""
    headers = {"X-API-Key": key} if key else None
    async with httpx2.AsyncClient(base_url=url, headers=headers, timeout=None) as client:
        yield client


@contextlib.asynccontextmanager
async def service_within(settings: Settings) -> AsyncIterator[httpx2.AsyncClient]:
    """Start a service in this process and open a client of it; nothing listens on a port."""
    service = create_app(settings)
    transport = httpx2.ASGITransport(service)
    async with (
        service.router.lifespan_context(service),
        httpx2.AsyncClient(
            transport=transport, base_url="http://127.0.0.1", timeout=None
        ) as client,
    ):
        yield client
        service.state.stopping.set()


def tools_for(service: httpx2.AsyncClient) -> MCPServer:
    """Return the server whose tools ask a service."""
    server = MCPServer(
        "vibrafeed", instructions=INSTRUCTIONS, version=core.__version__, log_level="WARNING"
    )

    @server.tool(structured_output=False)
    async def scenes(
        name: Annotated[str, Field(description="A scene; without it, all are listed.")] = "",
        method: Annotated[
            str, Field(description="`events` describes the motion in time of the scene.")
        ] = "",
    ) -> str:
        """List the scenes, or describe one: parameters, outputs, units, equations, validity."""
        parameters = {"method": method} if method else {}
        return (await _reply(service, "GET", f"/scenes/{name}".rstrip("/"), params=parameters)).text

    @server.tool(structured_output=False)
    async def check(study: Study) -> str:
        """Check a study without computing it; return it as TOML, or all of its problems."""
        return (await _reply(service, "POST", "/convert?to=toml", json=study)).text

    @server.tool(structured_output=False)
    async def run(study: Study) -> str:
        """Compute a small study and return its dataset; a large one becomes a job."""
        return (await _execute(service, study)).text

    @server.tool(structured_output=False)
    async def submit(study: Study) -> str:
        """Compute a study as a job and return its status; `jobID` is for the tool `result`."""
        return (await _execute(service, study, Prefer="respond-async")).text

    @server.tool(structured_output=False)
    async def result(
        job: Annotated[str, Field(description="The `jobID` of a job.")],
        wait: Annotated[float, Field(description="Time to wait for it [s].", ge=0, le=600)] = 30,
        output: Annotated[
            str, Field(description="The output that the picture shows; the first by default.")
        ] = "",
        kind: Annotated[
            str, Field(description="Kind of picture, such as line, map or contour.")
        ] = "",
    ) -> list[Any]:
        """Return the result of a job: each variable with unit, dimensions and range, a picture.

        The status of the job comes in its place while the job runs.
        """
        deadline = time.monotonic() + wait
        while True:
            status = (await _reply(service, "GET", f"/jobs/{job}")).json()
            if status["status"] not in ACTIVE or time.monotonic() >= deadline:
                break
            await asyncio.sleep(POLL)
        if status["status"] in ACTIVE:
            return [status]
        file = await _reply(service, "GET", f"/jobs/{job}/results/dataset?format=netcdf")
        return await asyncio.to_thread(_summarise, file.content, output, kind)

    return server


def _summarise(content: bytes, output: str, kind: str) -> list[Any]:
    """Return unit, dimensions and range of each variable of a result, and a picture."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "result.nc"
        file.write_bytes(content)
        dataset = drawing.read(file)
    variables = {
        name: {
            "unit": values.attrs.get("units", ""),
            "dimensions": dict(values.sizes),
            "min": values.values.min().item(),
            "max": values.values.max().item(),
        }
        for name, values in dataset.variables.items()
        if values.dtype.kind in "iuf" and values.size
    }
    picture = io.BytesIO()
    try:
        drawing.draw(dataset, variable=output or None, kind=kind or None).savefig(picture)
    except PlotError as error:
        raise ToolError(str(error)) from None
    return [variables, Image(data=picture.getvalue(), format="png")]


async def _execute(service: httpx2.AsyncClient, study: dict[str, Any], **headers: str) -> Any:
    kind = study.get("kind", "")
    if kind not in KINDS:
        raise ToolError(f"kind: there is no kind of study {kind!r}. Choose {', '.join(KINDS)}.")
    path = f"/processes/{kind}/execution"
    return await _reply(service, "POST", path, json=study, headers=headers)


async def _reply(
    service: httpx2.AsyncClient, method: str, path: str, **options: Any
) -> httpx2.Response:
    """Return a reply of the service; raise `ToolError` with its problems."""
    reply = await service.request(method, path, **options)
    if reply.is_success:
        return reply
    problem = reply.json()
    lines = [f"{problem['title']}. {problem['detail']}"]
    lines += [
        f"{error['place']}: {error['message']}. {error['fix']}."
        for error in problem.get("errors", ())
    ]
    raise ToolError("\n".join(lines))
