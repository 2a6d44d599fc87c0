"""What a picture draws is what its title says, over random sweeps and simulations.

A cell is read off the picture as a reader would: the output from the name, values from the line
below the name and from the axes with their units. It is then computed by itself, and compared.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import xarray
from matplotlib.collections import QuadMesh
from matplotlib.colors import to_rgb
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from matplotlib.legend import Legend

from night import count
from pictures import subtitle
from random_studies import KINDS, Content, random_study, shipped
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
CHAOS = ("aperiodic", "unresolved", "runaway")


def result_of(content: Content) -> xarray.Dataset:
    return tabulate(prepare_content(content)).to_xarray()


def unit_in(label: str) -> str:
    """Return the unit that a label ends with, as units are written; 1 if there is none."""
    match = re.search(r"\(([^()]*)\)$", label)
    return match[1] if match else "1"


def number_in(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-"))


def in_studies(value: Any, unit: str) -> Any:
    """Return values in the unit of studies: SI, and degrees."""
    if unit in AS_THEY_ARE:
        return value
    return value * (FACTORS[unit] if unit in FACTORS else PREFIXES[unit[0]])


def held_in(figure: Figure, dataset: xarray.Dataset) -> dict[str, float]:
    """Return the values that the line below the name says."""
    named = {name_in_words(str(name)): str(name) for name in dataset.coords}
    held = {}
    for fact in subtitle(figure).split("\n")[0].split(" \N{MIDDLE DOT} "):
        match = re.match(r"(.+?) (\N{MINUS SIGN}?[\d.]+(?:e[+\N{MINUS SIGN}-]?\d+)?)(.*)$", fact)
        if match and match[1] in named and named[match[1]] in QUANTITIES:
            name, unit = named[match[1]], unit_in(f"({match[3].strip() or '1'})")
            held[name] = in_studies(number_in(match[2]), unit)
    return held


def one_cell(content: Content, values: dict[str, float]) -> xarray.Dataset:
    """Return the result of one cell of a study, computed by itself."""
    parameters = content["parameters"] | values
    return result_of(content | {"parameters": parameters})


def snapped(dataset: xarray.Dataset, name: str, drawn: float) -> float:
    """Return the value of a coordinate that is drawn at a place, to the last bit."""
    values = np.atleast_1d(dataset[name].values)
    nearest = float(values[np.abs(values - drawn).argmin()])
    assert drawn == pytest.approx(nearest, rel=ROUNDING, abs=ROUNDING * np.abs(values).max())
    return nearest


class Reader:
    """Reads cells off one picture, and computes them by themselves."""

    def __init__(self, content: Content, dataset: xarray.Dataset, figure: Figure):
        self.content, self.dataset, self.figure = content, dataset, figure
        self.axes = next((axes for axes in figure.axes if axes.get_xlabel() or axes.get_ylabel()),
                         figure.axes[0])  # fmt: skip
        title = figure.get_suptitle().replace("\n", " ")
        names = {str(one.attrs.get("long_name", key)): str(key)
                 for key, one in dataset.data_vars.items()}  # fmt: skip
        self.output = names.get(title, "")
        ranged = {str(name) for name in dataset.dims if dataset.sizes[name] > 1}
        self.held = {n: v for n, v in held_in(figure, dataset).items() if n in ranged}
        # A title that leaves out what is held of an axis would leave the reader in the dark.
        labels = {str(dataset[name].attrs.get("long_name")): name for name in dataset.dims}
        self.across = self._axis(self.axes.get_xlabel(), labels)
        self.up = self._axis(self.axes.get_ylabel(), labels)

    def _axis(self, label: str, labels: dict[str, Any]) -> str:
        found = [text for text in labels if label.startswith(text)]
        return str(labels[max(found, key=len)]) if found else ""

    def is_of_all_values(self, x: np.ndarray) -> bool:
        """True if a line has a point for each value across; parts of one end between values."""
        values = np.sort(np.atleast_1d(self.dataset[self.across].values))
        if x.shape != values.shape:
            return False
        drawn = np.sort(in_studies(x, unit_in(self.axes.get_xlabel())))
        return np.allclose(drawn, values, rtol=ROUNDING, atol=ROUNDING * np.abs(values).max())

    def at(self, name: str, label: str, drawn: float) -> float:
        return snapped(self.dataset, name, in_studies(drawn, unit_in(label)))

    def cell(self, x: float, y: float | None = None, **more: float) -> xarray.Dataset:
        place = {self.across: self.at(self.across, self.axes.get_xlabel(), x)}
        if y is not None:
            place[self.up] = self.at(self.up, self.axes.get_ylabel(), y)
        held = {name: snapped(self.dataset, name, value) for name, value in self.held.items()}
        own = self.dataset[self.output].dims if self.output else self.dataset["regime"].dims
        missing = set(map(str, own)) - {*place, *held, *more}
        assert not [name for name in missing if self.dataset.sizes[name] > 1], missing
        everything = held | place | more
        # What the output does not depend on may be anything: the first value will do.
        for name in set(map(str, self.dataset.dims)) - set(everything):
            if name in self.content["parameters"]:
                everything[name] = float(self.dataset[name].values[0])
        return one_cell(self.content, everything)

    def word(self, cell: xarray.Dataset) -> str:
        """Return what the colour of a cell stands for."""
        quantity = QUANTITIES.get(self.output)
        if quantity is None or not quantity.other_words:
            return words(regime_of(cell))
        if not np.isfinite(cell[self.output]):
            return "no value"
        value = round(float(cell[self.output]))
        return str(dict(quantity.words).get(value, quantity.other_words.format(value)))

    def value(self, cell: xarray.Dataset, unit: str) -> float:
        return float(cell[self.output]) / float(in_studies(1.0, unit))


def regime_of(cell: xarray.Dataset) -> str:
    value = int(cell["regime"])
    return next(name for name, flag in REGIMES.items() if flag.value == value)


def check_line(reader: Reader, random: np.random.Generator) -> int:
    """Compare points of curves; those of a family are told apart by their colours."""
    axes, checked = reader.axes, 0
    family = {}
    for legend in reader.figure.findobj(Legend):
        if legend.get_title().get_text():
            title = legend.get_title().get_text()
            second = next(
                (
                    str(n)
                    for n in reader.dataset.dims
                    if title.startswith(str(reader.dataset[n].attrs.get("long_name")))
                ),
                "",
            )
            for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
                if second and hasattr(handle, "get_color"):
                    family[to_rgb(handle.get_color())] = (second, text.get_text())
    for line in axes.lines:
        x, y = (np.asarray(data, dtype=float) for data in line.get_data())
        sound = np.flatnonzero(np.isfinite(y))
        if not sound.size or not reader.is_of_all_values(x):
            continue
        more = {}
        if family:
            if to_rgb(line.get_color()) not in family:
                continue
            second, text = family[to_rgb(line.get_color())]
            match = re.match(r"(\S+?)(?:\s*([^\d.].*))?$", text.replace("\N{NO-BREAK SPACE}", " "))
            value = number_in(match[1])
            unit = unit_in(f"({match[2] or '1'})")
            value = in_studies(value, unit)
            values = reader.dataset[second].values
            value = float(values[np.abs(values - value).argmin()])
            more = {second: value}
        k = int(random.choice(sound))
        cell = reader.cell(float(x[k]), **more)
        if regime_of(cell) in CHAOS:
            continue
        expected = reader.value(cell, unit_in(axes.get_ylabel()))
        size = float(np.nanmax(np.abs(y)))
        assert y[k] == pytest.approx(expected, rel=ROUNDING, abs=ROUNDING * size)
        checked += 1
        if checked == POINTS:
            break
    return checked


def check_contours(reader: Reader, random: np.random.Generator, unit: str) -> int:
    """Compare contour lines where they cross lines of the grid: there they are interpolated."""
    axes = reader.axes
    lines = [one for one in axes.collections if isinstance(one, QuadContourSet) and not one.filled
             and len(one.levels) and one.labelTexts]  # fmt: skip
    grid = [
        np.atleast_1d(reader.dataset[name].values) / in_studies(1.0, unit_in(label))
        for name, label in ((reader.across, axes.get_xlabel()), (reader.up, axes.get_ylabel()))
    ]
    corners = [
        (level, vertex) for one in lines
        for level, path in zip(one.levels, one.get_paths(), strict=True)
        for vertex in path.vertices
    ]  # fmt: skip
    checked = 0
    for k in random.permutation(len(corners))[: 4 * POINTS]:
        level, vertex = corners[k]
        for along, other in ((0, 1), (1, 0)):
            on = np.abs(grid[along] - vertex[along])
            if on.min() > ROUNDING * np.abs(grid[along]).max():
                continue
            fixed = grid[along][on.argmin()]
            ends = next(((a, b) for a, b in pairwise(np.sort(grid[other]))
                         if a < vertex[other] < b), None)  # fmt: skip
            if ends is None:
                continue
            places = [(fixed, end) if along == 0 else (end, fixed) for end in ends]
            cells = [reader.cell(*place) for place in places]
            if any(regime_of(cell) in CHAOS for cell in cells):
                continue
            low, high = (reader.value(cell, unit) for cell in cells)
            share = (vertex[other] - ends[0]) / (ends[1] - ends[0])
            tolerance = 1e-6 * max(abs(low), abs(high), abs(high - low))
            assert low + share * (high - low) == pytest.approx(level, abs=tolerance)
            checked += 1
            break
        if checked == POINTS:
            break
    return checked


def check_map(reader: Reader, random: np.random.Generator) -> int:
    """Compare the colours of cells, by the legend, with the regimes of the same cells."""
    mesh = next(one for one in reader.axes.collections if isinstance(one, QuadMesh))
    named = {}
    for legend in reader.figure.findobj(Legend):
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            if hasattr(handle, "get_facecolor") and ", " in text.get_text():
                named[text.get_text()] = to_rgb(handle.get_facecolor())
    codes = np.asarray(mesh.get_array())
    axes, checked = reader.axes, 0
    grid = [
        np.sort(np.atleast_1d(reader.dataset[name].values)) / in_studies(1.0, unit_in(label))
        for name, label in ((reader.across, axes.get_xlabel()), (reader.up, axes.get_ylabel()))
    ]
    for _ in range(POINTS):
        row, column = (int(random.integers(size)) for size in codes.shape)
        seen = to_rgb(mesh.cmap(mesh.norm(codes[row, column]))[:3])
        cell = reader.cell(float(grid[0][column]), float(grid[1][row]))
        texts = [text for text, colour in named.items() if np.allclose(colour, seen, atol=0.01)]
        assert any(text.startswith(reader.word(cell)) for text in texts), (texts, cell)
        checked += 1
    return checked


def check(reader: Reader, random: np.random.Generator) -> int:
    """Return how many places of a picture were compared."""
    title = reader.figure.get_suptitle()
    if title.startswith(OTHERS) or not reader.output or not reader.across:
        return 0
    if not reader.up:
        return check_line(reader, random)
    bars = [a for a in reader.figure.axes if a.get_label() == "<colorbar>"]
    meshes = [one for one in reader.axes.collections if isinstance(one, QuadMesh)]
    checked = check_map(reader, random) if meshes else 0
    if bars or meshes:
        legends = reader.figure.findobj(Legend)
        named = [text.get_text() for one in legends for text in one.get_texts()]
        signs = [text for text in named if text.startswith(("speed", "value"))]
        unit = unit_in(bars[0].get_ylabel() if bars else (signs or ["(1)"])[0])
        checked += check_contours(reader, random, unit)
    return checked


@pytest.mark.parametrize("kind", ["sweep", "simulate"])
def test_what_is_drawn_is_what_the_title_says(kind: str):
    compared = drawn = 0
    for seed in range(STUDIES):
        random = np.random.default_rng([seed, KINDS.index(kind)])
        content = random_study(random, kind, shipped(kind))
        content.pop("reduce", None)
        dataset = result_of(content)
        if all(one.size == 1 for one in dataset.data_vars.values()):
            continue  # no picture
        figure = draw(dataset)
        drawn += not figure.get_suptitle().startswith(OTHERS)
        try:
            compared += check(Reader(content, dataset, figure), random)
        except Exception as error:
            raise AssertionError(f"seed {seed}: {content.get('title')}") from error
    # Most pictures have something to read off; a test that compares nothing would prove nothing.
    assert compared >= drawn // 2
