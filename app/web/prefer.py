"""The Prefer header (RFC 7240): how a client would like to be answered."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

MOST = 2_000  # characters that are read

# Every repetition is possessive: what cannot be told apart in two ways is not tried in two ways.
_TOKEN = r"[!#$%&'*+.^_`|~0-9A-Za-z-]++"
_WORD = rf'(?:{_TOKEN}|"(?:[^"\\]|\\.)*+")'
_PREFERENCE = re.compile(
    rf"\s*+(?P<name>{_TOKEN})(?:\s*+=\s*+(?P<value>{_WORD}))?+"
    rf"(?:\s*+;\s*+(?:{_TOKEN}(?:\s*+=\s*+{_WORD})?+)?+)*+\s*+(?:,|$)"
)


@dataclass(frozen=True)
class Preferences:
    """The preferences of a client.

    Attributes
    ----------
    respond_async : bool
        True if the client does not want to wait for the result.
    wait : int or None
        The longest time that it wants to wait [s].
    """

    respond_async: bool = False
    wait: int | None = None


def preferences(headers: Iterable[str]) -> Preferences:
    """Return the preferences in a request's Prefer headers; unknown ones are ignored.

    Of a preference that is given more than once the first counts, as the standard asks. Anything
    past the first 2,000 characters, or cut off there, is ignored.
    """
    values: dict[str, str | None] = {}
    text = ",".join(headers)
    if len(text) > MOST:
        text = text[:MOST].rpartition(",")[0]
    position = 0
    while position < len(text):
        match = _PREFERENCE.match(text, position)
        if match is None:  # on with the next element
            position = text.find(",", position) + 1 or len(text)
            continue
        position = match.end()
        value = match["value"]
        if value is not None and value.startswith('"'):
            value = re.sub(r"\\(.)", r"\1", value[1:-1])
        values.setdefault(match["name"].lower(), value)
    wait = values.get("wait")
    is_number = wait is not None and re.fullmatch(r"[0-9]{1,9}", wait) is not None
    return Preferences("respond-async" in values, int(str(wait)) if is_number else None)
