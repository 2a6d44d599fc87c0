"""The Prefer header (RFC 7240): how a client would like to be answered."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from urllib.request import parse_http_list

MAX_LENGTH = 2_000  # characters that are read


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
    text = ",".join(headers)
    if len(text) > MAX_LENGTH:
        text = text[:MAX_LENGTH].rpartition(",")[0]
    values: dict[str, str] = {}
    for element in parse_http_list(text):
        name, _, value = element.partition(";")[0].partition("=")
        values.setdefault(name.strip().lower(), value.strip().strip('"'))
    wait = values.get("wait", "")
    seconds = int(wait) if re.fullmatch(r"[0-9]{1,9}", wait) else None
    return Preferences("respond-async" in values, seconds)
