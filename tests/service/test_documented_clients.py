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

from waiting import PATIENCE, SELDOM, wait_for

ROOT = Path(__file__).parents[2]


def blocks(path: str, language: str, after: str) -> list[str]:
    """Return the blocks of a language after a heading, up to the next one."""
    text = (ROOT / path).read_text().partition(f"\n{after}\n")[2].partition("\n## ")[0]
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the README's studies as JSON."""
    folder = tmp_path_factory.mktemp("client")
    for name, heading in (
        ("motion", "## How fast, and does it hop?"),
        ("study", "## Forces and accelerations"),
    ):
        (text,) = blocks("README.md", "toml", heading)
        (folder / f"{name}.json").write_text(json.dumps(tomllib.loads(text)))
    return folder


def run(code: str, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, timeout=PATIENCE,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_clients_of_the_page_on_the_interface(server, folder):
    code = "\n".join(blocks("docs/api.md", "python", "## Clients"))
    assert code.count("http://127.0.0.1:8000") == 3
    code = code.replace("http://127.0.0.1:8000", server)
    code += """
assert dict(dataset.sizes) == {"amplitude": 71, "beta": 56}
assert sweep.acceleration_x.size == 61 * 3 * 21 * 41
print(json.dumps([reply.status_code, sorted(answer), job["type"]]))
"""
    status, answered, kind = json.loads(run(code, folder))
    assert status == 200
    assert kind == "process"
    # At once as a document, or as a job: what this machine is thought to take decides.
    assert answered == ["dataset"] or "jobID" in answered


def test_the_client_of_the_guide_for_python(server, folder):
    (code,) = blocks("docs/python.md", "python", "## Results of the service")
    code = code.replace("http://127.0.0.1:8000", server)
    code += "print(result.vibrafeed.study.scene, result.sizes['beta'])"
    assert run(code, folder) == "rectangle-on-plane 7\n"


def test_the_curl_lines_of_the_page(curl, server, folder):
    (lines,) = (b for b in blocks("docs/api.md", "sh", "## Clients") if "curl" in b)
    posting, *others = lines.replace("http://127.0.0.1:8000", server).strip().splitlines()

    def shell(line: str) -> str:
        line = line.replace("curl ", f"{curl} --silent --show-error --fail --noproxy '*' ", 1)
        done = subprocess.run(
            line,
            shell=True,
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )
        assert done.returncode == 0, (line, done.stderr)
        return done.stdout

    href = json.loads(shell(posting))["dataset"]["href"]
    number = href.split("/")[-3]
    events, download, dismissal = (line.replace("NUMBER", number) for line in others)
    assert '"status":"successful"' in shell(events)
    (folder / "motion.nc").unlink(missing_ok=True)
    shell(download)
    assert (folder / "motion.nc").read_bytes()[:4] == b"\x89HDF"
    assert json.loads(shell(dismissal))["status"] == "dismissed"


def results_of(server, job):
    """Return what a job leaves, once it has ended."""

    def ended():
        with urllib.request.urlopen(f"{server}/jobs/{job}") as reply:
            return json.load(reply)["status"] == "successful"

    wait_for(ended, every=SELDOM)
    with urllib.request.urlopen(f"{server}/jobs/{job}/results") as reply:
        return json.load(reply)


def test_the_three_calls_answer_what_the_page_says(curl, server):
    text = " ".join((ROOT / "docs/api.md").read_text().split())
    lines = "".join(blocks("docs/api.md", "sh", "## Three calls"))
    replies, key = [], ""
    for line in re.split(r"^(?=curl )", lines, flags=re.MULTILINE)[1:]:
        line = line.replace("http://127.0.0.1:8000", server).replace("/ID/", f"/{key}/")
        line = line.replace("curl ", f"{curl} --silent --show-error --fail --noproxy '*' ", 1)
        done = subprocess.run(line, shell=True, capture_output=True, text=True, timeout=PATIENCE)
        assert done.returncode == 0, (line, done.stderr)
        replies.append(json.loads(done.stdout))
        if "jobID" in replies[-1]:  # of a busy machine, which has not done it in the time waited
            replies[-1] = results_of(server, replies[-1]["jobID"])
        if "dataset" in replies[-1]:  # a job, on a machine that is thought to take long
            with urllib.request.urlopen(f"{replies[-1]['dataset']['href']}?format=json") as reply:
                replies[-1] = json.load(reply)
        key = replies[-1].get("id", "")
    speed, best, _, piece = replies
    assert f'"data": {speed["variables"]["conveying_velocity"]["data"]:.5f}...' in text
    about = {name: one["data"] for name, one in best["variables"].items()}
    assert f"`best_beta` is {about['best_beta']:.2f} degree" in text
    assert f"`conveying_velocity` {about['conveying_velocity']:.5f} m/s" in text
    assert "[" + ", ".join(f"{one:.4f}" for one in piece["values"]["data"]) + "]" in text


def test_the_line_that_convert_writes(curl, server, folder):
    from vibrafeed.core.intake import study_of
    from vibrafeed.core.intake.forms import to_curl

    content = {
        "kind": "sweep",
        "scene": "rectangle-on-plane",
        "title": 'it\'s "$(touch owned)" `id`\n\\',
        "outputs": ["throw_number"],
        "parameters": {"frequency": "50 Hz", "amplitude": "0.3 mm", "beta": [10, 20]},
    }
    line = to_curl(content, server).replace("curl ", f"{curl} --silent --noproxy '*' ", 1)
    done = subprocess.run(
        line, shell=True, cwd=folder, capture_output=True, text=True, timeout=PATIENCE, check=True
    )
    assert study_of(content).key() in done.stdout
    assert not (folder / "owned").exists()
