"""Chunks shaped for a reader: `frequency:all,friction:1`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from vibrafeed.core.dataset.layout import chunk_shape
from vibrafeed.core.errors import Problem, StudyError
from vibrafeed.core.quantities import letter_of
from vibrafeed.core.suggestions import Suggestions

Wishes = Mapping[str, int | None]
"""Values of a chunk along some axes; None for as many as may be."""

ALL = "all"
_FIX = "Write AXIS:all or AXIS:NUMBER, with commas between, as in frequency:all,friction:1"


def read_wishes(text: str, sizes: Mapping[str, int], most: int) -> dict[str, int | None]:
    """Return the sizes of chunks that a user asks for in a text; raise `StudyError` for problems.

    A chunk is the piece of an array that is read at once. The length along an axis is None for
    ``all``.

    Parameters
    ----------
    text : str
        Such as ``frequency:all,friction:1``.
    sizes : mapping of str to int
        The length of each axis there is.
    most : int
        Largest number of values of a chunk.
    """
    lengths: dict[str, int | None] = {}
    problems, suggest = [], Suggestions()
    for word in text.split(","):
        name, _, length = word.partition(":")
        name = letter_of(name)
        is_number = length.isdecimal() and length.isascii() and len(length) <= 18
        if name not in sizes:
            message, fix = f"'{name[:60]}' is not an axis of this sweep", suggest(name, sizes)
        elif name in lengths:
            message, fix = f"{name} is given twice", "Name each axis once"
        elif length != ALL and not (is_number and int(length) > 0):
            message, fix = f"'{length[:60]}' is not a length along {name}", _FIX
        else:
            lengths[name] = None if length == ALL else min(int(length), sizes[name])
            continue
        problems.append(Problem("chunks", message, fix))
    cells = math.prod(n for n in lengths.values() if n is not None)
    if cells > most:
        message = f"chunks of {cells:,} values are larger than the {most:,} that they may have"
        problems.append(
            Problem(
                "chunks",
                message,
                "Write all instead of a number in chunks, for the largest chunks that are possible",
            )
        )
    if problems:
        raise StudyError(problems)
    return lengths


def wished_shape(
    dims: Sequence[str], shape: Sequence[int], wishes: Wishes, most: int
) -> tuple[int, ...]:
    """Return the shape of the chunks of an array as a reader wants them, at most `most` values.

    A chunk is the piece of an array that is read at once. `dims` and `shape` are the axes of the
    array and their lengths; `wishes` has lengths by axis, None for the whole axis. Lengths come
    first, then whole axes: if they do not fit, all of them are cut alike. The other axes share what
    room is left.
    """
    sizes = dict(zip(dims, shape, strict=True))
    lengths = {dim: n for dim, n in wishes.items() if dim in sizes and n is not None}
    whole = [dim for dim in dims if dim in wishes and dim not in lengths]
    others = [dim for dim in dims if dim not in wishes]
    for group in (whole, others):
        room = max(1, most // math.prod(lengths.values()))
        lengths |= zip(group, chunk_shape(tuple(sizes[dim] for dim in group), room), strict=True)
    return tuple(lengths[dim] for dim in dims)
