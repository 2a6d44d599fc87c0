"""Calculations that the service answers at once, as functions for the processes of its pool.

They take and return bytes, texts and numbers: a prepared study is not sent.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any, cast

import numpy as np
import orjson

from vibrafeed.app.jobs.large import check_length, is_large
from vibrafeed.app.jobs.manifest import MAX_JSON_VALUES
from vibrafeed.app.settings import Settings
from vibrafeed.app.web.execution import ACCURACY, Execution, read_execution
from vibrafeed.core.dataset.document import to_document
from vibrafeed.core.errors import StoppedError
from vibrafeed.core.intake import prepare_content, read_json
from vibrafeed.core.intake.forms import write_as
from vibrafeed.core.kinds import is_whole, tabulate
from vibrafeed.core.plan.prepared import Prepared, Price
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
    name: str, body: bytes, settings: Settings, most_cells: int | None, threads: int | None = None
) -> bytes | Price:
    """Return the JSON reply to a short study; its price if the study is to become a job.

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
    most_cells : int or None
        The most cells that the API key may ask for; None without limit.
    threads : int, optional
        Threads among which cells are shared out; one a core if left out.
    """
    asked, prepared = read_study(name, body, settings)
    prepared.check_limits(cells=most_cells, bytes_=None)
    few_values = prepared.stored * len(prepared.dims) <= MAX_JSON_VALUES
    if not few_values or prepared.seconds > settings.max_synchronous_seconds:
        return prepared.price
    deadline = time.monotonic() + settings.max_execution_seconds
    watch = Watch(deadline=deadline, threads=threads)
    try:
        table = tabulate(prepared, watch)
    except StoppedError:
        return prepared.price
    if not is_whole(table):
        return prepared.price
    content: dict[str, Any] = {
        "complete": True,
        "cells": prepared.cells,
        "warnings": [*prepared.questions],
        **to_document(table),
    }
    if asked.as_document:
        content = {"dataset": {"value": content, "mediaType": "application/json"}}
    return orjson.dumps(content, option=orjson.OPT_SERIALIZE_NUMPY)


@lru_cache(maxsize=KEPT)
def _sweep(text: str) -> Prepared:
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
    cut = prepare_cut(_sweep(text), output=output, axes=axes, at=at, most=most)
    return encode_slice(cut, form, threads)


def encode_slice(cut: SliceCut, form: str, threads: int | None = None) -> bytes:
    """Compute a slice of a sweep and return it as the body of a reply.

    `cut` is the slice, prepared but not computed; `form` is ``json``, or ``binary`` for a JSON
    header with raw values behind it.
    """
    piece = compute_slice(cut, threads)
    return encode_binary(piece) if form == "binary" else encode_json(piece)


def encode_json(piece: dict[str, Any]) -> bytes:
    """Return a slice as JSON; `piece` is the slice as `compute_slice` returns it."""
    regime = {**piece["regime"], "data": _digits(piece["regime"]["data"])}
    return orjson.dumps({**piece, "regime": regime}, option=orjson.OPT_SERIALIZE_NUMPY)


def _digits(codes: np.ndarray[Any, np.dtype[np.int8]]) -> Any:
    """Return the regimes of a slice as JSON if all have one digit, else as they are.

    `codes` has one or two axes. All digits are written at once, in a quarter of the time that
    orjson takes for one after another.
    """
    if codes.min() < 0 or codes.max() > 9:
        return codes
    text = np.full((*codes.shape[:-1], 2 * codes.shape[-1] + 2), ord(","), np.uint8)  # [0,0,0],
    text[..., 0], text[..., -2] = ord("["), ord("]")
    np.add(codes, ord("0"), out=text[..., 1:-2:2], casting="unsafe")
    rows = text.tobytes()[:-1]
    return orjson.Fragment(b"[%b]" % rows if codes.ndim > 1 else rows)


def encode_binary(piece: dict[str, Any]) -> bytes:
    """Return a slice in binary form: length of the header, JSON header, raw little-endian values.

    `piece` is the slice as `compute_slice` returns it; docs/api-reference.md describes the form.
    """
    values: list[memoryview] = []  # not copied before they are joined
    offset = 0

    def placed(array: np.ndarray[Any, Any]) -> dict[str, Any]:
        """Append an array's bytes to the values; return its type, offset and shape."""
        nonlocal offset
        place = {"dtype": array.dtype.newbyteorder("<").str, "offset": offset}
        raw = np.ascontiguousarray(array, array.dtype.newbyteorder("<"))
        values.append(raw.data)
        offset += raw.nbytes
        return {**place, "shape": list(array.shape)}

    header = {**piece}
    header["axes"] = [{**axis, "values": placed(axis["values"])} for axis in piece["axes"]]
    for name in ("values", "regime"):  # the single bytes last, so that floats are aligned
        header[name] = {"dims": piece[name]["dims"], "data": placed(piece[name]["data"])}
    text = orjson.dumps(header)
    text += b" " * (-len(text) % 8)
    return b"".join((len(text).to_bytes(8, "little"), text, *values))


def price_study(name: str, body: bytes, settings: Settings) -> Price | None:
    """Return the price of the study in a request body; None if its process does not compute it.

    Raises `StudyError` or `LimitError` if it cannot be carried out.
    """
    _, prepared = read_study(name, body, settings)
    return None if name == ACCURACY else prepared.price


def read_study(
    name: str, body: bytes, settings: Settings, price: Price | None = None
) -> tuple[Execution, Prepared]:
    """Read the body of an execute request, and return the request and its study.

    Parameters
    ----------
    name : str
        The process that the request is for, such as `sweep`.
    body : bytes
        The request as JSON.
    settings : Settings
        The limits of the service.
    price : Price, optional
        The price of the study where it is known.

    Raises
    ------
    StudyError
        If the request or the study is invalid.
    LimitError
        If the study is larger than the service allows.
    """
    asked = read_execution(read_json(body), name)
    prepared = replace(prepare_content(asked.study), known_price=price)
    if name == ACCURACY:  # it takes some cells of a grid
        prepared.check_limits(cells=settings.max_sweep_cells, bytes_=prepared.bytes)
    elif is_large(prepared, settings):
        check_length(prepared, settings)
    else:
        prepared.check_limits(cells=settings.max_cells, bytes_=settings.max_bytes)
    return asked, prepared
