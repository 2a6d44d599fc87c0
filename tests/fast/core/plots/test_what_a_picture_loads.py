"""A picture loads the module that draws it, and none of the others."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

import vibrafeed
from vibrafeed.core.plots.pictures import PICTURES, PlotError

CODE = """
import sys
from vibrafeed.core.plots.drawing import draw  # before xarray, whose accessor loads studies
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
draw(dataset)
print(*sys.modules)
"""


def test_a_contour_loads_no_other_picture_and_no_study():
    loaded = subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "vibrafeed.core.plots.maps" in loaded
    others = ("animation", "film", "landscape", "spreads", "trajectory")
    assert not {f"vibrafeed.core.plots.{name}" for name in others} & set(loaded)
    assert not {"vibrafeed.core.plan", "numba", "scipy.spatial", "scipy.optimize"} & set(loaded)


@pytest.mark.parametrize("given", [3, None, [3], {"a": 1}, True], ids=repr)
def test_what_is_no_dataset_is_told(given):
    with pytest.raises(PlotError, match=r"is not a dataset\. Give what"):
        vibrafeed.plot(given)


def test_the_pictures_that_python_tells_of_are_all_there_are():
    (words,) = re.findall(r"The name of a picture: (.*?);", vibrafeed.plot.__doc__, re.DOTALL)
    assert re.split(r",\s+|\s+or\s+", words) == list(PICTURES)
