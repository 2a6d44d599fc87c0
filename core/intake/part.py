"""The section `part` of a study: from a file with the surface of a part to the way it lies."""

import base64
import binascii
import hashlib
import io
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from vibrafeed.core.errors import Problem, StudyError, raise_any, refused
from vibrafeed.core.intake.section import (
    Content,
    Resolved,
    Section,
    Stranger,
    advice_on_path,
    no_field,
    problems_of,
)
from vibrafeed.core.quantities.orienting import PartAspect
from vibrafeed.core.scenes.scene import MESH
from vibrafeed.core.study.part_study import UNITS, PartFile, PartOfFile

MAX_BYTES = 50_000_000  # a million triangles of a binary STL
MAX_TRIANGLES = 1_000_000
SUFFIXES = (".stl", ".obj", ".ply")
SIZES = (1e-5, 10.0)  # m, of parts
FLAT = 1e-9  # volume over the cube of the length, below which there is none
DIGITS = 12  # of kept numbers: few enough to be equal on all processors
EXPORT = "Export the part from the CAD program again, as one closed solid"
BESIDE_PART: Final = {"variant": MESH, "parameters": {}}
"""Keys of a study that may be left out beside `part`."""
PLAIN = ("part_volume", "part_mass", "regime")
"""Outputs that all aspects of a part share."""


def _with_part(content: Content, files: bool) -> Resolved:
    section = content["part"]
    if not isinstance(section, Mapping) or "sha256" in section:
        return Resolved(content)
    try:
        part = read_part(section, files)
    except StudyError as error:
        without = {name: value for name, value in content.items() if name != "part"}
        return Resolved({**BESIDE_PART, **without}, error.problems)
    return Resolved({
        **BESIDE_PART,
        **_with_aspects(content, len(part.aspects)),
        "part": part.model_dump(mode="json"),
    })  # fmt: skip


def _with_aspects(content: Content, count: int) -> Content:
    """The content, in which a resting part has all its aspects where none is named."""
    named = [content.get(key) for key in ("parameters", "variables", "uncertain")]
    is_set = any(isinstance(one, Mapping) and "aspect" in one for one in named)
    outputs, parameters = content.get("outputs"), content.get("parameters", {})
    asked = outputs if isinstance(outputs, list | tuple) else ()
    needed = any(output not in PLAIN for output in asked)
    if is_set or not needed or content.get("scene") != "resting-part":
        return content
    if not isinstance(parameters, Mapping):
        return content  # which its reader tells
    every = {"start": 1, "stop": count, "num": count} if count > 1 else 1
    return {**content, "parameters": {**parameters, "aspect": every}}


def read_part(part: Mapping[str, Any], files: bool) -> PartOfFile:
    """Return the numbers of the part that a section of a study names.

    `files` is True if files of this machine may be read. Raises `StudyError` with every problem.
    """
    from vibrafeed.core.solid import RoundedError, aspects_of, solid_of  # scipy's hulls

    try:
        asked = PartFile.model_validate(part)
    except ValidationError as error:
        raise StudyError(problems_of(error, {"part": PART}, PART.unknown, within="part")) from None
    raw, name = _content(asked, files)
    path = "part.data" if asked.file is None else "part.file"
    points, triangles = _surface(raw, name, path, UNITS[asked.unit])
    raise_any(_faults(triangles, name, path))
    solid = solid_of(points, triangles)
    raise_any(_faults_of_volume(solid.volume / np.ptp(points, axis=0).max() ** 3, name, path))
    try:
        aspects = aspects_of(solid)
    except RoundedError as error:
        raise refused(
            path,
            f"{error}: more than it can rest on by itself, such as facets of a rounded side",
            "Export it with finer facets, or give a round part as another variant, such as "
            "cylinder",
        ) from None
    return PartOfFile(
        name=name,
        sha256=hashlib.sha256(raw).hexdigest(),
        volume=_rounded(solid.volume),
        centre=_rounded(solid.centre),
        inertia=_rounded(solid.inertia),
        aspects=tuple(_kept(one) for one in aspects),
        corners=_rounded(solid.hull.extreme_points()),
    )


def _rounded(values: Any) -> Any:
    if np.ndim(values):
        return tuple(_rounded(one) for one in np.asarray(values).tolist())
    return float(f"{values:.{DIGITS}g}")


def _kept(aspect: PartAspect) -> PartAspect:
    return PartAspect(**{name: _rounded(value) for name, value in vars(aspect).items()})


def _content(asked: PartFile, files: bool) -> tuple[bytes, str]:
    data = "data = the text of an ASCII STL or OBJ file, or a binary STL file in Base64"
    fix = f"Give file = the name of the file, or {data}" if files else f"Give {data}"
    if (asked.file is None) == (asked.data is None):
        said = "names no file" if asked.data is None else "gives both file and data"
        raise refused("part", f"the part {said}", fix)
    if asked.data is not None:
        return _of_text(asked.data), "data"
    if not files or asked.file is None:
        raise refused("part.file", "the service cannot read the file from your computer", fix)
    kind = asked.file.suffix.lower()
    if kind not in SUFFIXES:
        raise refused(
            "part.file",
            f"'{asked.file.name[:60]}' is not an STL, OBJ or PLY file",
            "Export the part from the CAD program as STL",
        )
    try:
        size = asked.file.stat().st_size
        if size > MAX_BYTES:
            raise _too_large("part.file", asked.file.name)
        return asked.file.read_bytes(), asked.file.name
    except (OSError, ValueError) as error:  # a NUL in its name is the second
        raise refused(
            "part.file",
            f"it cannot be read: {getattr(error, 'strerror', None) or error}",
            advice_on_path(asked.file, "Name the file by its path from the folder of the study"),
        ) from None


def _too_large(path: str, name: str) -> StudyError:
    return refused(
        path,
        f"{name} is too large: the limit is {MAX_TRIANGLES:,} triangles, {MAX_BYTES // 10**6} MB",
        "Export it with coarser facets",
    )


def _of_text(text: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        return text.encode("utf-8", "surrogatepass")


def _surface(
    raw: bytes, name: str, path: str, metre: float
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    from trimesh import Trimesh, load_mesh  # half a second, and few studies need it

    kind = Path(name).suffix.lower().removeprefix(".")
    if not kind:
        kind = "stl" if raw[:5] == b"solid" or b"\0" in raw[:84] else "obj"
    try:
        mesh = load_mesh(io.BytesIO(raw), file_type=kind, process=False)
    except Exception as error:  # of a damaged file the library raises of many kinds
        raise refused(
            path, f"{name} is damaged, or is not a file of its kind: {error}"[:300], EXPORT
        ) from None
    if not isinstance(mesh, Trimesh) or not len(mesh.faces):
        raise refused(path, f"{name} has no triangles, or is damaged", EXPORT)
    if len(mesh.faces) > MAX_TRIANGLES:
        raise _too_large(path, name)
    if not np.isfinite(mesh.vertices).all():
        raise refused(path, f"{name} has coordinates that are not finite numbers", EXPORT)
    size = metre * float(np.ptp(mesh.vertices, axis=0).max())
    if not SIZES[0] <= size <= SIZES[1]:
        raise refused(
            "part.unit",
            f"the part is {size:.3g} m long",
            f"Parts are {SIZES[0]:g} to {SIZES[1]:g} m long; give the unit of the file's "
            f"coordinates: {', '.join(UNITS)}",
        )
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    triangles = np.asarray(mesh.faces, dtype=np.int64)
    # A triangle with two corners at one point covers nothing.
    flat = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    return metre * np.asarray(mesh.vertices, dtype=np.float64), triangles[~flat]


def _faults(triangles: NDArray[np.int64], name: str, path: str) -> Iterable[Problem]:
    starts, ends = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    # A number for each edge, and another for the same edge in the other direction.
    count = int(triangles.max(initial=0)) + 1
    sides, opposite = starts * count + ends, ends * count + starts
    _, times = np.unique(np.minimum(sides, opposite), return_counts=True)
    lone, shared = int((times == 1).sum()), int((times > 2).sum())
    if lone:
        yield Problem(
            path,
            f"the surface of {name} is open: {lone:,} edges belong to one triangle only",
            f"{EXPORT}, or close the holes with a repair tool such as MeshLab",
        )
    if shared:
        yield Problem(path, f"{shared:,} edges of {name} belong to more than two triangles", EXPORT)
    if not lone and not shared and len(np.unique(sides)) < len(sides):
        yield Problem(
            path,
            f"some triangles of {name} face outwards, others inwards",
            f"{EXPORT}, or let a repair tool such as MeshLab turn all normals outwards",
        )
    bodies = _bodies(starts, ends)
    if bodies > 1:
        yield Problem(path, f"{name} has {bodies:,} separate bodies", "Export a single part")


def _faults_of_volume(volume: float, name: str, path: str) -> Iterable[Problem]:
    if abs(volume) < FLAT:
        yield Problem(path, f"{name} encloses no volume", EXPORT)
    elif volume < 0:
        yield Problem(
            path,
            f"{name} is inside out: its triangles face inwards",
            f"{EXPORT}, or let a repair tool such as MeshLab turn all normals outwards",
        )


def _bodies(starts: NDArray[np.int64], ends: NDArray[np.int64]) -> int:
    from scipy.sparse import coo_array  # few studies need it
    from scipy.sparse.csgraph import connected_components

    known, number = np.unique(np.concatenate([starts, ends]), return_inverse=True)
    a, b = np.split(number, 2)
    graph = coo_array((np.ones(len(a), bool), (a, b)), shape=(len(known),) * 2)
    return int(connected_components(graph, directed=False)[0])


def _beside(part: Any, folder: Path) -> Any:
    is_named = isinstance(part, dict) and isinstance(part.get("file"), str)
    return {**part, "file": str(folder / part["file"])} if is_named else part


def _absent(stranger: Stranger) -> Problem:
    return Problem(
        stranger.place,
        "studies of this kind take no part from a file",
        'Write kind = "sweep", "optimise" or "sensitivity"',
    )


PART: Final = Section(
    beside=_beside,
    resolve=_with_part,
    unknown=lambda stranger: no_field(stranger, PartFile),
    absent=_absent,
)
"""The section `part`."""
