"""The Accept header (RFC 9110): in which form a client would like to be answered."""

from __future__ import annotations

from collections.abc import Mapping

from fastapi import Request

from vibrafeed.app.web.problems import NotAcceptableError


def form_for(request: Request, forms: Mapping[str, str], *, missing: str = "") -> str:
    """Return the offered format that a client prefers by its Accept header; ties go to the first.

    Parameters
    ----------
    request : Request
        The request, whose Accept headers count.
    forms : mapping of str to str
        The media type of each format that the service offers, by the format's name.
    missing : str
        A sentence that the error message adds, such as on packages that are not installed.

    Raises
    ------
    NotAcceptableError
        If the client accepts none of the formats; the message names them all.
    """
    accept = ",".join(request.headers.getlist("accept"))
    best = preferred(accept, tuple(forms.values()))
    if best is None:
        raise NotAcceptableError(f"There is {', '.join(forms.values())}.{missing and ' '}{missing}")
    return next(name for name, media_type in forms.items() if media_type == best)


def preferred(accept: str, offered: tuple[str, ...]) -> str | None:
    """Return the offered media type that an Accept header prefers; None if none fits.

    The weight of a type is that of the range that names it most closely; ties go to the first.
    Malformed elements do not count; without a header the first type is taken. `accept` is the
    header, `offered` the media types.
    """
    ranges = _ranges(accept)
    if not ranges:
        return offered[0]

    def weight(name: str) -> float:
        closest_first = (name, f"{name.partition('/')[0]}/*", "*/*")
        return next((ranges[media] for media in closest_first if media in ranges), 0.0)

    best = max(offered, key=weight)  # the first of equals
    return best if weight(best) > 0 else None


def _ranges(header: str) -> dict[str, float]:
    """Return the weight, 0 to 1, of each media range of an Accept header, such as `text/*`.

    Names are in small letters. A range without weight has 1; a malformed weight counts as 0.
    """
    weights: dict[str, float] = {}
    for item in header.split(","):
        name, *parameters = (part.strip().lower() for part in item.split(";"))
        qualities = [part[2:] for part in parameters if part.startswith("q=")]
        try:
            weight = float(qualities[0]) if qualities else 1.0
        except ValueError:
            weight = 0.0
        if name:
            weights[name] = weight if 0 <= weight <= 1 else 0.0
    return weights
