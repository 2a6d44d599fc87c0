"""The direction in which a part travels, in words.

A file of its own: cached code of kernels hangs on the text of `vibrafeed.core.quantities.flags`.
"""

from __future__ import annotations

from vibrafeed.core.quantities.flags import Flag

DIRECTIONS: dict[str, Flag] = {
    "rests": Flag(0, "the part does not travel: it is held, or moves to and fro on the spot"),
    "forwards": Flag(1, "the part travels forwards, along +x"),
    "backwards": Flag(2, "the part travels backwards, against x"),
    "unknown": Flag(3, "the part has no mean velocity", valid=False),
}
