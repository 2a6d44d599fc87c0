"""What a fresh Python loads, and how processes end: each case is a process of its own."""

import multiprocessing
import os
import subprocess
import sys
from multiprocessing.connection import Connection
from pathlib import Path

import psutil
import pytest

from vibrafeed.core.plan.evaluate import share_out
from waiting import PATIENCE, wait_for

ROOT = Path(__file__).parents[2]
CONTOUR = """
import sys
from vibrafeed.core.plots.drawing import draw  # before xarray: its accessor loads studies
import numpy as np
import xarray
values = np.arange(144.0).reshape(12, 12)
dataset = xarray.Dataset(
    {
        "throw_number": (("amplitude", "beta"), values, {"units": "1", "long_name": "Throw"}),
        "regime": ((), 0, {"flag_values": [0], "flag_meanings": "rest"}),
    },
    coords={"beta": np.arange(12.0), "amplitude": np.arange(12.0)},
    attrs={"scene": "rectangle-on-plane"},
)
draw(dataset).savefig("contour.png")
print(*sys.modules)
"""
POOL = """
import multiprocessing, os, time
from concurrent.futures import ProcessPoolExecutor
from vibrafeed.core.system import end_with_parent
pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), end_with_parent)
print(pool.submit(os.getpid).result(), flush=True)
time.sleep(600)
"""
ACCESSOR = """
import sys, vibrafeed
print("xarray" in sys.modules)
first = vibrafeed.sweep(
    scene="rectangle-on-plane", outputs="throw_number", frequency=50, amplitude="0.1 mm", beta=30
)
print(first.vibrafeed.study.kind)
import xarray
first.to_netcdf("throw.nc")
print(xarray.open_dataset("throw.nc").vf.study.kind)
"""
STAND_IN = """
import sys, types
seen = []
xarray = types.ModuleType("xarray")  # a stand-in: the true one takes a second
xarray.Dataset = object
xarray.register_dataset_accessor = lambda name: seen.append(name) or (lambda accessor: accessor)
sys.modules["xarray"] = xarray
import vibrafeed
print(*sorted(seen))
"""


def told(code: str, folder: Path) -> list[str]:
    """Return the words that a program prints."""
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], cwd=folder, capture_output=True, check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr.decode()
    return done.stdout.decode().split()


def test_importing_vibrafeed_loads_no_library(tmp_path):
    code = "import sys; before = set(sys.modules); import vibrafeed"
    outside = {
        name.partition(".")[0]
        for name in told(f"{code}; print(*set(sys.modules) - before)", tmp_path)
    }
    assert outside - sys.stdlib_module_names == {"vibrafeed"}
    # What is slow of the standard's.
    assert not outside & {"typing", "pathlib", "dataclasses", "re"}


def test_the_accessor_comes_with_the_first_dataset_or_is_there_where_xarray_is(tmp_path):
    assert told(ACCESSOR, tmp_path) == ["False", "sweep", "sweep"]
    assert told(STAND_IN, tmp_path) == ["vf", "vibrafeed"]


def test_a_contour_loads_no_other_picture_and_no_study(tmp_path):
    loaded = set(told(CONTOUR, tmp_path))
    assert "vibrafeed.core.plots.maps" in loaded
    others = ("animation", "film", "landscape", "spreads", "trajectory")
    assert not {f"vibrafeed.core.plots.{name}" for name in others} & loaded
    heavy = {"vibrafeed.core.plan", "numba", "scipy.spatial", "scipy.optimize"}
    assert not {*heavy, "matplotlib.pyplot"} & loaded


def test_a_process_of_a_pool_ends_with_a_parent_that_is_killed():
    with subprocess.Popen([sys.executable, "-c", POOL], stdout=subprocess.PIPE) as parent:
        child = psutil.Process(int(parent.stdout.readline()))
        parent.kill()
    wait_for(lambda: not child.is_running() or child.status() == psutil.STATUS_ZOMBIE)


def _answer(pipe: Connection) -> None:
    done: list[int] = []
    share_out(done.append, range(4), 2)
    pipe.send(sorted(done))


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_fork_has_threads_of_its_own():
    share_out(lambda _: None, range(4), 2)
    here, there = multiprocessing.Pipe()
    child = multiprocessing.get_context("fork").Process(target=_answer, args=(there,))
    child.start()
    try:
        assert here.poll(PATIENCE)
        assert here.recv() == [0, 1, 2, 3]
    finally:
        child.kill()
        child.join()
