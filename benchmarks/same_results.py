"""Whether two states of the code give the same results, byte for byte.

``python -m benchmarks.same_results OTHER`` carries out a fixed set of studies of all kinds with
this code and with that of another checkout of the repository, in folder OTHER, and compares every
array of every result. For changes of structure, which may not change a bit; where they do, the
largest difference is told. Both run on this machine: other processors may differ in the last
digits.

``python -m benchmarks.same_results --plain`` says by how much: it compares this code on this
processor with the same code where numpy, the BLAS and numba use nothing that a plain x86-64
processor does not have.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[1]
FIGURES = ("3-3", "3-15", "5-1", "5-9", "5-14", "5-21", "5-22", "5-26", "5-29")
LEFT_OUT = ("tumbling.toml", "measured-drive.toml")  # minutes; a recording beside it

PLAIN = {
    "NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR",
    "OPENBLAS_CORETYPE": "Prescott",
    "NUMBA_CPU_NAME": "generic",
}
"""Settings by which numpy 2.4, its BLAS and numba keep to what every x86-64 processor has."""

DRIVE = {"frequency": 50.0, "amplitude": [1e-4, 2e-4, 3e-4, 4e-4], "beta": [10.0, 25.0, 40.0]}


def _simulate(scene: str, method: str, **more: Any) -> dict[str, Any]:
    """Return a study of motion by a method."""
    settings = {n: more.pop(n) for n in ("max_periods",) if n in more}
    outputs = [
        "conveying_velocity", "conveying_velocity_error", "stick_fraction", "forward_fraction",
        "backward_fraction", "flight_fraction", "impacts_per_period", "period_multiple",
        "hop_height",
    ]  # fmt: skip
    return {
        "kind": "simulate", "scene": scene, "method": method, "outputs": outputs, **settings,
        "parameters": {**DRIVE, "friction": 0.3, "gamma": 1.0, **more},
    }  # fmt: skip


MOTIONS: dict[str, dict[str, Any]] = {
    "events": _simulate("rectangle-on-plane", "events", friction=[0.1, 0.3, 0.6]),
    "events, bounces": _simulate("rectangle-on-plane", "events", restitution=[0.0, 0.3, 0.7]),
    "events, static above kinetic": _simulate("cylinder-on-plane", "events")
    | {"parameters": {**DRIVE, "friction_static": 0.5, "friction_kinetic": 0.3, "gamma": -1.0}},
    "events aslant": _simulate("rectangle-on-plane", "events", alpha=20.0),
    "events, rolling": _simulate("cylinder-on-plane", "events", alpha=20.0),
    "events on the track": _simulate(
        "rectangle-on-track", "events", alpha=15.0, delta=10.0, radius=0.2, restitution=[0.0, 0.1]
    ),
    "reference": _simulate(
        "rectangle-on-plane", "reference", amplitude=[1e-4, 3e-4], beta=30.0, max_periods=20
    ),
    "reference on the track": _simulate(
        "rectangle-on-track", "reference", amplitude=[1e-4, 3e-4], beta=30.0, alpha=15.0,
        radius=0.2, max_periods=20,
    ),
}  # fmt: skip


def studies() -> dict[str, Any]:
    """Return the content of every study, by name."""
    paths = [*sorted((ROOT / "configs").glob("*.toml"))]
    paths = [path for path in paths if path.name not in LEFT_OUT]
    paths += [ROOT / "configs" / "figures" / f"fig-{number}.toml" for number in FIGURES]
    return {path.name: path.read_text() for path in paths} | dict(MOTIONS)


def compute(folder: Path) -> None:
    """Run every study with the imported code, and write its arrays."""
    from vibrafeed.core.kinds import tabulate

    try:
        from vibrafeed.core.intake import prepare_content, read_toml
    except ModuleNotFoundError:  # of a checkout in which that room was not yet built
        from vibrafeed.core.intake.forms import read_toml
        from vibrafeed.core.intake.studies import prepare_content

    contents: dict[str, Any] = json.loads((folder / "studies.json").read_text())
    for name, content in contents.items():
        read = read_toml(content) if isinstance(content, str) else content
        try:
            table = tabulate(prepare_content(read))
        except Exception as error:  # of another version, whose errors have names of their own
            np.savez(folder / f"{name}.npz", refused=np.array(str(error)[:200]))
            continue
        arrays = {n: v.values for n, v in (table.coordinates | table.variables).items()}
        np.savez(folder / f"{name}.npz", **arrays)


def run(tree: Path, folder: Path, settings: Mapping[str, str] = MappingProxyType({})) -> None:
    """Run every study with the code of another tree, in a process with settings."""
    folder.mkdir()
    (folder / "studies.json").write_text(json.dumps(studies()))
    code = (
        "import runpy, sys; sys.argv = ['same_results', '--compute', sys.argv[1]];"
        f"runpy.run_path({str(Path(__file__))!r}, run_name='__main__')"
    )
    environment = {**os.environ, "PYTHONPATH": str(tree), **settings}
    subprocess.run([sys.executable, "-c", code, str(folder)], cwd=tree, env=environment, check=True)


def differences(ours: Path, theirs: Path) -> dict[str, str]:
    """Return the differences in each study; empty if all bytes are equal."""
    found = {}
    for name in studies():
        with np.load(ours / f"{name}.npz") as one, np.load(theirs / f"{name}.npz") as other:
            if "refused" in other or "refused" in one:
                found[name] = f"refused: {other.get('refused', 'here')}"
                continue
            apart = sorted(set(one) ^ set(other))
            told = [f"in one only: {', '.join(apart)}"] if apart else []
            told += [_difference(key, one[key], other[key]) for key in one if key in other]
        if any(told):
            found[name] = "; ".join(filter(None, told))
    return found


def _difference(key: str, one: np.ndarray[Any, Any], other: np.ndarray[Any, Any]) -> str:
    """Return the difference of two arrays in words; empty if all bytes are equal."""
    if one.dtype != other.dtype or one.shape != other.shape:
        return f"{key}: {one.dtype}{one.shape} for {other.dtype}{other.shape}"
    if one.tobytes() == other.tobytes():
        return ""
    if one.dtype.kind not in "fi":
        return f"{key}: other values"
    a, b = one.astype(float), other.astype(float)
    nan = np.isnan(a) != np.isnan(b)
    apart = np.where(np.isnan(a) | np.isnan(b) | (a == b), 0.0, np.abs(a - b))
    size = np.nanmax(np.abs(b), initial=0.0)
    cells = int(((a != b) & ~(np.isnan(a) & np.isnan(b))).sum())
    return f"{key}: {cells} of {a.size} cells, at most {apart.max():.2g} of {size:.2g}" + (
        f", {int(nan.sum())} NaN in one only" if nan.any() else ""
    )


def main() -> int:
    """Compare two trees or processors; return 1 if any array differs."""
    if sys.argv[1] == "--compute":
        compute(Path(sys.argv[2]))
        return 0
    with tempfile.TemporaryDirectory() as name:
        ours, theirs = Path(name) / "ours", Path(name) / "theirs"
        run(ROOT, ours)
        if sys.argv[1] == "--plain":
            # Whatever was compiled for this processor stays out of it.
            run(ROOT, theirs, {**PLAIN, "NUMBA_CACHE_DIR": str(Path(name) / "compiled")})
        else:
            run(Path(sys.argv[1]).resolve(), theirs)
        found = differences(ours, theirs)
    print(f"{len(studies()) - len(found)} of {len(studies())} studies are the same to the byte")
    for study, told in found.items():
        print(f"  {study}: {told}")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
