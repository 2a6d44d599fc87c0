"""The files of the page on scale are linted, and run as far as a machine without a queue can."""

from __future__ import annotations

import ast
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest
import xarray
import yaml

from tools import tool
from vibrafeed.core.intake import parse_study, prepare_content
from vibrafeed.core.kinds import tabulate

ROOT = Path(__file__).parents[2]
SCALE = (ROOT / "docs" / "scale.md").read_text(encoding="utf-8")
REDUCE = (ROOT / "docs" / "reduce.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


SHARES, JOIN = blocks(SCALE, "bash")


@pytest.mark.parametrize("script", [*blocks(SCALE, "bash"), *blocks(SCALE, "sh")])
def test_scripts_are_shell(script: str) -> None:
    done = subprocess.run(
        [tool("bash"), "-n"], input=script, text=True, capture_output=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    linter = shutil.which("shellcheck")
    if linter is not None and script.startswith("#!"):
        subprocess.run([linter, "-"], input=script, text=True, check=True)


def test_the_array_of_the_script_is_all_shares() -> None:
    first, last = map(int, re.search(r"--array=(\d+)-(\d+)", SHARES).groups())  # type: ignore[union-attr]
    count = int(re.search(r"SHARES=(\d+)", SHARES)[1])  # type: ignore[index]
    assert (first, last + 1) == (0, count)


@pytest.mark.night
@pytest.mark.service
def test_an_array_of_jobs_and_their_joining(tmp_path: Path) -> None:
    study = tomllib.loads(blocks(REDUCE, "toml")[0])
    (tmp_path / "study.toml").write_text(blocks(REDUCE, "toml")[0])
    folder = tmp_path / "bin"
    folder.mkdir()
    command = folder / "vibrafeed"
    command.write_text(f'#!/bin/sh\nexec {sys.executable} -m vibrafeed "$@"\n')
    command.chmod(0o755)
    path = f"{folder}{os.pathsep}{os.environ['PATH']}"
    shares = SHARES.replace("SHARES=4096", "SHARES=3")
    for task in range(3):
        environment = {**os.environ, "PATH": path, "SLURM_ARRAY_TASK_ID": str(task)}
        subprocess.run([tool("bash"), "-c", shares], cwd=tmp_path, env=environment, check=True)
    environment = {**os.environ, "PATH": path}
    subprocess.run([tool("bash"), "-c", JOIN], cwd=tmp_path, env=environment, check=True)
    want = tabulate(prepare_content(study)).to_xarray()
    with xarray.open_dataset(tmp_path / "result.nc") as found:
        # In a file bounds are no coordinates but named by them.
        assert found.reset_coords().drop_attrs().identical(want.reset_coords().drop_attrs())


def test_the_job_is_an_indexed_one() -> None:
    (text,) = blocks(SCALE, "yaml")
    study, job = yaml.safe_load_all(text)
    assert (study["apiVersion"], study["kind"]) == ("v1", "ConfigMap")
    assert (job["apiVersion"], job["kind"]) == ("batch/v1", "Job")
    parse_study(tomllib.loads(study["data"]["study.toml"]))
    spec = job["spec"]
    assert set(spec) <= {
        "completionMode", "completions", "parallelism", "backoffLimitPerIndex", "template",
    }  # fmt: skip
    assert spec["completionMode"] == "Indexed"
    assert spec["parallelism"] <= spec["completions"]
    pod = spec["template"]["spec"]
    assert pod["restartPolicy"] == "Never"  # which backoffLimitPerIndex asks for
    (container,) = pod["containers"]
    assert container["command"] == ["/bin/sh", "-c"]
    (script,) = container["args"]
    assert f'--share "$JOB_COMPLETION_INDEX/{spec["completions"]}"' in script
    subprocess.run(["sh", "-n"], input=script, text=True, check=True)
    mounted = {one["name"] for one in container["volumeMounts"]}
    assert mounted == {one["name"] for one in pod["volumes"]}
    assert pod["volumes"][0]["configMap"]["name"] == study["metadata"]["name"]


def test_the_script_of_the_queue_is_python_and_its_command_is_known() -> None:
    (script,) = blocks(SCALE, "python")
    tree = ast.parse(script)
    words = [one.value for one in ast.walk(tree) if isinstance(one, ast.Constant)]
    assert {"vibrafeed", "run", "--scheduler"} <= set(words)


def test_what_the_page_on_reductions_shows_gives_what_it_says() -> None:
    content: dict[str, Any] = tomllib.loads(blocks(REDUCE, "toml")[0])
    content["parameters"]["frequency"]["num"] = 3
    found = tabulate(prepare_content(content)).variables
    named = set(
        re.findall(r"`(transport_velocity_\w+|share_\w+|level_[a-z]\w+|regime_\w+_count)`", REDUCE)
    )
    assert named
    assert named <= set(found)
    for key in ("over", "statistics", "of", "quantiles", "regimes", "cells"):
        assert f"| `{key}` |" in REDUCE
