"""The nut of the README: which way does it travel, and the picture that says so."""

from pathlib import Path

import numpy as np
import xarray
from PIL import Image

NUT = Path(__file__).parents[2] / "configs" / "nut.toml"


def test_the_nut(vibrafeed, tmp_path):
    said = vibrafeed("run", NUT, "-o", "nut.nc").stdout
    assert "direction: forwards 61 %, backwards 39 %" in said
    speed = xarray.load_dataset(tmp_path / "nut.nc", decode_times=False).conveying_velocity
    # "with a drive of 0.35 mm at 20 degrees it goes down, and at 45 degrees it goes up"
    down, up = speed.sel(amplitude=0.35e-3, method="nearest").sel(beta=[20, 45]).values
    assert down < 0 < up
    assert f"Fastest: {1000 * float(speed.max()):.4g} mm/s" in said

    vibrafeed("plot", "nut.nc", "-o", "nut.png")
    with Image.open(tmp_path / "nut.png") as picture:
        assert min(picture.size) > 500
        colours = np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)
    assert len(colours) > 100  # a map is there
