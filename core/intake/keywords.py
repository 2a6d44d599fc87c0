"""Studies as programs write them: a study, the path of a file, a mapping, or keywords."""

import difflib
import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from vibrafeed.core.errors import Problem, raise_any, refused
from vibrafeed.core.intake.forms import LARGEST, TOO_LARGE, keys_of_studies, read_content
from vibrafeed.core.kinds import KINDS
from vibrafeed.core.quantities import QUANTITIES, letter_of
from vibrafeed.core.scenes import SCENES
from vibrafeed.core.study.grid_study import PARAMETERS, Study
from vibrafeed.core.study.units import dimension_of, split_unit, with_own_unit
from vibrafeed.core.study.values import DESIGN, MAX_POINTS
from vibrafeed.core.tables.headings import name_and_unit

StudyLike = Study | Mapping[str, Any] | str | os.PathLike[str]
"""What stands for a study; a text is the name of a scene, or the path of a TOML or JSON file."""


def gather(
    study: StudyLike | None, keywords: Mapping[str, Any], kind: str | None = None
) -> Study | dict[str, Any]:
    """Return a study as it is, or the content of the study described by keywords.

    Keywords, and the keys of a mapping, are keys of a study or names of parameters; keywords
    replace what `study` says. Values may be arrays of numpy and ranges of Python, too.

    Parameters
    ----------
    study : Study, mapping, str or path, optional
        A study, the content of its file, the path of the file, or the name of a scene.
    keywords : mapping
        Further keys and parameters.
    kind : str, optional
        The only accepted kind, and the kind of a study that names none.

    Raises
    ------
    StudyError
        If it is of another kind, cannot be read, or gives a value twice. `parse_study` checks the
        values later.
    """
    if isinstance(study, Study) and not keywords:
        _check_kind(study.kind, kind)
        return study
    content = {} if study is None else _content_of(study)
    further = spread(keywords)
    parameters = content.get("parameters")
    if isinstance(parameters, Mapping) and isinstance(further.get("parameters"), Mapping):
        new_names = {*map(letter_of, further["parameters"])}
        others = {name: raw for name, raw in parameters.items() if letter_of(name) not in new_names}
        further["parameters"] = others | further["parameters"]
    content |= further
    if kind is not None:
        _check_kind(content.setdefault("kind", kind), kind)
    return content


def spread(written: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of a study, with parameters moved from its top level to `parameters`.

    So a study may be written as keywords of a call. `written` is the content, whose `outputs` may
    be a single name instead of a list. An unknown name goes where the most similar known name
    belongs, so that it is refused there.

    Raises
    ------
    StudyError
        If a parameter is given twice, or is an endless range; if labelled arrays belong together
        row by row.
    """
    paired = paired_in(written)
    content: dict[str, Any] = {}
    parameters_beside: dict[str, Any] = {}
    for name, value in written.items():
        if _is_key(str(name)):
            content[str(name)] = plain(value, str(name))
        else:
            parameters_beside[str(name)] = plain(value, f"parameters.{name}")
    for table in (parameters_beside, content.get("parameters")):
        if isinstance(table, dict):
            table |= {name: {DESIGN: table[name]} for name in paired & table.keys()}
    if isinstance(content.get("outputs"), str):
        content["outputs"] = [content["outputs"]]
    parameters = content.get("parameters", {})
    if parameters_beside and isinstance(parameters, Mapping):
        raise_any(
            Problem(
                f"parameters.{name}",
                f"{name} is given twice: as a keyword and in parameters",
                "Remove one of the two",
            )
            for name in parameters_beside
            if name in parameters
        )
        content["parameters"] = {**parameters, **parameters_beside}
    return content


def paired_in(written: Mapping[str, Any]) -> set[str]:
    """Return the names of parameters whose labelled arrays have a dimension in common.

    They have one value in each design. `written` is the content of a study, with parameters beside
    the keys or among `parameters`. Raises `StudyError` if an array is along a parameter that is no
    array, or if there are several such dimensions.
    """
    parameters = written.get("parameters")
    values = {**written, **parameters} if isinstance(parameters, Mapping) else written
    dimensions = {str(name): letter_of(dimension_of(value)) for name, value in values.items()}
    dimension_of_parameter = {
        name: dimension
        for name, dimension in dimensions.items()
        if letter_of(name) in PARAMETERS and dimension
    }
    counts = Counter(dimension_of_parameter.values())
    shared = [dimension for dimension, count in counts.items() if count > 1 or dimension == DESIGN]
    if len(shared) > 1:
        message = f"arrays share the dimensions {' and '.join(shared)}, but designs have only one"
        raise refused("designs", message, "Give all these arrays along one dimension")
    raise_any(
        Problem(
            f"parameters.{name}",
            f"the dimension of its array is named '{dimension}', which is another parameter",
            f"Give a list to compute all combinations with {dimension}",
        )
        for name, dimension in dimension_of_parameter.items()
        if dimension != letter_of(name) and dimension in PARAMETERS and dimension not in shared
    )
    return {name for name, dimension in dimension_of_parameter.items() if dimension in shared}


def plain(value: object, path: str) -> Any:
    """Return a value of a study as a file can hold it: ranges and arrays become lists.

    `value` may be anything that a caller from Python gives, nested in mappings and lists; `path` is
    its place in the study, for messages.

    Raises
    ------
    StudyError
        If a range has more values than an axis may have, or an array more than one dimension.
    """
    if value is None or type(value) in (str, float):
        return value
    if type(value) is int:
        if not -LARGEST <= value <= LARGEST:
            raise refused(path, *TOO_LARGE)
        return value
    if isinstance(value, Mapping) or (hasattr(value, "columns") and hasattr(value, "to_numpy")):
        return {name: plain(item, f"{path}.{name}") for name, item in _columns(value)}
    if isinstance(value, list | tuple):
        return [plain(item, path) for item in value]
    if isinstance(value, range):
        if value[MAX_POINTS:]:
            raise refused(
                path,
                f"{value} has too many values",
                f"Take a larger step: an axis has at most {MAX_POINTS:,} values",
            )
        return list(value)
    return _numbers(value, path)


def _numbers(value: Any, path: str) -> Any:
    # Plain numbers; with a unit other than the parameter's own they become texts, `"20 mm"`.
    attributes = getattr(value, "attrs", None)
    if isinstance(attributes, dict) and attributes.keys() & {"scale_factor", "add_offset"}:
        raise refused(
            path,
            "the scale_factor or add_offset of the array is not applied",
            "Open the file with mask_and_scale=True, the default of xarray",
        )
    numbers, unit = split_unit(value)
    if getattr(numbers, "ndim", 0) == 2 and path == "drive.mounting":  # a rotation matrix
        return numbers.tolist()
    if getattr(numbers, "ndim", 0) > 1:
        raise refused(
            path,
            f"the value is an array of {numbers.ndim} dimensions",
            "Give an array of one dimension, or one number",
        )
    quantity = QUANTITIES.get(letter_of(path.rpartition(".")[2]))
    own_unit = "1" if path in keys_of_studies() else "" if quantity is None else quantity.unit
    unit = "" if unit == own_unit else unit
    if hasattr(numbers, "tolist"):
        kind = getattr(getattr(numbers, "dtype", None), "kind", "")
        numbers = numbers.tolist()
        if kind in tuple("biuf") and not unit:
            return numbers
    if isinstance(numbers, list):
        return [plain(with_own_unit(number, unit), path) for number in numbers]
    return with_own_unit(numbers, unit)


def _columns(table: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(table, Mapping):
        for name in getattr(table, "variables", table):
            yield str(name), table[name]
        return
    for heading in table.columns:
        name, unit = name_and_unit(str(heading))
        numbers, own_unit = split_unit(table[heading])
        yield name, [with_own_unit(number, own_unit or unit) for number in numbers.tolist()]


def _content_of(study: object) -> dict[str, Any]:
    if isinstance(study, Study):
        return study.content()
    if isinstance(study, Mapping):
        return spread(study)
    if isinstance(study, str) and (study in SCENES or _may_be_scene(study)):
        return {"scene": study}
    if isinstance(study, str | os.PathLike):
        study = read_content(Path(study))
        if isinstance(study, dict):
            return study
    raise refused(
        "study",
        f"a value of type {type(study).__name__} is neither a study, a path nor a mapping",
        "Give a study, a path or a mapping, or the keys as keyword arguments",
    )


def _may_be_scene(text: str) -> bool:
    path = Path(text)
    return not path.suffix and path.name == text and not path.exists()


def _is_key(name: str) -> bool:
    if name in keys_of_studies() or letter_of(name) in PARAMETERS:
        return name in keys_of_studies()
    similar: Iterable[str] = difflib.get_close_matches(
        name[:60], (*keys_of_studies(), *PARAMETERS), n=1
    )
    return any(similar_name in keys_of_studies() for similar_name in similar)


def _check_kind(actual: object, kind: str | None) -> None:
    if kind is not None and actual != kind and isinstance(actual, str) and actual in KINDS:
        raise refused(
            "kind",
            f"this is a study of kind '{actual}', not '{kind}'",
            f"Carry it out with {actual}(), or give a study of kind '{kind}'",
        )
