"""`python -m benchmarks.notebooks` carries out docs/notebooks/*.ipynb and stores what came of it.

It needs no Jupyter: a cell is Python, and what its last line gives is shown. A notebook takes the
picture of a figure, the table of pandas, and else the text.
"""

from __future__ import annotations

import ast
import base64
import contextlib
import io
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parents[1] / "docs" / "notebooks"


def carried_out(notebook: dict[str, Any]) -> Iterator[list[dict[str, Any]]]:
    """Yield the outputs of each code cell, in the form of a notebook."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            yield _outputs("".join(cell["source"]), names)


def _outputs(code: str, names: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the outputs of a code cell."""
    body = ast.parse(code).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(ast.Module(body, []), "<cell>", "exec"), names)
        value = last and eval(compile(ast.Expression(last.value), "<cell>", "eval"), names)
    outputs: list[dict[str, Any]] = []
    if printed.getvalue():
        outputs.append(
            {"name": "stdout", "output_type": "stream", "text": _lines(printed.getvalue())}
        )
    if value is not None:
        data = {"text/plain": _lines(repr(value))}
        if hasattr(value, "savefig"):
            picture = io.BytesIO()
            value.savefig(picture, format="png")
            data["image/png"] = base64.b64encode(picture.getvalue()).decode()
        elif hasattr(value, "_repr_html_"):
            data["text/html"] = _lines(value._repr_html_())
        outputs.append({"data": data, "metadata": {}, "output_type": "display_data"})
    return outputs


def _lines(text: str) -> list[str]:
    """Return a text as lines with their ends."""
    return text.splitlines(keepends=True)


def said(outputs: list[dict[str, Any]]) -> list[str]:
    """Return the texts in outputs."""
    return [
        "".join(output.get("text") or output["data"]["text/plain"])
        for output in outputs
        if "image/png" not in output.get("data", {})
    ]


if __name__ == "__main__":
    for path in sorted(FOLDER.glob("*.ipynb")):
        notebook = json.loads(path.read_text(encoding="utf-8"))
        cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
        for cell, outputs in zip(cells, carried_out(notebook), strict=True):
            cell["outputs"] = outputs
        path.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        print(f"{path}: {path.stat().st_size:,} bytes")
