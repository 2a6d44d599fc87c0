"""From datasets, or their files, to pictures: one, or several datasets in one."""

import io
import reprlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import xarray
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from vibrafeed.core.dataset.files import whole
from vibrafeed.core.plots.looks import looks_of
from vibrafeed.core.plots.parts import finish, padded, set_log, value_range
from vibrafeed.core.plots.pictures import (
    GONE,
    PICTURES,
    PlotError,
    is_calibration,
    unreadable,
)
from vibrafeed.core.plots.selection import (
    Selection,
    in_letters,
    outputs_of,
    read_fixed,
    select,
    units_of,
)
from vibrafeed.core.plots.style import Options, Style, axis_label, long_name
from vibrafeed.core.quantities import letter_of
from vibrafeed.core.study.shown import ShownUnits
from vibrafeed.core.suggestions import suggestion

FORMATS: Mapping[str, dict[str, str | None]] = {  # with what files say of themselves
    ".png": {"Software": "vibrafeed"},
    ".svg": {"Creator": "vibrafeed", "Date": None},
    ".pdf": {"Creator": "vibrafeed", "CreationDate": None},
}
MOST = 7  # datasets of a picture
DASHES: tuple[Any, ...] = (
    "solid", (0, (6, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)), (0, (10, 3)),
    (0, (3, 1, 1, 1, 1, 1)), (0, (1, 3)),
)  # fmt: skip


def draw(
    dataset: xarray.Dataset | Sequence[xarray.Dataset],
    *,
    variable: str | None = None,
    axes: tuple[str, ...] | None = None,
    at: Mapping[str, float] | None = None,
    kind: str | None = None,
    title: str | None = None,
    units: Sequence[str] | str | None = None,
    nearest: bool = False,
    dark: bool = False,
    small: bool = False,
) -> Figure:
    """Return the picture of an output with regimes shaded, of the regimes, or of one motion.

    The options are those of `vibrafeed.plot`, which reads text with units. Of several datasets, up
    to seven, the same output is drawn over the same axis. The figure has a canvas of its own.

    Raises
    ------
    PlotError
        If the dataset does not hold what is asked for.

    Examples
    --------
    >>> from pathlib import Path
    >>> from vibrafeed.core.plots.drawing import draw
    >>> from vibrafeed.core.intake import load_study
    >>> from vibrafeed.core.kinds import run_study
    >>> dataset = run_study(load_study(Path("configs/figures/fig-5-1.toml")))
    >>> figure = draw(dataset, axes=("beta", "alpha"), kind="contour")
    """
    datasets = list(dataset) if isinstance(dataset, Sequence) else [dataset]
    if not datasets:
        raise PlotError("dataset", "no dataset is given", "Give one or more")
    for given in datasets:
        if not isinstance(given, xarray.Dataset):
            raise PlotError(
                "dataset",
                f"{reprlib.repr(given)} is not a dataset",
                "Give a dataset that `sweep` or `simulate` returned, or the path of a file",
            )
    first = datasets[0]
    axes = None if axes is None else tuple(map(letter_of, axes))
    options = Options(
        kind, variable, axes, in_letters(at or {}), nearest, title, Style(dark=dark, small=small),
        units_of(first, units),
    )  # fmt: skip
    if kind is not None and kind not in PICTURES:
        raise PlotError(
            "kind", f"'{kind[:40]}' is unknown", GONE.get(kind) or suggestion(kind, PICTURES)
        )
    if nearest and not at:
        raise PlotError(
            "nearest", "nearest has no effect without at", "Give at, or leave nearest out"
        )
    if len(datasets) > 1:
        if kind not in (None, "line"):
            raise PlotError(
                "kind",
                "several datasets in one picture can only be drawn as lines",
                "Leave the kind out, or draw each by itself",
            )
        return _draw_together(datasets, options)
    if kind is None:
        candidates = (replace(options, kind=name, is_natural=True) for name in PICTURES)
        options = next(
            given for given in candidates if PICTURES[str(given.kind)].fits(first, given)
        )
    elif is_calibration(first):  # whatever is asked for: its module says what there is
        return PICTURES["posterior"].draw(first, options)
    return PICTURES[str(options.kind)].draw(first, options)


def _draw_together(datasets: Sequence[xarray.Dataset], options: Options) -> Figure:
    """Return the picture of one output of several datasets, over the same axis."""
    style = options.style
    if len(datasets) > MOST:
        raise PlotError(
            "dataset",
            f"{len(datasets)} datasets are too many for one picture, at most {MOST} are allowed",
            "Leave some out",
        )
    selections = _selections(datasets, options)
    labels, common = _labels(datasets, selections)
    figure = style.sheet()
    sheet = figure.add_subplot()
    has_invalid = [
        _add_line(sheet, selection, colour, dashes, style)
        for selection, colour, dashes in zip(selections, style.series, DASHES, strict=False)
    ]
    first = selections[0]
    limits = value_range(np.concatenate([selection.values for selection in selections]))
    if limits is not None:
        sheet.set_ylim(*padded(*limits))
        if limits[0] < 0 < limits[1]:
            sheet.axhline(0.0, color=style.ink, linewidth=0.7, zorder=1)
    positions = np.concatenate([selection.axes[0].values for selection in selections])
    sheet.set_xlim(positions.min(), positions.max())
    if all(selection.axes[0].is_log for selection in selections):
        set_log(sheet.xaxis, first.axes[0].values)
    sheet.set(xlabel=first.axes[0].label, ylabel=axis_label(first.variable, first.unit))
    style.add_grid(sheet)
    entries = [
        Line2D([], [], color=colour, linestyle=dashes, linewidth=2.0, label=label)
        for colour, dashes, label in zip(style.series, DASHES, labels, strict=False)
    ]
    titles = dict.fromkeys(str(dataset.attrs.get("title", "")) for dataset in datasets)
    return finish(
        figure, sheet, style, name=options.title or long_name(first.variable), facts=common,
        source="; ".join(filter(None, titles)), entries=entries,
        note="Pale: values there do not describe a real part" if any(has_invalid) else "",
    )  # fmt: skip


def _selections(datasets: Sequence[xarray.Dataset], options: Options) -> list[Selection]:
    """Return the slice of each dataset, all in the same unit."""
    for dataset in datasets:
        if "regime" not in dataset.data_vars or "scene" not in dataset.attrs:
            raise PlotError(
                "dataset",
                f"{_name(dataset)} is not a result of vibrafeed",
                "Give files that `vibrafeed run` wrote",
            )
    output = _output(datasets, options.variable)
    axis = _axis(datasets, output, options.axes)
    at, dimensions = options.at, {str(name) for dataset in datasets for name in dataset.dims}
    refused_later = {name for name in at if name not in dimensions or name == axis}  # by `select`

    def select_all(units: ShownUnits) -> list[Selection]:
        return [
            select(
                dataset, output, (axis,),
                {
                    name: value for name, value in at.items()
                    if name in dataset.dims or name in refused_later
                },
                "line", units, nearest=options.nearest,
            )
            for dataset in datasets
        ]  # fmt: skip

    units = options.units
    selections = select_all(units)
    if len({selection.unit for selection in selections}) > 1:
        # Each has its unit by its own values: take the one that suits the largest of all.
        largest = max(float(np.nanmax(np.abs(selection.variable))) for selection in selections)
        file_unit = str(selections[0].variable.attrs.get("units", "1"))
        selections = select_all(
            ShownUnits(units.system, {**units.wanted, file_unit: units.of(file_unit, largest)})
        )
    return selections


def _add_line(sheet: Axes, selection: Selection, colour: str, dashes: Any, style: Style) -> bool:
    """Draw a curve, pale where its values are not valid; True if there are such."""
    x, values = selection.axes[0].values, selection.values
    valid = np.ones(values.shape, dtype=bool)
    if not selection.categories:
        looks = looks_of(selection.regime, selection.regimes, style, exact=selection.exact)
        valid = np.isin(selection.regimes, [look.value for look in looks if look.valid])
    if not valid.all():
        sheet.plot(x, values, color=colour, linestyle=dashes, linewidth=1.6, alpha=0.35)
    sheet.plot(
        x, np.where(valid, values, np.nan), color=colour, linestyle=dashes,
        linewidth=style.width(2.0), marker="o" if x.size < 3 else "", zorder=3,
    )  # fmt: skip
    return not valid.all()


def _output(datasets: Sequence[xarray.Dataset], variable: str | None) -> str:
    """Return the output to draw, by default the first that all datasets have."""
    shared = [  # what has several values, to compare them by
        name
        for name in outputs_of(datasets[0])
        if all(name in dataset.data_vars and dataset[name].size > 1 for dataset in datasets)
    ]
    for dataset in datasets if variable is not None else ():
        if variable not in dataset.data_vars:
            raise PlotError(
                "variable",
                f"{_name(dataset)} has no output '{str(variable)[:40]}'",
                "They share " + _listed(shared),
            )
    if variable is None and not shared:
        listed = "; ".join(
            f"{_name(dataset)} has {_listed(outputs_of(dataset))}" for dataset in datasets
        )
        raise PlotError(
            "variable",
            f"the result files have no output in common: {listed}",
            "Draw each by itself",
        )
    return shared[0] if variable is None else variable


def _axis(datasets: Sequence[xarray.Dataset], output: str, axes: tuple[str, ...] | None) -> str:
    """Return the axis to draw over, by default the longest that all datasets have."""
    if axes is not None and len(axes) != 1:
        raise PlotError(
            "axes",
            "several results in one picture need exactly one axis",
            "Name one axis, such as amplitude",
        )
    ranged = [
        [
            str(dim)
            for dim in dataset[output].dims
            if dataset.sizes[dim] > 1 and dim in dataset.coords
        ]
        for dataset in datasets
    ]
    shared = [name for name in ranged[0] if all(name in other for other in ranged)]
    if axes is not None and axes[0] not in shared:
        raise PlotError(
            "axes",
            f"{output} is not ranged over '{axes[0][:40]}' in all files",
            "They share " + _listed(shared),
        )
    if not shared:
        listed = "; ".join(
            f"{_name(dataset)} has {_listed(names)}"
            for dataset, names in zip(datasets, ranged, strict=True)
        )
        raise PlotError("axes", f"{output} has no axis in common: {listed}", "Draw each by itself")
    return axes[0] if axes else max(shared, key=lambda name: datasets[0].sizes[name])


def _labels(
    datasets: Sequence[xarray.Dataset], selections: Sequence[Selection]
) -> tuple[list[str], list[str]]:
    """Return labels that tell the datasets of a picture apart, and the facts that they share."""
    facts = [list(dict.fromkeys(selection.fixed)) for selection in selections]
    common = [fact for fact in facts[0] if all(fact in other for other in facts)]
    parts = [[fact for fact in of_dataset if fact not in common] for of_dataset in facts]
    for key in ("scene", "variant", "method"):
        values = [str(dataset.attrs.get(key, "")) for dataset in datasets]
        if len(set(values)) > 1:
            parts = [
                [value, *of_dataset] if value else of_dataset
                for value, of_dataset in zip(values, parts, strict=True)
            ]
    return _distinct([", ".join(of_dataset) for of_dataset in parts], datasets), common


def _distinct(labels: list[str], datasets: Sequence[xarray.Dataset]) -> list[str]:
    if len(set(labels)) < len(labels) or not all(labels):
        pairs = zip(map(_name, datasets), labels, strict=True)
        labels = [": ".join(filter(None, pair)) for pair in pairs]
    if len(set(labels)) < len(labels):
        labels = [f"{label} ({i})" for i, label in enumerate(labels, 1)]
    return labels


def _name(dataset: xarray.Dataset) -> str:
    source = dataset.encoding.get("source")
    return Path(source).name if source else str(dataset.attrs.get("title", "dataset"))


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) or "nothing"


def draw_file(
    file: Path | Sequence[Path],
    targets: Sequence[Path],
    *,
    variable: str | None = None,
    axes: tuple[str, ...] | None = None,
    at: Mapping[str, str] | None = None,
    kind: str | None = None,
    slow: float | None = None,
    **look: Any,
) -> None:
    """Draw one or several result files of `vibrafeed run` and save the picture.

    Parameters
    ----------
    file : Path, or a sequence of them
        The NetCDF files.
    targets : sequence of Path
        The pictures, PNG, SVG, PDF or GIF (of a motion) by suffix; existing ones are replaced.
    at : mapping of str to str, optional
        Values of other dimensions as a user writes them, in the unit of the file.
    slow : float, optional
        Slow-motion factor of an animation.
    **look
        title, units, nearest, dark and small, as for `draw`.

    Raises
    ------
    PlotError, OSError
        If a file does not have what is asked for; if one cannot be read or written. No half picture
        is left behind.
    """
    files = [file] if isinstance(file, Path) else list(file)
    if kind == "animation" or any(target.suffix.lower() in (".gif", ".mp4") for target in targets):
        _refuse_of_animations(files, (variable, axes, at, look.pop("nearest", False)), kind)
        # Here, since it loads what draws motions.
        animate = import_module("vibrafeed.core.plots.animation").animate
        dataset = read(files[0])
        for target in targets:
            animate(dataset, target, slow=slow, **look)
        return
    if slow is not None:
        raise PlotError(
            "slow",
            "slow is given, but only an animation has a slow-motion factor",
            "Give the picture a name that ends in .gif, or leave out slow",
        )
    for target in targets:
        check_format(target)
    fixed = read_fixed(at or {})
    figure = draw(
        [read(path) for path in files], variable=variable, axes=axes, at=fixed, kind=kind, **look
    )
    for target in targets:
        save(figure, target)


def _refuse_of_animations(
    files: Sequence[Path], chosen: Sequence[object], kind: str | None
) -> None:
    if len(files) > 1:
        raise PlotError(
            "dataset",
            "an animation shows one result, but several files are given",
            "Give one result file",
        )
    if kind not in (None, "animation", "trajectory"):
        raise PlotError(
            "kind",
            f"a picture of kind {kind} cannot be an animation",
            "End the name in .png, .svg or .pdf, or leave the kind out",
        )
    if any(chosen):
        raise PlotError(
            "kind",
            "an animation shows the whole trajectory, without a variable, axes or fixed values",
            "Leave out variable, axes, at and nearest",
        )


def check_format(target: Path) -> None:
    """Raise `PlotError` if pictures cannot be saved in the format of a file name."""
    if target.suffix.lower() not in FORMATS:
        raise PlotError(
            "output",
            f"'{target.suffix}': unknown picture format",
            "End the name of the picture in .png, .svg or .pdf",
        )


def save(figure: Figure, target: Path) -> None:
    """Save a figure as PNG, SVG or PDF, by the suffix; a file appears only when complete."""
    suffix, picture = target.suffix.lower(), io.BytesIO()
    figure.savefig(picture, format=suffix[1:], dpi=150, metadata=FORMATS[suffix])
    with whole(target) as temporary:
        temporary.write_bytes(picture.getvalue())


def read(file: str | PathLike[str]) -> xarray.Dataset:
    """Return the dataset in a result file, loaded into memory.

    `PlotError` tells that it is not a NetCDF file, `OSError` that it cannot be read.
    """
    file = Path(file)
    with file.open("rb"):  # the system says why a file cannot be read; the library does not
        pass
    try:
        with xarray.open_dataset(file, engine="netcdf4", decode_times=False) as dataset:
            return dataset.load()
    except (OSError, ValueError) as error:
        raise unreadable("it is not a NetCDF file, or it is damaged") from error
