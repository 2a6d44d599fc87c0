"""A run that is stopped, also by the clock or while it compiles: nothing that was there is lost."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import xarray
from typer.testing import CliRunner

from vibrafeed.app.cli import app
from waiting import PATIENCE

STUDY = """
kind = "simulate"
scene = "rectangle-on-plane"
method = "reference"
[parameters]
frequency = "50 Hz"
amplitude = ["0.2 mm", "0.25 mm", "0.3 mm"]
beta = 30
friction = 0.4
"""


@pytest.fixture
def study(tmp_path: Path) -> Path:
    path = tmp_path / "motion.toml"
    path.write_text(STUDY)
    path.with_suffix(".nc").write_bytes(b"of yesterday")
    return path


def run(*arguments: object):
    return CliRunner().invoke(app, ["run", *map(str, arguments)])


def test_what_is_not_whole_goes_beside_a_file_that_is_there(study, stopped_after):
    stopped_after(1)
    result = run(study, "--force")
    assert result.exit_code == 1
    target = study.with_suffix(".nc")
    assert target.read_bytes() == b"of yesterday"
    said = " ".join(result.stderr.split())
    assert f"{target} stays as it was; what is computed goes to" in said
    with xarray.open_dataset(target.with_name("motion.partial.nc"), decode_times=False) as found:
        assert (found.motion_status != 0).sum() == 1


def test_what_is_not_whole_is_kept_where_nothing_is(study, stopped_after):
    stopped_after(1)
    target = study.with_suffix(".nc")
    target.unlink()
    assert run(study).exit_code == 1
    with xarray.open_dataset(target, decode_times=False) as found:
        assert (found.motion_status != 0).sum() == 1


def test_a_run_without_a_cell_writes_nothing(study, stopped_after):
    stopped_after(0)
    result = run(study, "--force")
    assert result.exit_code == 1
    assert "before a cell was computed; nothing is written" in " ".join(result.stderr.split())
    assert [path.name for path in sorted(study.parent.iterdir())] == ["motion.nc", "motion.toml"]
    assert study.with_suffix(".nc").read_bytes() == b"of yesterday"


def test_ctrl_c_ends_a_run_that_compiles(study, tmp_path):
    study.write_text(STUDY.replace("reference", "events"))
    process = subprocess.Popen(
        [sys.executable, "-m", "vibrafeed", "run", str(study), "--force"],
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")},
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stderr is not None
    with process.stderr as stderr:
        assert "compiling once" in stderr.readline()
        process.send_signal(signal.SIGINT)
        said, status = stderr.read(), process.wait(PATIENCE)
    assert (status, said) == (
        130, f"{study}: it was stopped before a cell was computed; nothing is written.\n",
    )  # fmt: skip
    assert study.with_suffix(".nc").read_bytes() == b"of yesterday"
