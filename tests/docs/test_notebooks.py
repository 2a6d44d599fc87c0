"""The notebooks say what they say they do."""

import json
from pathlib import Path

import pytest

from benchmarks.notebooks import FOLDER, carried_out, said

NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_says_what_is_stored(path: Path) -> None:
    """`python -m benchmarks.notebooks` stores it again."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    cells = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    pictures = 0
    for cell, outputs in zip(cells, carried_out(notebook), strict=True):
        assert said(cell["outputs"]) == said(outputs), "".join(cell["source"])
        kinds = [sorted(output.get("data", {})) for output in outputs]
        assert [sorted(output.get("data", {})) for output in cell["outputs"]] == kinds
        pictures += sum("image/png" in kind for kind in kinds)
    assert pictures >= 1
    assert path.stat().st_size < 300_000
