"""The figures of the thesis, as the studies that draw them."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

from fastapi.responses import Response

from vibrafeed import core
from vibrafeed.app.web.replies import Document, Router, json_reply
from vibrafeed.core.intake import load_study

router = Router(tags=["scenes"])

# At the top of the repository, and beside the core where vibrafeed is installed.
FOLDER = Path(core.__file__).resolve().parent.parent / "configs" / "figures"


@router.get("/figures", summary="List the figures of the thesis", response_model=list[Document])
def list_figures() -> Response:
    """Return each figure that vibrafeed draws, in the order of the thesis.

    `study` computes the figure, in the form that POST /sweeps takes. `notes` holds the assumptions,
    the claim of the thesis, and whether it holds.
    """
    return json_reply(_figures())


@functools.cache
def _figures() -> list[dict[str, Any]]:
    """Return name, title, notes and study of each figure of the thesis, in the thesis's order.

    They are read from the studies that come with the program, once.
    """
    figures = []
    paths = FOLDER.glob("fig-*.toml")  # such as fig-5-1.toml
    for path in sorted(paths, key=lambda one: [*map(int, one.stem.split("-")[1:])]):
        content = load_study(path).content()
        title, notes = content.pop("title", path.stem), content.pop("notes", "")
        figures.append({"name": path.stem, "title": title, "notes": notes, "study": content})
    return figures
