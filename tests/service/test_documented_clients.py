"""The clients that the documents show do what they say, against a real server."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
import urllib.request
from pathlib import Path

import pytest

from tools import tool
from waiting import PATIENCE, SELDOM, wait_for

ROOT = Path(__file__).parents[2]


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
    events, _, dismissal = (
        shell(line.replace("NUMBER", number), server, folder) for line in others
    )
    assert '"status":"successful"' in events
    assert (folder / "motion.nc").read_bytes()[:4] == b"\x89HDF"
    assert json.loads(dismissal)["status"] == "dismissed"


def results_of(server, job):
    """Return what a job leaves, once it has ended."""

    def ended():
        with urllib.request.urlopen(f"{server}/jobs/{job}") as reply:
            return json.load(reply)["status"] == "successful"

    wait_for(ended, every=SELDOM)
    with urllib.request.urlopen(f"{server}/jobs/{job}/results") as reply:
        return json.load(reply)


def test_the_three_calls_answer_what_the_page_says(server, folder):
    text = " ".join((ROOT / "docs/api.md").read_text().split())
    lines = "".join(documented("docs/api.md", "sh", "## Three calls"))
    replies, key = [], ""
    for line in re.split(r"^(?=curl )", lines, flags=re.MULTILINE)[1:]:
        reply = json.loads(shell(line.replace("/ID/", f"/{key}/"), server, folder))
        if "jobID" in reply:  # of a busy machine, which has not done it in the time waited
            reply = results_of(server, reply["jobID"])
        if "dataset" in reply:  # a job, on a machine that is thought to take long
            with urllib.request.urlopen(f"{reply['dataset']['href']}?format=json") as found:
                reply = json.load(found)
        replies.append(reply)
        key = reply.get("id", "")
    speed, best, _, piece = replies
    assert f'"data": {speed["variables"]["conveying_velocity"]["data"]:.5f}...' in text
    about = {name: one["data"] for name, one in best["variables"].items()}
    assert f"`best_beta` is {about['best_beta']:.2f} degree" in text
    assert f"`conveying_velocity` {about['conveying_velocity']:.5f} m/s" in text
    assert "[" + ", ".join(f"{one:.4f}" for one in piece["values"]["data"]) + "]" in text
