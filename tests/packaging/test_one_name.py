"""`import vibrafeed` finds its own packages: installed, editable and in a clone, beside any other.

Each environment is a fresh one that borrows the dependencies of this one.
"""

from __future__ import annotations

import ast
import contextlib
import json
import os
import runpy
import shutil
import subprocess
import sys
import urllib.request
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import vibrafeed
from benchmarks.serving import free_port
from night import first_by_day
from tools import tool
from waiting import PATIENCE, wait_for

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
rewritten = runpy.run_path(str(ROOT / "scripts" / "wheel.py"))["rewritten"]
POINT = {
    "scene": "rectangle-on-plane", "frequency": "50 Hz", "amplitude": "0.25 mm", "beta": 30,
    "friction": 0.5,
}  # fmt: skip
SWEEP = f"""
import vibrafeed
dataset = vibrafeed.sweep(outputs="acceleration_x", **{POINT})
print(dataset.acceleration_x.item(), vibrafeed.core.__file__)
"""


class Environment:
    """A Python environment of its own; `run` works in a folder that has a `core` and an `app`."""

    def __init__(self, folder: Path, path: str = ""):
        self.python = folder / "bin" / "python"
        self.folder = folder / "elsewhere"
        self.variables = {**os.environ, "PYTHONPATH": path}
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
        borrowed = [place for place in sys.path if place.endswith("site-packages")]
        self.packages = next(folder.glob("lib/python*/site-packages"))
        (self.packages / "borrowed.pth").write_text("\n".join(borrowed))
        for name in ("core", "app"):
            package = self.folder / name
            package.mkdir(parents=True)
            (package / "__init__.py").write_text("OWNER = 'the user'\n")

    def pip(self, *arguments: str | Path) -> None:
        """Install or remove distributions, without a network."""
        options = ["--quiet", "--disable-pip-version-check", "--python", self.python]
        subprocess.run([sys.executable, "-m", "pip", *options, *arguments], check=True)

    def install(self, *what: str | Path) -> None:
        self.pip("install", "--no-deps", "--no-index", "--no-build-isolation", *what)

    def run(self, *arguments: str, wrong: bool = False, home: Path | None = None) -> str:
        """Return what a Python command prints; what it says as it fails, if it has to."""
        done = subprocess.run(
            [self.python, *arguments], cwd=home or self.folder, env=self.variables,
            capture_output=True, text=True, timeout=PATIENCE, check=False,
        )  # fmt: skip
        assert bool(done.returncode) == wrong, done.stdout + done.stderr
        return done.stderr if wrong else done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a wheel, made from the source distribution."""
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "hatchling", "build", "--directory", folder, "--target"]
    subprocess.run([*build, "sdist"], cwd=ROOT, check=True, capture_output=True)
    (archive,) = folder.glob("*.tar.gz")
    shutil.unpack_archive(archive, folder, filter="data")
    (source,) = (path for path in folder.iterdir() if path.is_dir())
    subprocess.run([*build, "wheel"], cwd=source, check=True, capture_output=True)
    (made,) = folder.glob("*.whl")
    return made


@pytest.fixture(scope="module")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the wheel of another distribution, which has packages `core` and `app` too."""
    path = tmp_path_factory.mktemp("foreign") / "foreign-1-py3-none-any.whl"
    facts = "foreign-1.dist-info"
    files = {
        "core/__init__.py": "OWNER = 'foreign'\n",
        "app/__init__.py": "OWNER = 'foreign'\n",
        f"{facts}/METADATA": "Metadata-Version: 2.1\nName: foreign\nVersion: 1\n",
        f"{facts}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    files[f"{facts}/RECORD"] = "".join(f"{name},,\n" for name in (*files, f"{facts}/RECORD"))
    with zipfile.ZipFile(path, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return path


@pytest.fixture(scope="module", params=first_by_day(["clone", "editable"]))
def place(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, foreign: Path
) -> Environment:
    """Return an environment that has the repository, one way or another, beside the foreign one."""
    folder = tmp_path_factory.mktemp(request.param)
    if request.param == "clone":
        environment = Environment(folder, path=str(ROOT))
    else:
        environment = Environment(folder)
        environment.install("--editable", ROOT)
    environment.install(foreign)
    return environment


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory, wheel: Path, foreign: Path) -> Environment:
    """Return an environment that held the foreign one beside the wheel, and holds it no more."""
    environment = Environment(tmp_path_factory.mktemp("installed"))
    environment.install(wheel)
    environment.install(foreign)
    environment.pip("uninstall", "--yes", "foreign")
    return environment


def test_the_wheel_owns_one_name(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    top = {name.partition("/")[0] for name in names}
    assert top == {"vibrafeed", f"vibrafeed-{vibrafeed.__version__}.dist-info"}
    tracked = subprocess.run(
        [tool("git"), "ls-files", "vibrafeed", "core", "app"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    ).stdout.split()
    assert "vibrafeed/py.typed" in names
    inside = {name if name.startswith("vibrafeed/") else f"vibrafeed/{name}" for name in tracked}
    assert len(inside) > 100
    assert inside <= set(names)


def test_it_works_in_a_folder_with_packages_of_these_names(place):
    """So it does in a program that is called `app`, as long as that needs the library only."""
    value, file, refused = place.run(
        "-c",
        f"""
import app
{SWEEP}
assert app.OWNER == "the user"
from vibrafeed.__main__ import main
try:
    main()
except ImportError as error:
    print(app.__file__ in str(error))
""",
    ).split()
    assert float(value) == pytest.approx(
        vibrafeed.sweep(POINT, outputs="acceleration_x").acceleration_x.item()
    )
    assert Path(file).parents[1] == ROOT
    assert refused == "True"


def test_the_command_line_runs_there(place):
    assert "Usage: vibrafeed" in place.run("-m", "vibrafeed", "--help")


def test_other_packages_of_these_names_are_told_of_in_one_sentence(place):
    first = "import core; assert core.OWNER == 'the user'; import vibrafeed"
    sentence = place.run("-c", first, wrong=True).strip().splitlines()[-1]
    assert sentence.startswith("vibrafeed._packages.ForeignPackageError: vibrafeed has a package")
    assert str(place.folder / "core" / "__init__.py") in sentence
    assert "use vibrafeed in a process of its own" in sentence
    later = place.run("-c", "import vibrafeed, core.models", wrong=True)
    assert "No module named 'core.models': in this process 'core' is vibrafeed's own" in later
    assert "its name is 'core'" in place.run("-c", "import vibrafeed.core", wrong=True)


@pytest.mark.night
def test_what_another_distribution_took_away_is_not_missed(installed):
    assert not (installed.packages / "core").exists()
    study = {**POINT, "method": "reference"}  # which compiles nothing
    simulate = f"import vibrafeed; print(vibrafeed.simulate(**{study}).conveying_velocity.item())"
    speed = vibrafeed.simulate(study).conveying_velocity.item()
    assert float(installed.run("-c", simulate)) == pytest.approx(speed)
    assert "Usage: vibrafeed" in installed.run(
        str(installed.python.with_name("vibrafeed")), "--help"
    )


@pytest.mark.night
def test_a_wheel_lives_beside_a_core_and_an_app_of_the_user(installed):
    """In one process: a sweep, a motion, a picture and the service, and packages of these names."""
    lines = installed.run(
        "-c",
        f"""
import core, app
{SWEEP}
import warnings
import vibrafeed.core.motion
from vibrafeed.app.main import create_app
from vibrafeed.app.settings import Settings
from fastapi.testclient import TestClient
motion = vibrafeed.simulate(method="reference", **{POINT})
print(motion.conveying_velocity.item())
many = vibrafeed.sweep(outputs="acceleration_x", **{{**{POINT}, "beta": range(0, 41, 5)}})
print(vibrafeed.plot(many).get_suptitle())
with TestClient(create_app(Settings(data_directory="data")), base_url="http://127.0.0.1") as client:
    print(client.get("/healthz").status_code)
assert (core.OWNER, app.OWNER) == ("the user", "the user")
import sys
assert sys.modules["core"] is core and not hasattr(core, "study")
""",
    ).splitlines()
    value, file = lines[0].split()
    sweep = vibrafeed.sweep(POINT, outputs="acceleration_x")
    assert float(value) == pytest.approx(sweep.acceleration_x.item())
    assert Path(file) == installed.packages / "vibrafeed" / "core" / "__init__.py"
    speed = vibrafeed.simulate(POINT, method="reference").conveying_velocity.item()
    assert float(lines[1]) == pytest.approx(speed)
    assert lines[2:] == ["Acceleration along the track", "200"]


def test_no_import_of_the_wheel_needs_a_name_of_its_own_at_the_top(wheel, tmp_path):
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path)
    for file in (tmp_path / "vibrafeed").rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text())):
            names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                names = [str(node.module)]
            assert not {"core", "app"} & {name.partition(".")[0] for name in names}, file
        if file.name != "_packages.py":
            written = (ROOT / file.relative_to(tmp_path / "vibrafeed")).exists()
            source = ROOT / file.relative_to(tmp_path / ("vibrafeed" if written else ""))
            assert file.read_text().count("\n") == source.read_text().count("\n"), file


@pytest.mark.parametrize(
    ("line", "wanted"),
    [
        ("import core", "from vibrafeed import core"),
        ("from core.plan import plan", "from vibrafeed.core.plan import plan"),
        ("from app import main", "from vibrafeed.app import main"),
        ("import core.errors as wrong", "import vibrafeed.core.errors as wrong"),
        ("from cores import x", "from cores import x"),
        ("home = 'core.study'", "home = 'vibrafeed.core.study'"),
        ("word = 'core.nowhere'", "word = 'core.nowhere'"),
        ("code = 'from core.kinds import x'", "code = 'from vibrafeed.core.kinds import x'"),
        ("é = 'µ'; from core import plan", "é = 'µ'; from vibrafeed.core import plan"),
    ],
)
def test_what_is_rewritten(line, wanted):
    assert rewritten(line, ROOT) == wanted


def test_an_import_that_would_bind_another_name_is_refused():
    with pytest.raises(ValueError, match=r"give 'import core\.plan' a name"):
        rewritten("import core.plan", ROOT)


@pytest.mark.night
def test_studies_go_to_processes_however_they_are_started(installed):
    script = installed.folder / "processes.py"
    script.write_text(f"""
import multiprocessing
from concurrent.futures import ProcessPoolExecutor

import vibrafeed


def compute(study):
    return vibrafeed.sweep(study).acceleration_x.item()


if __name__ == "__main__":
    study = vibrafeed.study(kind="sweep", outputs="acceleration_x", **{POINT})
    for method in ("spawn", "forkserver"):
        context = multiprocessing.get_context(method)
        with ProcessPoolExecutor(1, mp_context=context) as pool:
            print(pool.submit(compute, study).result())
""")
    found = installed.run(str(script)).split()
    assert len(found) == 2
    assert found[0] == found[1]


def test_a_pickle_is_read_by_itself(installed):
    begin = "import pickle, vibrafeed; "
    made = f"study = vibrafeed.study(kind='simulate', **{POINT}); "
    installed.run("-c", begin + made + "pickle.dump(study, open('study.pickle', 'wb'))")
    read = "import pickle; study = pickle.load(open('study.pickle', 'rb')); "
    key = vibrafeed.study(kind="simulate", **POINT).key()
    assert installed.run("-c", read + "print(study.key())").strip() == key


@contextmanager
def running(environment: Environment, *arguments: str, **more: str) -> Iterator[None]:
    process = subprocess.Popen(
        [environment.python, *arguments], cwd=environment.folder,
        env={**environment.variables, **more}, stderr=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        yield
    finally:
        process.kill()
        process.wait(PATIENCE)


def ask(address: str, body: object = None) -> dict[str, object]:
    headers = {"Content-Type": "application/json", "Prefer": "respond-async"}
    data = None if body is None else json.dumps(body).encode()
    with urllib.request.urlopen(
        urllib.request.Request(address, data, headers), timeout=PATIENCE
    ) as reply:
        return json.load(reply)


def finished(port: int) -> dict[str, object]:
    """Return how a job ends that is posted to the service there."""
    address = f"http://127.0.0.1:{port}"
    parameters = {name: value for name, value in POINT.items() if name != "scene"}
    study = {"scene": POINT["scene"], "outputs": ["acceleration_x"], "parameters": parameters}

    def posted() -> dict[str, object] | None:
        with contextlib.suppress(OSError):
            return ask(f"{address}/processes/sweep/execution", study)
        return None

    number = wait_for(posted)["jobID"]

    def ended() -> dict[str, object] | None:
        job = ask(f"{address}/jobs/{number}")
        return None if job["status"] in ("accepted", "running") else job

    return wait_for(ended)


def test_its_own_workers_carry_out_a_job(installed, tmp_path):
    port = free_port()
    serve = ("-m", "vibrafeed", "serve", "--port", str(port))
    with running(installed, *serve, VIBRAFEED_DATA_DIRECTORY=str(tmp_path / "data")):
        assert finished(port)["status"] == "successful"


@pytest.mark.night
def test_workers_of_a_scheduler_elsewhere_carry_out_a_job(installed, tmp_path):
    """They are started in a folder with a `core` and an `app`, and know nothing of vibrafeed."""
    port, of_scheduler = free_port(), free_port()
    address = f"tcp://127.0.0.1:{of_scheduler}"
    scheduler = ("-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port",
                 str(of_scheduler), "--no-dashboard", "--no-show")  # fmt: skip
    worker = ("-m", "distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard",
              "--no-nanny", "--local-directory", str(tmp_path))  # fmt: skip
    settings = {
        "VIBRAFEED_DATA_DIRECTORY": str(tmp_path / "data"), "VIBRAFEED_SCHEDULER": address,
    }  # fmt: skip
    serve = ("-m", "vibrafeed", "serve", "--port", str(port))
    with (
        running(installed, *scheduler),
        running(installed, *worker),
        running(installed, *serve, **settings),
    ):
        assert finished(port)["status"] == "successful"
