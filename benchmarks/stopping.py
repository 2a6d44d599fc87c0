"""The time that a run takes to end after Ctrl-C, at random moments, and what it leaves behind.

``python -m benchmarks.stopping`` runs a simulation with nothing compiled, over a result of
yesterday, and sends Ctrl-C at ten moments drawn between 0.3 s and the time that a whole run takes.
It prints the seconds to the end of the program, its exit code, and what is left. The limit is 2 s.
The result of yesterday stays, or the whole new one replaces it. What was computed so far stands
beside it, marked as stopped, with the pieces that `--resume` goes on with.
"""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import xarray

from benchmarks.options import options
from vibrafeed.core.motion.result import STATUS

VIBRAFEED = Path(sys.executable).with_name("vibrafeed")
LIMIT = 2.0  # s
EARLIEST = 0.3  # s, before which Python itself has not started
STUDY = """
kind = "simulate"
scene = "rectangle-on-plane"
outputs = ["conveying_velocity"]

[parameters]
frequency = "50 Hz"
amplitude = { start = "0.05 mm", stop = "0.5 mm", num = 1000 }
beta = { start = 5, stop = 60, num = 1000 }
friction = 0.3
restitution = 0.1
"""
YESTERDAY = b"of yesterday"


def run(moment: float | None) -> tuple[float, int, str]:
    """Return the time from Ctrl-C to the end [s], the exit code, and what is left on disk.

    None sends no Ctrl-C, and counts the seconds of the whole run.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "study.toml").write_text(STUDY, encoding="utf-8")
        (folder / "study.nc").write_bytes(YESTERDAY)
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "compiled")}
        process = subprocess.Popen(
            [VIBRAFEED, "run", "--force", "study.toml"], cwd=folder, env=environment,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        started = time.perf_counter()
        if moment is not None:
            time.sleep(moment)
            started = time.perf_counter()
            process.send_signal(signal.SIGINT)
        code = process.wait()
        return time.perf_counter() - started, code, state(folder)


def state(folder: Path) -> str:
    """Return a word for what a stopped run left in its folder; raise if it is broken."""
    files = {path.name for path in folder.iterdir()} - {"compiled", "study.toml", "study.nc"}
    assert files <= {"study.partial.nc", ".study.nc.partial"}, files
    untouched = (folder / "study.nc").read_bytes() == YESTERDAY
    if "study.partial.nc" not in files:
        return "result untouched" if untouched else "result whole"
    assert untouched
    with xarray.open_dataset(folder / "study.partial.nc") as dataset:
        left = float((dataset.motion_status == STATUS["not_computed"]).mean())
    return f"result untouched, {1 - left:.0%} of the cells beside it"


if __name__ == "__main__":
    asked = options(__doc__, moments=10, seed=1)
    whole = run(None)[0]
    print(f"a whole run, compiling included: {whole:.1f} s")
    draw = random.Random(asked.seed)
    worst = 0.0
    for _ in range(asked.moments):
        moment = draw.uniform(EARLIEST, whole)
        seconds, code, left = run(moment)
        worst = max(worst, seconds)
        print(f"Ctrl-C after {moment:5.1f} s: ended {seconds:.2f} s later, code {code}, {left}")
    print(f"longest {worst:.2f} s (limit {LIMIT:g} s)")
