"""What a fresh Python loads, and how processes end: each case is a process of its own."""

import multiprocessing
import os
import subprocess
import sys
from multiprocessing.connection import Connection
from pathlib import Path

import psutil
import pytest

from vibrafeed.app.cli import COMMANDS
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


# As on a worker: functions found by their names, and run.
WORK = """
import importlib, pathlib, sys
directory = pathlib.Path("data")
run = importlib.import_module("vibrafeed.app.jobs.work")
from vibrafeed.app.jobs.store import Store
from vibrafeed.core.code_version import code_version
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.plan.pieces import cells_of_piece
study = {"kind": "sweep", "scene": "rectangle-on-plane", "outputs": ["throw_number"],
         "parameters": {"frequency": 50, "amplitude": 0.001, "beta": [0, 30, 60]}}
store = Store(directory)
prepared = prepare_content(study)
key, _ = store.add(prepared.study)
cells = cells_of_piece(prepared, 1.0)
run.compute_block(str(directory), key, "sweep", cells, 0, code_version())
run.write_result(str(directory), key, "sweep", cells, 0.0)
assert store.manifest(key) is not None
import vibrafeed.app.web.calculations  # what it loads to read studies
import vibrafeed.app.jobs.accuracy  # what it loads for a report of accuracy
print(*sorted(sys.modules))
"""
SERVICE = """
import os, sys
import vibrafeed.app.main
assert os.listdir() == []  # importing builds nothing
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.execution import AnyStudy, MeasuredStudy
vibrafeed.app.main.create_app(Settings(data_directory="data"))
# The schema of all studies is as much work as all else, and only the document shows it.
assert not AnyStudy.__pydantic_complete__ and not MeasuredStudy.__pydantic_complete__
print(*sorted(sys.modules))
"""
CONSOLE = (
    "fastapi", "starlette", "uvicorn", "prometheus_client", "typer", "rich", "structlog",
    "sqlalchemy", "vibrafeed.app.cli", "vibrafeed.app.main", "vibrafeed.app.web.routes",
)  # fmt: skip
AT_ONCE = """
import sys
import threading
from vibrafeed.core.intake import parse_study

sys.setswitchinterval(1e-6)
point = {"frequency": 50, "amplitude": 1e-4, "friction": 0.3}
plane = {"scene": "rectangle-on-plane", "parameters": {**point, "beta": [10, 20, 30]}}
studies = [
    {"kind": "simulate", **plane},
    {"kind": "sweep", "outputs": ["throw_number"], **plane},
    {"kind": "sweep", "outputs": ["acceleration_x"], **plane,
     "reduce": {"over": ["beta"], "statistics": ["max"]}},
    {"kind": "optimise", "scene": "rectangle-on-track", "parameters": point,
     "criterion": {"kind": "maximise", "output": "acceleration_x"}},
]
barrier, read = threading.Barrier(12), []

def go(content):
    barrier.wait()
    read.append(parse_study(content).kind)

threads = [threading.Thread(target=go, args=(studies[k % 4],)) for k in range(12)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(*sorted(read))
"""
HEAVY = {
    "dask", "distributed", "fastapi", "h5netcdf", "h5py", "matplotlib", "netCDF4", "numba", "numpy",
    "openpyxl", "pandas", "pint", "psutil", "pydantic", "rich", "scipy", "sqlalchemy", "tomlkit",
    "uvicorn", "xarray", "xlsxwriter", "zarr",
}  # fmt: skip
READING = {"numpy", "psutil", "pydantic", "scipy"}
"""What a study is read and planned with; of scipy the names alone are loaded."""
HELP = [[name, "--help"] for name in COMMANDS]
HELP += [["key", name, "--help"] for name in ("add", "list", "withdraw", "audit")]
LIGHT = [
    ["scenes"], ["scenes", "rectangle-on-track"], ["scenes", "--schema"],
    ["scenes", "rectangle-on-track", "--method", "reference"], ["run", "fig-5-1.toml", "--dry-run"],
]  # fmt: skip
CALLS = """
import os, sys
from vibrafeed.app.cli import main
out, sys.stdout = sys.stdout, open(os.devnull, "w")
for words in {}:
    sys.argv = ["vibrafeed", *words]
    try:
        main()
    except SystemExit as end:
        assert not end.code, (words, end.code)
print(*sys.modules, file=out)
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


@pytest.mark.parametrize(
    ("code", "there", "absent"),
    [
        (WORK, "vibrafeed.app.jobs.store", CONSOLE),
        (SERVICE, "fastapi", ("opentelemetry.sdk", "opentelemetry.exporter", "distributed")),
    ],
)
def test_what_is_loaded(tmp_path, code, there, absent):
    loaded = told(code, tmp_path)
    assert there in loaded
    assert [name for name in loaded if name.startswith(absent)] == []


@pytest.mark.parametrize(
    ("calls", "allowed"),
    [
        ([["--help"], *HELP], set()),
        (LIGHT, READING),
        ([["run", "fig-5-1.toml"]], READING | {"netCDF4"}),
        ([["run", "nut.toml"]], READING | {"netCDF4", "numba"}),
    ],
    ids=["help", "light", "closed forms", "motion"],
)
def test_commands_load_what_they_need(calls, allowed, tmp_path):
    """`benchmarks/start_up.py` measures the time."""
    for name in ("figures/fig-5-1", "nut"):
        study = ROOT / "configs" / f"{name}.toml"
        (tmp_path / study.name).write_bytes(study.read_bytes())
    modules = set(told(CALLS.format(calls), tmp_path))
    assert HEAVY & modules <= allowed
    if not allowed:
        assert {f"vibrafeed.app.cli.{name}" for name in COMMANDS} <= modules
        assert not any(name.startswith("vibrafeed.core.study") for name in modules)


def test_threads_may_read_their_first_studies_at_once(tmp_path):
    """Models of studies are built when they are first used: by one thread or by many at once."""
    assert told(AT_ONCE, tmp_path) == 3 * ["optimise"] + 3 * ["simulate"] + 6 * ["sweep"]
