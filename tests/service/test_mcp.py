"""An agent's program finds a scene, checks a study, runs it, and reads the result of a job."""

from __future__ import annotations

import asyncio
import base64
import json
import os
import sys
from pathlib import Path
from typing import Any

import pytest

from waiting import PATIENCE

mcp = pytest.importorskip("mcp", reason="the SDK of the Model Context Protocol is missing")

STUDY = {
    "kind": "simulate",
    "scene": "rectangle-on-plane",
    "parameters": {"frequency": "50 Hz", "amplitude": "0.5 mm", "beta": 30, "friction": [0.2, 0.4]},
}


def asked(folder: Path, *calls: tuple[str, dict[str, Any]], url: str = "") -> list[Any]:
    """Return the names of the tools, and the results of calls, of which the last may be a job's."""
    parameters = mcp.StdioServerParameters(
        command=sys.executable,
        args=["-m", "vibrafeed", "mcp", *(["--url", url] if url else [])],
        env={
            name: os.environ[name] for name in ("PYTHONPATH", "HOME") if name in os.environ
        } | {"VIBRAFEED_DATA_DIRECTORY": str(folder)},
    )  # fmt: skip

    async def talk() -> list[Any]:
        async with mcp.Client(mcp.stdio_client(parameters)) as agent:
            results: list[Any] = [{tool.name for tool in (await agent.list_tools()).tools}]
            for name, arguments in calls:
                if name == "result":
                    job = json.loads(results[-1].content[0].text)["jobID"]
                    arguments = {**arguments, "job": job}
                results.append(await agent.call_tool(name, arguments))
            return results

    return asyncio.run(talk())


def test_an_agent_goes_from_a_scene_to_a_picture(tmp_path):
    wrong = {**STUDY, "scene": "rectangle-on-plan", "parameters": {"friction": "much"}}
    tools, listed, described, checked, refused, ran, submitted, result = asked(
        tmp_path,
        ("scenes", {}),
        ("scenes", {"name": "rectangle-on-plane", "method": "events"}),
        ("check", {"study": STUDY}),
        ("run", {"study": wrong}),
        ("run", {"study": STUDY}),
        ("submit", {"study": STUDY}),
        ("result", {"wait": PATIENCE, "output": "conveying_velocity"}),
    )
    assert tools == {"scenes", "check", "run", "submit", "result"}
    assert "rectangle-on-plane" in {one["name"] for one in json.loads(listed.content[0].text)}
    outputs = {one["name"] for one in json.loads(described.content[0].text)["outputs"]}
    assert "conveying_velocity" in outputs
    assert 'amplitude = "0.5 mm"' in checked.content[0].text
    # All problems at once, each with its place and what would be right.
    assert refused.is_error
    assert "Did you mean 'rectangle-on-plane'" in refused.content[0].text
    velocities = json.loads(ran.content[0].text)["variables"]["conveying_velocity"]["data"]
    assert not submitted.is_error
    variables, picture = result.content
    velocity = json.loads(variables.text)["conveying_velocity"]
    assert velocity == {
        "unit": "m s-1",
        "dimensions": {"friction": 2},
        "min": min(velocities),
        "max": max(velocities),
    }
    assert base64.b64decode(picture.data)[:4] == b"\x89PNG"


def test_the_tools_of_a_service_elsewhere(serve, tmp_path):
    address = serve(workers=1).address
    _, checked, unknown = asked(
        tmp_path, ("check", {"study": STUDY}), ("run", {"study": {"kind": "fly"}}), url=address
    )
    assert 'kind = "simulate"' in checked.content[0].text
    assert "there is no kind of study 'fly'" in unknown.content[0].text
