"""What a picture draws is what its title says, over random studies of every kind.

A cell is read off the picture as a reader would: the output from the name, values from the line
below the name and from the axes with their units. It is then computed by itself, and compared. By
night there are 300 studies; VIBRAFEED_PICTURES says how many else.
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

from night import count, spread
from pictures import subtitle
from random_studies import KINDS, Content, is_reduced, random_study, shipped
from vibrafeed.core.errors import StudyError
from vibrafeed.core.intake import prepare_content
from vibrafeed.core.kinds import tabulate
from vibrafeed.core.plots.drawing import draw
from vibrafeed.core.plots.pictures import PlotError
from vibrafeed.core.plots.style import name_in_words, words
from vibrafeed.core.quantities import MOTION_STATUSES, QUANTITIES, REGIMES
from vibrafeed.core.study.distributions import quantiles, read_distribution

STUDIES = count(15, 300, "VIBRAFEED_PICTURES")
POINTS = 3  # that are read off each picture
SAMPLES = 2000
# Dvoretzky, Kiefer and Wolfowitz: 2000 samples are so far off with a probability of 1e-9.
FARTHEST = float(np.sqrt(np.log(2 / 1e-9) / (2 * SAMPLES)))
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


def without_unused(content: Content) -> Content:
    """Return a study without the parameters that only other outputs of its design need."""
    try:
        prepare_content(content)
    except StudyError as error:
        unused = {one.place for one in error.problems if "is not used by" in one.message}
        named = content["parameters"].items()
        kept = {name: value for name, value in named if f"parameters.{name}" not in unused}
        return content | {"parameters": kept}
    return content


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


def check_motion(reader: Reader) -> int:
    """Compare what the part has gained over a cycle with its mean velocity."""
    single = {k: v for k, v in reader.content.items() if k not in ("trajectory", "duration")}
    status = reader.dataset.get("motion_status")
    periodic = MOTION_STATUSES["periodic"].value
    if reader.content["scene"].endswith("isolated") or status is None or int(status) != periodic:
        return 0
    panel = next(a for a in reader.figure.axes if a.get_ylabel().startswith("Position on"))
    time = next(a for a in reader.figure.axes if a.get_xlabel().startswith("Time")).get_xlabel()
    curve = max(panel.lines, key=lambda line: len(line.get_xdata()))
    x, y = (np.asarray(data, dtype=float) for data in curve.get_data())
    seconds = float(np.ptp(x)) * {"ms": 1e-3, "s": 1.0}[unit_in(time)]
    metres = (y[-1] - y[0]) * {"mm": 1e-3, "µm": 1e-6, "m": 1.0}[unit_in(panel.get_ylabel())]
    outputs = [*single.get("outputs", ()), "conveying_velocity"]  # which use all of its parameters
    velocity = result_of(single | {"outputs": outputs})["conveying_velocity"]
    periods = seconds * float(np.asarray(reader.dataset["frequency"]))
    if abs(periods - round(periods)) > 1e-6 or periods < 0.5:
        return 0
    drive = float(np.max(np.abs(y))) / seconds
    assert metres / seconds == pytest.approx(float(velocity), rel=1e-6, abs=1e-6 * drive + 1e-12)
    return 1


def check_row(reader: Reader) -> int:
    """Compare the velocity over the last fifth of the time with those of the parts."""
    plain = {k: v for k, v in reader.content.items() if k != "trajectory"}
    outputs = ["slowest_velocity", "fastest_part_velocity", "feed_rate"]
    slowest, fastest = (float(result_of(plain | {"outputs": outputs})[n]) for n in outputs[:2])
    for line in reader.axes.lines:
        x, y = (np.asarray(data, dtype=float) for data in line.get_data())
        last = -len(x) // 5
        metres = (y[-1] - y[last]) * {"mm": 1e-3, "m": 1.0}[unit_in(reader.axes.get_ylabel())]
        seconds = (x[-1] - x[last]) * {"ms": 1e-3, "s": 1.0}[unit_in(reader.axes.get_xlabel())]
        # The last two of ten periods from rest. Where parts hop, what is left of the start decays
        # by a third in each period: 72 mm/s in the first became 24.2 of 23.8 in the tenth.
        assert 0.85 * slowest < metres / seconds < 1.15 * fastest
    return 1


def check_distribution(reader: Reader) -> int:
    """Compare the share of parts below each bar with samples, drawn and computed by themselves."""
    content = reader.content
    ((name, raw),) = content["uncertain"].items()
    shares = np.random.default_rng(5).uniform(1e-12, 1 - 1e-12, SAMPLES)
    distribution = read_distribution(name, raw, QUANTITIES[name])
    samples = np.unique(quantiles(name, distribution, shares))
    output = content["outputs"][0]
    held = {key: snapped(reader.dataset, key, value) for key, value in reader.held.items()}
    plain = {k: v for k, v in content.items() if k not in ("uncertain", "kind", "demands")}
    kind = "simulate" if output == "conveying_velocity" else "sweep"
    many = plain | {
        "kind": kind,
        "parameters": content["parameters"] | held | {name: samples.tolist()},
    }
    computed = result_of(many)
    valid = [flag.value for flag in REGIMES.values() if flag.valid]
    values = computed[output].values[np.isin(computed["regime"].values, valid)]
    bars = reader.axes.patches
    unit = unit_in(reader.axes.get_xlabel())
    edges = [in_studies(bar.get_x() + bar.get_width(), unit) for bar in bars]
    below = np.cumsum([bar.get_height() / 100 for bar in bars])
    assert below[-1] == pytest.approx(1.0, abs=1e-9)
    sound = values[np.isfinite(values)]
    for edge, share in zip(edges[:-1], below[:-1], strict=True):
        assert np.mean(sound <= edge) == pytest.approx(
            share, abs=FARTHEST * (SAMPLES / sound.size) ** 0.5 + 0.02
        )
    return 1


def check_objective(reader: Reader, random: np.random.Generator) -> int:
    """Compare a point of the objective along a single variable with a study at that point."""
    content, checked = reader.content, 0
    criterion = content["criterion"]
    if criterion["kind"] not in ("maximise", "minimise") or content.get("uncertain"):
        return 0
    dataset = reader.dataset
    names = [str(name).removeprefix("best_") for name in dataset.data_vars
             if str(name).startswith("best_")]  # fmt: skip
    best = {name: float(dataset[f"best_{name}"]) for name in names}
    if len(names) > 1:  # a map
        return 0
    motion = "motion_method" in dataset.attrs
    base = {"kind": "simulate" if motion else "sweep", "scene": content["scene"],
            "outputs": [criterion["output"]]}  # fmt: skip
    if not motion and "variant" in content:
        base["variant"] = content["variant"]
    for panel, name in zip([a for a in reader.figure.axes if a.get_visible()], names, strict=True):
        assert panel.get_xlabel().startswith(QUANTITIES[name].label)
        x, y = (np.asarray(data, dtype=float) for data in panel.lines[0].get_data())
        k = int(random.integers(len(x)))
        value = float(in_studies(x[k], unit_in(panel.get_xlabel())))
        point = best | {name: float(np.rint(value)) if QUANTITIES[name].count else value}
        parameters = {n: v for n, v in content["parameters"].items() if not isinstance(v, list)}
        cell = result_of(without_unused(base | {"parameters": parameters | point}))
        if regime_of(cell) in CHAOS:
            continue
        label = reader.figure.axes[0].get_ylabel()
        expected = float(cell[criterion["output"]]) / in_studies(1.0, unit_in(label))
        size = float(np.nanmax(np.abs(y)))
        assert y[k] == pytest.approx(expected, rel=1e-6, abs=1e-6 * size)
        checked += 1
    return checked


def check_front(reader: Reader) -> int:
    """Compare both axes of a front with the outputs of its designs."""
    criterion, axes = reader.content["criterion"], reader.axes
    curves = [line for line in axes.lines if line.get_linestyle() == "-" and len(line.get_xdata())]
    x = np.concatenate([np.asarray(line.get_xdata(), dtype=float) for line in curves])
    y = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in curves])
    for name, drawn, label in (
        (criterion["against"], x, axes.get_xlabel()), (criterion["output"], y, axes.get_ylabel()),
    ):  # fmt: skip
        values = reader.dataset[name].values.ravel()
        values = np.abs(values) if name == criterion["against"] else values
        seen = in_studies(drawn[np.isfinite(drawn)], unit_in(label))
        for value in seen[:: max(1, seen.size // POINTS)]:
            assert np.nanmin(np.abs(values - value)) <= ROUNDING * np.nanmax(np.abs(values))
    return int(x.size > 0)


def check_units(figure: Figure, dataset: xarray.Dataset) -> None:
    """Each axis with numbers has a name, and a unit where its quantity has one."""
    plain = {q.label for q in QUANTITIES.values() if q.unit in ("1", "")}
    for axes in figure.axes:
        for label, ticks in (
            (axes.get_xlabel(), axes.get_xticklabels()),
            (axes.get_ylabel(), axes.get_yticklabels()),
        ):  # fmt: skip
            numbers = [t for t in ticks if t.get_visible() and re.fullmatch(
                r"\N{MINUS SIGN}?[\d.]+", t.get_text())]  # fmt: skip
            if not label or not numbers or label.endswith(")") or label.endswith("$"):
                continue
            known = {str(v.attrs.get("long_name")) for v in dataset.variables.values()
                     if v.attrs.get("units", "1") in ("1", "")}  # fmt: skip
            assert any(label.startswith(name) for name in plain | known) or "robab" in label, label


def judge(content: Content, dataset: xarray.Dataset, figure: Figure, random: Any) -> int:
    """Return how many places of a picture were compared."""
    check_units(figure, dataset)
    reader = Reader(content, dataset, figure)
    title = figure.get_suptitle().replace("\n", " ")
    assert title
    if is_reduced(content):
        return 0
    if title.startswith("Distribution of"):
        return check_distribution(reader)
    if title.startswith(("Motion of the part", "Trajectory of the part")):
        return check_motion(reader)
    if title.startswith("A row of"):
        return check_row(reader)
    if title.startswith("Trade-off"):
        return check_front(reader)
    if title.startswith("Objective:"):
        return check_objective(reader, random)
    if content["kind"] in ("optimise", "sensitivity"):
        return check_copies(reader, random)
    if not reader.output or not reader.across:
        return 0
    if reader.up:
        bars = [a for a in figure.axes if a.get_label() == "<colorbar>"]
        meshes = [one for one in reader.axes.collections if isinstance(one, QuadMesh)]
        checked = check_map(reader, random) if meshes else 0
        if bars or meshes:
            named = [text.get_text() for one in figure.findobj(Legend) for text in one.get_texts()]
            signs = [text for text in named if text.startswith(("speed", "value"))]
            unit = unit_in(bars[0].get_ylabel() if bars else (signs or ["(1)"])[0])
            checked += check_contours(reader, random, unit)
        return checked
    return check_line(reader, random)


def check_copies(reader: Reader, random: np.random.Generator) -> int:
    """Compare curves of what a study looked for with its result, at the places of the title."""
    if not reader.output or not reader.across or reader.up:
        return 0
    axes = reader.axes
    held = {name: snapped(reader.dataset, name, value) for name, value in reader.held.items()}
    for line in axes.lines:
        x, y = (np.asarray(data, dtype=float) for data in line.get_data())
        sound = np.flatnonzero(np.isfinite(y))
        if len(x) == reader.dataset.sizes[reader.across] and sound.size:
            k = int(random.choice(sound))
            place = held | {reader.across: reader.at(reader.across, axes.get_xlabel(), x[k])}
            own = reader.dataset[reader.output]
            value = float(own.sel({n: v for n, v in place.items() if n in own.dims}).squeeze())
            unit = unit_in(axes.get_ylabel())
            base = reader.output.removeprefix("best_")
            if base in QUANTITIES:
                assert in_studies(y[k], unit) == pytest.approx(value, rel=ROUNDING)
                return 1
    return 0


@pytest.mark.parametrize("kind", spread(KINDS, 1))
def test_what_is_drawn_is_what_the_title_says(kind: str):
    compared = drawn = 0
    few = -(-STUDIES // (3 * len(KINDS))) if kind == "optimise" else -(-STUDIES // len(KINDS))
    for seed in range(few):
        random = np.random.default_rng([seed, KINDS.index(kind)])
        content = random_study(random, kind, shipped(kind))
        if is_reduced(content):
            content.pop("reduce")
        dataset = result_of(content)
        try:
            figure = draw(dataset)
        except PlotError:  # one value of each output
            if any(one.size > 1 for one in dataset.data_vars.values()):
                raise
            continue
        drawn += 1
        try:
            compared += judge(content, dataset, figure, random)
        except Exception as error:
            raise AssertionError(f"seed {seed}: {content.get('title')}") from error
    # Most pictures have something to read off; a test that compares nothing would prove nothing.
    assert compared >= drawn // 2
