"""Clients that we ship and show: the design tool, those of the documents, an agent's program."""

import asyncio
import base64
import json
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import matplotlib.image
import mcp
import numpy as np
import pytest
import xarray

from access import KEY, lock
from tools import tool
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from waiting import PATIENCE

ROOT = Path(__file__).parents[2]
TOOL = ROOT / "examples" / "design_tool.py"
BEST = {
    "kind": "optimise",
    "scene": "rectangle-on-track",
    "criterion": {"kind": "maximise", "output": "acceleration_x"},
    "variables": {
        "alpha": {"lower": "0 deg", "upper": "15 deg"},
        "beta": {"lower": "0 deg", "upper": "40 deg"},
    },
    "parameters": {"frequency": 60, "friction": 0.4, "gamma": 3, "delta": 15, "amplitude": 3e-4},
}


@pytest.fixture(scope="module")
def access(serve) -> list[str]:
    service = serve(workers=1)
    lock(service.address, service.folder / "data")
    return ["--address", service.address, "--key", KEY]


def test_it_finds_simulates_and_draws(access, tmp_path):
    picture = tmp_path / "new" / "design.png"
    command = [sys.executable, TOOL, *access, "--points", "16", "--output", picture]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.search(r"= ([\d.]+) at alpha = ([\d.]+) deg, beta = ([\d.]+) deg", done.stdout)
    expected = tabulate(prepare_content(BEST)).to_xarray()
    names = ("acceleration_x", "best_alpha", "best_beta")
    wanted = [float(expected[name]) for name in names]
    # As many digits as the tool prints.
    assert [float(text) for text in found.groups()] == pytest.approx(wanted, rel=1e-3, abs=0.006)
    assert "simulation successful, 100 %" in done.stdout
    with xarray.open_dataset(picture.with_suffix(".nc"), decode_times=False) as motion:
        assert motion.sizes == {"amplitude": 16}
        assert float(motion.beta) == pytest.approx(wanted[2], abs=1e-6)
        # The optimum keeps the floor, just so: from its amplitude on, 0.3 mm, the part hops. What
        # it does there is a matter of rounding.
        others = motion.where(abs(motion.amplitude - 3e-4) > 1e-6, drop=True)
        assert others.sizes == {"amplitude": 15}
        np.testing.assert_array_equal(others.flight_fraction > 0, others.amplitude > 3e-4)
    pixels = matplotlib.image.imread(picture)[..., :3]
    assert ((pixels == [1, 0, 0]).all(axis=-1)).sum() > 100  # the star, on the map and its legend


def documented(path: str, language: str, after: str) -> list[str]:
    """Return the blocks of a language after a heading, up to the next one."""
    text = (ROOT / path).read_text()
    if after:
        text = text.partition(f"\n{after}\n")[2].partition("\n## ")[0]
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def shell(line: str, server: str, folder: Path) -> str:
    """Return what a line of the shell prints that asks a service, here this one."""
    line = line.replace("http://127.0.0.1:8000", server)
    quiet = f"{tool('curl')} --silent --show-error --fail --noproxy '*' "
    done = subprocess.run(
        line.replace("curl ", quiet, 1), shell=True, cwd=folder, capture_output=True, text=True,
        timeout=PATIENCE, check=False,
    )  # fmt: skip
    assert done.returncode == 0, (line, done.stderr)
    return done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the README's studies as JSON."""
    folder = tmp_path_factory.mktemp("client")
    for name, study in zip(("motion", "study"), documented("README.md", "toml", ""), strict=True):
        (folder / f"{name}.json").write_text(json.dumps(tomllib.loads(study)))
    return folder


def test_the_clients_of_the_page_on_the_interface(server, folder):
    code = "\n".join(documented("docs/api.md", "python", "## Clients"))
    assert code.count("http://127.0.0.1:8000") == 3
    code = code.replace("http://127.0.0.1:8000", server)
    code += """
assert dict(dataset.sizes) == {"amplitude": 71, "beta": 56}
assert sweep.acceleration_x.size == 61 * 3 * 21 * 41
print(json.dumps([reply.status_code, sorted(answer), job["type"]]))
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    status, answered, kind = json.loads(done.stdout)
    assert status == 200
    assert kind == "process"
    # At once as a document, or as a job: what this machine is thought to take decides.
    assert answered == ["dataset"] or "jobID" in answered


def test_the_curl_lines_of_the_page(server, folder):
    (lines,) = (text for text in documented("docs/api.md", "sh", "## Clients") if "curl" in text)
    posting, *others = lines.strip().splitlines()
    href = json.loads(shell(posting, server, folder))["dataset"]["href"]
    number = href.split("/")[-3]
    (folder / "motion.nc").unlink(missing_ok=True)  # curl would go on with it
    events, _, dismissal = (
        shell(line.replace("NUMBER", number), server, folder) for line in others
    )
    assert '"status":"successful"' in events
    assert (folder / "motion.nc").read_bytes()[:4] == b"\x89HDF"
    assert json.loads(dismissal)["status"] == "dismissed"


def test_the_three_calls_answer_what_the_page_says(shared, folder):
    text = " ".join((ROOT / "docs/api.md").read_text().split())
    lines = "".join(documented("docs/api.md", "sh", "## Three calls"))
    replies, key = [], ""
    for line in re.split(r"^(?=curl )", lines, flags=re.MULTILINE)[1:]:
        reply = json.loads(shell(line.replace("/ID/", f"/{key}/"), shared.address, folder))
        if "jobID" in reply:  # of a busy machine, which has not done it in the time waited
            number = shared.finished(reply["jobID"])["jobID"]
            reply = shared.get(f"/jobs/{number}/results")
        if "dataset" in reply:  # a job, on a machine that is thought to take long
            place = reply["dataset"]["href"].removeprefix(shared.address)
            reply = shared.get(f"{place}?format=json")
        replies.append(reply)
        key = reply.get("id", "")
    speed, best, _, piece = replies
    assert f'"data": {speed["variables"]["conveying_velocity"]["data"]:.5f}...' in text
    about = {name: one["data"] for name, one in best["variables"].items()}
    assert f"`best_beta` is {about['best_beta']:.2f} degree" in text
    assert f"`conveying_velocity` is {about['conveying_velocity']:.5f} m/s" in text
    assert "[" + ", ".join(f"{one:.4f}" for one in piece["values"]["data"]) + "]" in text


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
