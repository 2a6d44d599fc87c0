"""A run that is killed, or stopped while it compiles: nothing that was there is lost."""

import os
import re
import signal
import subprocess
import sys

import xarray

from commands import said, saved
from vibrafeed.core.intake import load_study
from vibrafeed.core.kinds import open_lazily, prepare
from waiting import PATIENCE, wait_for

STUDY = """
kind = "sweep"
scene = "rectangle-on-track"
outputs = ["transport_velocity"]

[parameters]
frequency = { start = "20 Hz", stop = "120 Hz", num = 40 }
amplitude = { start = "0.1 mm", stop = "1 mm", num = 20 }
beta = { start = 0, stop = 90, num = 40 }
friction = 0.3
radius = 0.8
distance = "0.2 mm"
"""
# The command with small blocks, each taking a while, so that there is time to kill it.
SLOW = """
import time
from vibrafeed.core.lazy import store
store.STORED_CELLS = 2000
plain = store.compute_block
def slow(*arguments):
    time.sleep(0.05)
    return plain(*arguments)
store.compute_block = slow
from vibrafeed.app.cli import app
app("run study.toml -o a.zarr".split())
"""


def test_a_killed_run_to_zarr_leaves_nothing_and_goes_on(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("vibrafeed.core.lazy.store.STORED_CELLS", 2000)
    study = saved(STUDY)
    partial = tmp_path / ".a.zarr.partial"
    with subprocess.Popen([sys.executable, "-c", SLOW]) as process:
        # The verdict is the last of a block to be written; other names are of files under way.
        wait_for(lambda: len([*partial.glob("regime/c/[0-9]*/[0-9]*/[0-9]")]) >= 2)
        process.kill()
    assert process.returncode == -signal.SIGKILL
    assert partial.exists()
    assert not (tmp_path / "a.zarr").exists()
    told = said("run study.toml -o a.zarr --resume")
    (done, of) = re.findall(r"continuing: (\d+) of (\d+) blocks were done before", told)[0]
    assert 0 < int(done) < int(of)
    assert not partial.exists()
    wanted = open_lazily(prepare(load_study(study)))
    with xarray.open_zarr("a.zarr") as dataset:
        xarray.testing.assert_equal(dataset.load(), wanted.load())


def test_ctrl_c_ends_a_run_that_compiles(tmp_path):
    study = saved(
        'kind = "simulate"\nscene = "rectangle-on-plane"\n[parameters]\nfrequency = "50 Hz"\n'
        'amplitude = ["0.2 mm", "0.25 mm", "0.3 mm"]\nbeta = 30\nfriction = 0.4\n',
        f"{tmp_path}/motion.toml",
    )
    study.with_suffix(".nc").write_bytes(b"of yesterday")
    process = subprocess.Popen(
        [sys.executable, "-m", "vibrafeed", "run", str(study), "--force"],
        env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "cache")},
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stderr is not None
    with process.stderr as stderr:
        assert "compiling once" in stderr.readline()
        process.send_signal(signal.SIGINT)
        told, status = stderr.read(), process.wait(PATIENCE)
    words = f"{study}: it was stopped before a cell was computed; nothing is written.\n"
    assert (status, told) == (130, words)
    assert study.with_suffix(".nc").read_bytes() == b"of yesterday"
