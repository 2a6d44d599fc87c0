"""The example of a design tool against a real server that asks for a key."""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
import xarray

from access import KEY, lock
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from waiting import PATIENCE

TOOL = Path(__file__).parents[2] / "examples" / "design_tool.py"
BEST = {
    "kind": "optimise",
    "scene": "rectangle-on-track",
    "criterion": {"kind": "maximise", "output": "acceleration_x"},
    "variables": {
        "alpha": {"lower": "0 deg", "upper": "15 deg"},
        "beta": {"lower": "0 deg", "upper": "40 deg"},
    },
    "parameters": {"frequency": 60, "friction": 0.4, "gamma": 3, "delta": 15, "amplitude": 3e-4},
}


@pytest.fixture(scope="module")
def access(serve) -> list[str]:
    service = serve(workers=1)
    lock(service.address, service.folder / "data")
    return ["--address", service.address, "--key", KEY]


def test_it_finds_simulates_and_draws(access, tmp_path):
    picture = tmp_path / "new" / "design.png"
    command = [sys.executable, TOOL, *access, "--points", "16", "--output", picture]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.search(r"= ([\d.]+) at alpha = ([\d.]+) deg, beta = ([\d.]+) deg", done.stdout)
    expected = tabulate(prepare_content(BEST)).to_xarray()
    names = ("acceleration_x", "best_alpha", "best_beta")
    wanted = [float(expected[name]) for name in names]
    # As many digits as the tool prints.
    assert [float(text) for text in found.groups()] == pytest.approx(wanted, rel=1e-3, abs=0.006)
    assert "simulation successful, 100 %" in done.stdout
    with xarray.open_dataset(picture.with_suffix(".nc"), decode_times=False) as motion:
        assert motion.sizes == {"amplitude": 16}
        assert float(motion.beta) == pytest.approx(wanted[2], abs=1e-6)
        # The optimum keeps the floor, just so: from its amplitude on, 0.3 mm, the part hops. What
        # it does there is a matter of rounding.
        others = motion.where(abs(motion.amplitude - 3e-4) > 1e-6, drop=True)
        assert others.sizes == {"amplitude": 15}
        np.testing.assert_array_equal(others.flight_fraction > 0, others.amplitude > 3e-4)
    pixels = matplotlib.image.imread(picture)[..., :3]
    assert ((pixels == [1, 0, 0]).all(axis=-1)).sum() > 100  # the star, on the map and its legend


def test_what_the_service_refuses_is_told(access, monkeypatch):
    main = runpy.run_path(str(TOOL))["main"]

    def told(*arguments: str) -> str:
        """Return what Python says on the error stream as it ends with 1."""
        monkeypatch.setattr(sys, "argv", [str(TOOL), *arguments])
        with pytest.raises(SystemExit) as ended:
            main()
        assert isinstance(ended.value.code, str)
        return ended.value.code

    wrong = told(*access, "--scene", "nowhere")
    assert "'nowhere' is none of the scenes" in wrong
    assert "rectangle-on-track" in wrong
    assert "outputs: " in told(*access, "--outputs", "acceleration")
    assert "A key is needed" in told(*access[:2])
