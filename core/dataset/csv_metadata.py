"""The metadata of a CSV file, kept in a file beside it: units, descriptions, the study.

The form is that of "Metadata Vocabulary for Tabular Data" (W3C, 2015), known as CSV on the Web:
its readers find `x.csv-metadata.json` by the name of `x.csv`.
"""

import json
from pathlib import Path
from typing import Any

from vibrafeed.core.dataset.files import CsvStyle
from vibrafeed.core.dataset.frame import Frame, heading
from vibrafeed.core.dataset.table import TableVariable


def metadata_path(path: Path) -> Path:
    """Return the path of the metadata file beside a CSV file."""
    return path.with_name(f"{path.name}-metadata.json")


def csv_metadata(frame: Frame, name: str, style: CsvStyle) -> bytes:
    """Return the JSON metadata (CSV on the Web) of a CSV file with a result.

    `frame` has columns and attributes, `name` is the file's name without folder, `style` that of
    the file. The study is among the notes as an object; `study_sha256` is the hash of its canonical
    text.
    """
    about = frame.about
    if "study" in about:
        about["study"] = json.loads(about["study"])
    document = {
        "@context": "http://www.w3.org/ns/csvw",
        "url": name,
        **({"dc:title": about["title"]} if "title" in about else {}),
        **({"dialect": {"delimiter": ";"}} if style == "excel" else {}),
        "tableSchema": {"columns": [_column(*one, style) for one in frame.columns.items()]},
        "notes": [about],
    }
    text = json.dumps(document, indent=2, ensure_ascii=False, default=lambda value: value.tolist())
    return f"{text}\n".encode()


def _column(name: str, column: TableVariable, style: CsvStyle) -> dict[str, Any]:
    """Return the metadata of one column of a CSV file: name, heading, type, label, unit.

    Keys are those of CSV on the Web; a key without a value is left out.
    """
    attributes = column.attributes
    description = {
        "name": name,
        "titles": heading(name, column),
        "datatype": _datatype(column, style),
        "dc:title": attributes.get("long_name"),
        "dc:description": attributes.get("comment"),
        "schema:unitText": attributes.get("units"),
    }
    return {key: value for key, value in description.items() if value is not None}


def _datatype(column: TableVariable, style: CsvStyle) -> Any:
    if "flag_values" in column.attributes or column.values.dtype.kind == "O":
        return "string"
    if column.values.dtype.kind in "iu":
        return "integer"
    return {"base": "number", "format": {"decimalChar": ","}} if style == "excel" else "number"
