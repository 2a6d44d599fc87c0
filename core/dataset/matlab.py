"""A result as a MAT file, for MATLAB and GNU Octave: grids as arrays, with what they mean.

The file holds one structure, `result`, whose fields are structures with a field for each variable.
"""

import json
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from vibrafeed.core.dataset.files import Storage, whole
from vibrafeed.core.dataset.limits import Size, check_limit
from vibrafeed.core.dataset.table import Table, TableVariable, flags_of

MAX_BYTES: Final = 2**31 - 2**20  # bytes that a variable of a MAT file of version 5 may have
LONGEST: Final = 63  # characters of a name in MATLAB
FIELDS: Final = {"units": "units", "labels": "long_name", "descriptions": "comment"}


def check(size: Size) -> None:
    """Raise `LimitError` if a MAT file cannot hold a result of a size."""
    check_limit("bytes in a MAT file", size.value_bytes, MAX_BYTES, "Write NetCDF: MATLAB reads it")


def write_mat(table: Table, where: str, storage: Storage) -> None:
    """Write a table as a MAT file, which appears only when complete.

    Parameters
    ----------
    table : Table
        The result to write.
    where : str
        The file; an existing one is replaced.
    storage : Storage
        With compression: deflate.

    Raises
    ------
    LimitError
        If the file cannot hold the table.
    OSError
        If the file cannot be written.
    """
    from scipy.io import savemat

    variables = {**table.coordinates, **table.variables}
    matlab_names = names_in_matlab(variables)
    data = {matlab_names[name]: _array(variable) for name, variable in variables.items()}
    check(Size(value_bytes=sum(array.nbytes for array in data.values())))
    result = {
        "data": data,
        "dimensions": {  # rows of objects, which become cell arrays
            matlab_names[name]: np.array(
                [[matlab_names[dim] for dim in variable.dims]], dtype=object
            )
            for name, variable in variables.items()
        },
        **{
            field: {
                matlab_names[name]: _text(str(variable.attributes[attribute]))
                for name, variable in variables.items()
                if attribute in variable.attributes
            }
            for field, attribute in FIELDS.items()
        },
        "flags": {
            matlab_names[name]: _flags(variable)
            for name, variable in variables.items()
            if "flag_values" in variable.attributes
        },
        "study": _ascii_json(str(table.attributes.get("study", ""))),
        "about": _about(table),
    }
    with whole(Path(where)) as temporary, temporary.open("wb") as file:
        savemat(
            file,
            {"result": {name: value for name, value in result.items() if value != {}}},
            long_field_names=True,
            do_compression=storage.compression,
            oned_as="column",
        )


def names_in_matlab(names: Iterable[str]) -> dict[str, str]:
    """Return a name that MATLAB allows for each of some names, unchanged where possible.

    Characters other than letters, digits and underscores become underscores, an x goes before a
    first character that is no letter, and names end after 63 characters. Equal names get a number,
    so that all are distinct.
    """
    renamed: dict[str, str] = {}
    for name in names:
        allowed = re.sub(r"\W", "_", name, flags=re.ASCII)
        allowed = (allowed if allowed[:1].isalpha() else f"x{allowed}")[:LONGEST]
        number = 1
        while (
            candidate := allowed if number == 1 else f"{allowed[: LONGEST - 4]}_{number}"
        ) in set(renamed.values()):
            number += 1
        renamed[name] = candidate
    return renamed


def _array(variable: TableVariable) -> NDArray[Any]:
    values = variable.values
    return values if values.dtype == object or values.dtype.kind == "f" else values.astype(float)


def _ascii_json(text: str) -> str:
    return re.sub(r"[^\x00-\x7f]", lambda match: json.dumps(match[0])[1:-1], text)


def _text(text: str) -> str:
    """Return a text with a blank at its end for each byte that UTF-8 adds to its letters.

    scipy writes the number of letters and the bytes of UTF-8; Octave reads as many bytes as there
    are letters, and would cut the text.
    """
    return text + " " * (len(text.encode()) - len(text))


def _flags(variable: TableVariable) -> dict[str, float]:
    flags = flags_of(variable.attributes)
    matlab_names = names_in_matlab(flags.values())
    return {matlab_names[word]: float(value) for value, word in flags.items()}


def _about(table: Table) -> dict[str, Any]:
    """Return the global attributes of a table for a MAT file, by MATLAB name, without the study.

    Numbers become floats, all others texts. The study has a field of its own in the file.
    """
    attributes = {**table.attributes, **table.price}
    matlab_names = names_in_matlab(attributes)
    return {
        matlab_names[name]: float(value) if isinstance(value, int | float) else _text(str(value))
        for name, value in attributes.items()
        if name != "study"
    }
