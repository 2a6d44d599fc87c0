"""What a picture draws is what its title says, over random sweeps and simulations.

A cell is read off the picture as a reader would: the output from the name, values from the line
below the name and from the axes with their units. It is then looked up in the result.
"""

import re

import numpy as np
import pytest
import xarray
from matplotlib.collections import QuadMesh
from matplotlib.colors import to_rgb
from matplotlib.legend import Legend

from night import count
from pictures import subtitle
from random_studies import KINDS, random_study, shipped
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.style import name_in_words, words
from vibrafeed.core.quantities import QUANTITIES, REGIMES

STUDIES = count(4, 75, "VIBRAFEED_PICTURES")  # of a kind
OTHERS = ("Motion of the part", "Trajectory of the part", "A row of")
POINTS = 3  # that are read off each picture
# Coordinates go to the units of trade, and values to theirs: some units in the last place.
ROUNDING = 1e-9
AS_THEY_ARE = (
    "1", "", "°", "Hz", "kg", "m", "s", "m/s", "m/s²", "rad/s", "rad/s²", "N", "J", "N s", "N m",
    "W", "1/kg", "J/kg", "1/s", "m²", "kg m²", "kg m²/s", "N m s", "Pa", "m²/s²", "rad",
    "parts/min",
)  # fmt: skip
FACTORS = {"g": 1e-3, "%": 0.01, "1/min": 1 / 60}
PREFIXES = {"m": 1e-3, "µ": 1e-6, "k": 1e3, "n": 1e-9, "M": 1e6}
FACT = re.compile(r"(.+?) (\N{MINUS SIGN}?[\d.]+(?:e[+\N{MINUS SIGN}-]?\d+)?)(.*)$")
NAMES = {regime.value: name for name, regime in REGIMES.items()}


def unit_in(label: str) -> float:
    """Return the unit that a label ends with, in that of studies: SI, and degrees."""
    match = re.search(r"\(([^()]*)\)$", label)
    unit = match[1] if match else "1"
    return 1.0 if unit in AS_THEY_ARE else FACTORS.get(unit) or PREFIXES[unit[0]]


def held_in(figure, dataset: xarray.Dataset) -> dict[str, float]:
    """Return the values of axes that the line below the name says."""
    named = {name_in_words(str(name)): str(name) for name in dataset.dims}
    held = {}
    for fact in subtitle(figure).split("\n")[0].split(" \N{MIDDLE DOT} "):
        match = FACT.match(fact)
        if match and match[1] in named:
            number = float(match[2].replace("\N{MINUS SIGN}", "-"))
            held[named[match[1]]] = number * unit_in(f"({match[3].strip() or '1'})")
    return held


def axis_of(label: str, dataset: xarray.Dataset) -> str:
    """Return the axis of a study that an axis of a picture names."""
    labels = {str(dataset[name].attrs.get("long_name")): str(name) for name in dataset.dims}
    found = [text for text in labels if label.startswith(text)]
    return labels[max(found, key=len)] if found else ""


def cells_of(dataset: xarray.Dataset, output: str, held: dict[str, float]) -> xarray.DataArray:
    """Return an output where the axes have the values that are told; none may be left untold."""
    own = dataset[output]
    told = {name: value for name, value in held.items() if name in own.dims}
    return own.sel(told, method="nearest").squeeze(drop=True)


def check_line(axes, cells: xarray.DataArray, across: str, random) -> int:
    """Compare points of the curves of a picture with one curve."""
    checked = 0
    assert cells.dims in ((across,), ())
    for line in axes.lines:
        x, y = (np.asarray(data, dtype=float) for data in line.get_data())
        if len(x) != cells.size or not np.isfinite(y).any():
            continue  # parts of one end between values
        k = int(random.choice(np.flatnonzero(np.isfinite(y))))
        place = x[k] * unit_in(axes.get_xlabel())
        cell = cells.sel({across: place}, method="nearest")
        assert place == pytest.approx(float(cell[across]), rel=ROUNDING, abs=1e-12)
        size = float(np.nanmax(np.abs(y)))
        value = float(cell) / unit_in(axes.get_ylabel())
        assert y[k] == pytest.approx(value, rel=ROUNDING, abs=ROUNDING * size)
        checked += 1
    return checked


def word(code: float, output: str) -> str:
    """Return what a cell of a map is called in its legend."""
    quantity = QUANTITIES.get(output)
    if quantity is None or not quantity.other_words:
        return words(NAMES[int(code)])
    if not np.isfinite(code):
        return "no value"
    return str(dict(quantity.words).get(round(code), quantity.other_words.format(round(code))))


def check_map(figure, axes, cells: xarray.DataArray, output: str, random) -> int:
    """Compare the colours of cells, by the legend, with what the cells hold."""
    mesh = next(one for one in axes.collections if isinstance(one, QuadMesh))
    colours = {
        text.get_text(): to_rgb(handle.get_facecolor())
        for one in figure.findobj(Legend)
        for handle, text in zip(one.legend_handles, one.get_texts(), strict=True)
        if hasattr(handle, "get_facecolor") and ", " in text.get_text()
    }
    codes = np.asarray(mesh.get_array())
    axis_names = [axis_of(label, cells) for label in (axes.get_ylabel(), axes.get_xlabel())]
    held = cells.sortby(axis_names).transpose(*axis_names).values
    for _ in range(POINTS):
        place = tuple(int(random.integers(size)) for size in codes.shape)
        seen = to_rgb(mesh.cmap(mesh.norm(codes[place]))[:3])
        texts = [text for text, colour in colours.items() if np.allclose(colour, seen, atol=0.01)]
        assert any(text.startswith(word(held[place], output)) for text in texts), texts
    return POINTS


def check(dataset: xarray.Dataset, figure, random) -> int:
    """Return how many places of a picture were compared."""
    title = figure.get_suptitle().replace("\n", " ")
    names = {str(one.attrs.get("long_name", key)): str(key)
             for key, one in dataset.data_vars.items()}  # fmt: skip
    output = "regime" if title == "Regimes" else names.get(title, "")
    axes = next((one for one in figure.axes if one.get_xlabel() or one.get_ylabel()), None)
    if title.startswith(OTHERS) or not output or axes is None:
        return 0
    across = axis_of(axes.get_xlabel(), dataset)
    cells = cells_of(dataset, output, held_in(figure, dataset))
    if any(isinstance(one, QuadMesh) for one in axes.collections) and cells.ndim == 2:
        return check_map(figure, axes, cells, output, random)
    if across and cells.ndim < 2:
        return check_line(axes, cells, across, random)
    return 0  # contours, and families of curves


@pytest.mark.parametrize("kind", ["sweep", "simulate"])
def test_what_is_drawn_is_what_the_title_says(kind):
    compared = 0
    for seed in range(STUDIES):
        random = np.random.default_rng([seed, KINDS.index(kind)])
        content = random_study(random, kind, shipped(kind))
        content.pop("reduce", None)
        dataset = tabulate(prepare_content(content)).to_xarray()
        if all(one.size == 1 for one in dataset.data_vars.values()):
            continue  # no picture
        try:
            compared += check(dataset, draw(dataset), random)
        except Exception as error:
            raise AssertionError(f"seed {seed}: {content.get('title')}") from error
    assert compared >= STUDIES // 2, "a test that compares nothing would prove nothing"
