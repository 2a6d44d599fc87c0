"""Calculations that the service answers at once, as functions for the processes of its pool.

They take and return bytes, texts and numbers: a prepared study is not sent.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any, cast

import numpy as np
import orjson

from vibrafeed.app.jobs.large import check_length, is_large
from vibrafeed.app.jobs.manifest import MAX_JSON_VALUES
from vibrafeed.app.jobs.studies import identifier
from vibrafeed.app.jobs.work import Task, task_of
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.execution import ACCURACY, read_execution
from vibrafeed.core.dataset.document import to_document
from vibrafeed.core.dataset.table import regime_attributes
from vibrafeed.core.errors import LimitError, StoppedError
from vibrafeed.core.intake import prepare_content, read_json
from vibrafeed.core.intake.forms import write_as
from vibrafeed.core.kinds import is_whole, tabulate
from vibrafeed.core.plan.prepared import Prepared
from vibrafeed.core.quantities import QUANTITIES
from vibrafeed.core.sweep.slice import SliceCut, compute_slice, prepare_cut
from vibrafeed.core.watch import Watch

KEPT = 4
"""Number of prepared sweeps that a process keeps."""


def convert_study(body: bytes, to: str, base: str) -> str:
    """Return a study converted to another format.

    `body` is the study as JSON; `to` is the format; `base` is the service's address, for a command
    that posts the study.
    """
    content = cast(dict[str, Any], read_json(body))
    prepare_content(content)
    return write_as(to, content, base)


def execute_at_once(
    name: str, body: bytes, settings: Settings, max_cells: int | None, threads: int | None = None
) -> bytes | Task:
    """Return the JSON reply to a short study; its task if the study is to become a job.

    A study becomes a job if its expected time is too long for an immediate reply, or if it has not
    ended within `max_execution_seconds`.

    Parameters
    ----------
    name : str
        The process, such as `sweep`.
    body : bytes
        The execute request as JSON.
    settings : Settings
        The service's.
    max_cells : int or None
        The most cells that the API key may ask for; None without limit.
    threads : int, optional
        Threads among which cells are shared out; one a core if left out.
    """
    prepared, as_document = _read_study(name, body, settings, max_cells)
    is_small = prepared.stored * len(prepared.dims) <= MAX_JSON_VALUES
    if not is_small or prepared.seconds > settings.max_synchronous_seconds:
        return task_of(prepared, name, settings)
    deadline = time.monotonic() + settings.max_execution_seconds
    watch = Watch(deadline=deadline, threads=threads)
    try:
        table = tabulate(prepared, watch)
    except StoppedError:
        return task_of(prepared, name, settings)
    if not is_whole(table):
        return task_of(prepared, name, settings)
    content: dict[str, Any] = {
        "complete": True,
        "cells": prepared.cells,
        "warnings": [*prepared.questions],
        **to_document(table),
    }
    if as_document:
        content = {"dataset": {"value": content, "mediaType": "application/json"}}
    return orjson.dumps(content, option=orjson.OPT_SERIALIZE_NUMPY)


@lru_cache(maxsize=KEPT)
def _read_kept_sweep(text: str) -> Prepared:
    return prepare_content(orjson.loads(text))


def encode_slice_of(
    text: str,
    output: str,
    axes: Sequence[str],
    at: Mapping[str, str],
    most: int,
    form: str,
    threads: int | None = None,
) -> bytes:
    """Compute a slice of a sweep and return it encoded as `form`, ``json`` or ``binary``.

    `text` is the canonical study; `output`, `axes`, `at` and `most` choose the slice as in
    `vibrafeed.core.sweep.slice.prepare_cut`, whose errors it raises; `threads` is as in
    `compute_slice`.
    """
    cut = prepare_cut(_read_kept_sweep(text), output=output, axes=axes, at=at, most=most)
    return encode_slice(cut, form, threads)


def encode_slice(cut: SliceCut, form: str, threads: int | None = None) -> bytes:
    """Compute a slice of a sweep and return it as the body of a reply.

    `cut` is the slice, prepared but not computed; `form` is ``json``, or ``binary`` for a JSON
    header with raw values behind it.
    """
    piece = compute_slice(cut, threads)
    if form == "binary":
        return encode_binary(piece)
    return orjson.dumps(piece, option=orjson.OPT_SERIALIZE_NUMPY)


def encode_binary(piece: dict[str, Any]) -> bytes:
    """Return a slice in binary form: length of the header, JSON header, raw little-endian values.

    `piece` is the slice as `compute_slice` returns it; docs/api-reference.md describes the form.
    """
    values: list[memoryview] = []  # not copied before they are joined
    offset = 0

    def append(array: np.ndarray[Any, Any]) -> dict[str, Any]:
        """Append an array's bytes to the values; return its type, offset and shape."""
        nonlocal offset
        entry = {"dtype": array.dtype.newbyteorder("<").str, "offset": offset}
        raw = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
        values.append(raw.data)
        offset += raw.nbytes
        return {**entry, "shape": list(array.shape)}

    header = {**piece}
    header["axes"] = [{**axis, "values": append(axis["values"])} for axis in piece["axes"]]
    for name in ("values", "regime"):  # the single bytes last, so that floats are aligned
        header[name] = {"dims": piece[name]["dims"], "data": append(piece[name]["data"])}
    text = orjson.dumps(header)
    text += b" " * (-len(text) % 8)  # the values begin at a multiple of 8 bytes
    return b"".join((len(text).to_bytes(8, "little"), text, *values))


def read_task(name: str, body: bytes, settings: Settings, max_cells: int | None) -> Task:
    """Return the task of the study in a request body, read and priced.

    The arguments are those of `execute_at_once`. Raises `StudyError` or `LimitError` if it cannot
    be carried out.
    """
    prepared, _ = _read_study(name, body, settings, max_cells)
    return task_of(prepared, name, settings)


def _read_study(
    name: str, body: bytes, settings: Settings, max_cells: int | None
) -> tuple[Prepared, bool]:
    """Return the study of a request, within the limits, and whether to reply by a document."""
    study, as_document = read_execution(read_json(body), name)
    prepared = prepare_content(study)
    if name == ACCURACY:  # only some cells of the grid are computed
        prepared.check_limits(cells=settings.max_sweep_cells, bytes_=prepared.bytes)
    elif is_large(prepared, settings):
        check_length(prepared, settings)
    else:
        prepared.check_limits(cells=settings.max_cells, bytes_=settings.max_bytes)
    prepared.check_limits(cells=max_cells, bytes_=None)
    return prepared, as_document


def read_sweep(
    body: bytes, settings: Settings, max_cells: int | None
) -> tuple[str, str, dict[str, Any]]:
    """Return identifier, canonical text and description of the sweep in a request body.

    Raises `StudyError` or `LimitError` if it cannot be evaluated in slices.
    """
    sweep = prepare_content(read_json(body), "sweep")
    sweep.check_limits(cells=settings.max_sweep_cells, bytes_=sweep.bytes)
    for name, size in sweep.grid.shape.items():
        if size > settings.max_axis_values:
            fix = f"Give {name} {settings.max_axis_values:,} values or fewer"
            raise LimitError("values on one axis", size, settings.max_axis_values, fix)
    sweep.check_limits(cells=max_cells, bytes_=None)
    key = identifier(sweep.study)
    document = {**describe_sweep(key, sweep), "warnings": [*sweep.questions]}
    return key, sweep.study.canonical(), document


def describe_sweep(key: str, sweep: Prepared) -> dict[str, Any]:
    """Return the JSON description of a sweep: study, size, axes, outputs, links.

    `key` is its identifier.
    """
    equations = {equation.gives: equation for equation in sweep.plan.equations}
    verdicts = sweep.plan.verdicts
    labels = {}
    for verdict in verdicts:
        judged = verdict.outputs if len(verdicts) > 1 else ()
        labels[verdict.name] = regime_attributes(verdict.regimes, judged)["long_name"]
    return {
        "id": key,
        "study": sweep.study.content(),
        "scene": sweep.plan.scene.name,
        "variant": sweep.plan.variant,
        "validity": sweep.plan.scene.validity,
        "cells": sweep.cells,
        "bytes": sweep.bytes,
        "axes": [
            {"name": name, "unit": QUANTITIES[name].unit, "size": axis.size}
            for name, axis in sweep.grid.axes.items()
        ],
        "outputs": [
            {
                "name": name,
                "unit": sweep.units[name],
                "label": labels.get(name) or QUANTITIES[name].label,
                "dims": list(dims),
                "source": equations[name].source if name in equations else None,
            }
            for name, dims in sweep.dims.items()
        ],
        "regimes": list(sweep.plan.regimes),
        "links": {
            "self": f"/sweeps/{key}",
            **{name: f"/sweeps/{key}/{name}" for name in ("slice", "netcdf", "zarr")},
        },
    }
