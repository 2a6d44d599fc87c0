"""The section `part` of a study: from a file with the surface of a part to the way it lies."""

import base64
import binascii
import hashlib
import io
import math
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from pydantic import ValidationError

from vibrafeed.core.errors import Problem, StudyError, raise_any, refused
from vibrafeed.core.intake.section import (
    Content,
    Resolved,
    Section,
    Stranger,
    file_beside,
    no_field,
    problems_of,
    source_of,
    unreadable,
)
from vibrafeed.core.quantities.orienting import PartAspect
from vibrafeed.core.scenes.scene import MESH
from vibrafeed.core.study.part_study import MAX_CORNERS, UNITS, PartFile, PartOfFile
from vibrafeed.core.system import installing

if TYPE_CHECKING:
    from trimesh import Trimesh

MAX_BYTES = 50_000_000  # a million triangles of a binary STL
MAX_TRIANGLES = 1_000_000
SUFFIXES = (".stl", ".obj", ".ply", ".step", ".stp")
TURN = 0.05  # rad from facet to facet of a rounded side of a STEP file
STEP_SECONDS = 60
CONVERT = """import sys, cascadio
cascadio.step_to_glb(*sys.argv[1:3], tol_angular=float(sys.argv[3]), merge_primitives=True)"""
SIZES = (1e-5, 10.0)  # m, of parts
FLAT = 1e-9  # volume over the cube of the length, below which there is none
DIGITS = 12  # of kept numbers: few enough to be equal on all processors
PICTURE_DIGITS = 5  # of numbers for pictures
CELLS = 12  # of a surface along its diagonal, of which pictures show one corner
EXPORT = "Export the part from the CAD program again, as one closed solid"
BESIDE_PART: Final = {"variant": MESH, "parameters": {}}
"""Keys of a study that may be left out beside `part`."""
PLAIN = ("part_volume", "part_mass", "regime")
"""Outputs that all aspects of a part share."""


def with_part(content: Content, files: bool) -> Resolved:
    """Return the content of a study with the numbers of its part in place of the file."""
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
    sections = [content.get(key) for key in ("parameters", "variables", "uncertain")]
    is_set = any(isinstance(section, Mapping) and "aspect" in section for section in sections)
    outputs, parameters = content.get("outputs"), content.get("parameters", {})
    names = outputs if isinstance(outputs, list | tuple) else ()
    needed = any(output not in PLAIN for output in names)
    if is_set or not needed or content.get("scene") != "resting-part":
        return content
    if not isinstance(parameters, Mapping):
        return content  # refused where it is read
    all_aspects = {"start": 1, "stop": count, "num": count} if count > 1 else 1
    return {**content, "parameters": {**parameters, "aspect": all_aspects}}


def read_part(part: Mapping[str, Any], files: bool) -> PartOfFile:
    """Return the numbers of the part that a section of a study names.

    `files` is True if files of this machine may be read. Raises `StudyError` with every problem.
    """
    _raise_if_missing("trimesh", "reading a part from a file")
    from vibrafeed.core.solid import RoundedError, aspects_of  # trimesh takes half a second

    try:
        section = PartFile.model_validate(part)
    except ValidationError as error:
        raise StudyError(problems_of(error, {"part": PART}, PART.unknown, within="part")) from None
    raw, name = _content(section, files)
    path = "part.data" if section.file is None else "part.file"
    # Coordinates that are not finite, or no volume, make trimesh warn; faults are told below.
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        solid = _solid(raw, name, path, section.unit)
        raise_any(_faults(solid, name, path))
    try:
        aspects = aspects_of(solid)
    except RoundedError as error:
        raise refused(
            path,
            f"{error}. These are probably facets of a rounded side, on which a real part rolls",
            "Export the part with finer facets, or describe a round part by another variant, such "
            "as cylinder",
        ) from None
    surface = _coarse_surface(solid)
    return PartOfFile(
        name=name,
        sha256=hashlib.sha256(raw).hexdigest(),
        volume=_rounded(solid.volume),
        centre=_rounded(solid.center_mass),
        inertia=_rounded(solid.moment_inertia),
        aspects=tuple(_kept(aspect) for aspect in aspects),
        corners=_rounded(surface.vertices - solid.center_mass, PICTURE_DIGITS),
        triangles=tuple(map(tuple, surface.faces.tolist())),
    )


def _coarse_surface(solid: "Trimesh") -> "Trimesh":
    """The surface, or if it is too fine for pictures the hull of some of its corners."""
    if len(solid.vertices) <= MAX_CORNERS and len(solid.faces) <= 2 * MAX_CORNERS:
        return solid
    from trimesh.convex import convex_hull  # as above

    cells = (solid.vertices / solid.scale * CELLS).round()
    return convex_hull(solid.vertices[np.unique(cells, axis=0, return_index=True)[1]])


def _rounded(values: Any, digits: int = DIGITS) -> Any:
    """Numbers as floats and tuples of them, rounded to digits of the largest: noise is 0."""
    largest = float(np.abs(values).max())
    decimals = digits - math.ceil(math.log10(largest)) if largest > 0 else 0
    rounded = (np.round(values, decimals) + 0.0).tolist()
    if np.ndim(values) == 2:
        return tuple(map(tuple, rounded))
    return tuple(rounded) if np.ndim(values) else rounded


def _kept(aspect: PartAspect) -> PartAspect:
    return PartAspect(**{name: _rounded(value) for name, value in vars(aspect).items()})


def _content(section: PartFile, files: bool) -> tuple[bytes, str]:
    # The bytes and the name of the part's file.
    text = "the text of an ASCII STL, OBJ or STEP file, or a binary STL file in Base64"
    source = source_of("part", section.file, section.data, "file", text, files=files)
    if isinstance(source, str):
        return _of_text(source), "data"
    if source.suffix.lower() not in SUFFIXES:
        raise refused(
            "part.file",
            f"'{source.name[:60]}' is not an STL, OBJ, PLY or STEP file",
            "Export the part from the CAD program as STL or STEP",
        )
    try:
        if source.stat().st_size > MAX_BYTES:
            raise _too_large("part.file", source.name)
        return source.read_bytes(), source.name
    except (OSError, ValueError) as error:  # ValueError: a NUL in its name
        raise unreadable("part.file", error, source, "the file") from None


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


def _raise_if_missing(package: str, use: str) -> None:
    if find_spec(package) is None:
        fix = installing(package, "mesh")
        raise refused("part", f"{use} needs {package}, which is not installed", fix)


def _kind(raw: bytes, name: str) -> str:
    kind = Path(name).suffix.lower().removeprefix(".").replace("stp", "step")
    if kind:
        return kind
    if raw[:13] == b"ISO-10303-21;":
        return "step"
    return "stl" if raw[:5] == b"solid" or b"\0" in raw[:84] else "obj"


def _raise_if_unit_is_wrong(kind: str, unit: str | None) -> None:
    """A STEP file says its unit, and trimesh gives it in metres; the others say none."""
    if kind == "step" and unit is not None:
        raise refused("part.unit", "a STEP file states its own unit", "Remove unit")
    if kind != "step" and unit is None:
        fix = f"Give the unit of the file's coordinates: {', '.join(UNITS)}"
        raise refused("part.unit", "the unit is missing", fix)


def _damaged(path: str, says: str) -> StudyError:
    return refused(path, f"the file is damaged or of another kind: {says}"[:300], EXPORT)


def _triangles_of_obj(raw: bytes) -> int:
    count = raw.count(b"\nf")
    if count > MAX_TRIANGLES:
        return count
    return sum(face.count(b" ") - 2 for face in re.findall(rb"^f .*\S", raw, re.MULTILINE))


def _tessellated(raw: bytes, name: str, path: str) -> bytes:
    """The surface of a STEP file as a GLB file, in metres.

    A process of its own converts it: the library prints, and a damaged file can end its process.
    """
    _raise_if_missing("cascadio", "reading a STEP file")
    if b"DOCUMENT_FILE" in raw:
        raise refused(path, f"{name} refers to other files", "Export the part as one STEP file")
    with TemporaryDirectory() as folder:
        step, surface = Path(folder, "part.step"), Path(folder, "part.glb")
        step.write_bytes(raw)
        command = [sys.executable, "-c", CONVERT, str(step), str(surface), str(TURN)]
        try:
            subprocess.run(command, capture_output=True, timeout=STEP_SECONDS, check=False)
        except subprocess.TimeoutExpired:
            fix = "Export the part as STL"
            raise refused(path, f"{name} takes more than {STEP_SECONDS} s to read", fix) from None
        if not surface.is_file():
            raise _damaged(path, f"{name} has no solid that can be read")
        return surface.read_bytes()


def _solid(raw: bytes, name: str, path: str, unit: str | None) -> "Trimesh":
    from trimesh import Trimesh, load_mesh  # as above

    kind = _kind(raw, name)
    _raise_if_unit_is_wrong(kind, unit)
    unit_in_metres = 1.0 if unit is None else UNITS[unit]
    if kind == "step":
        raw, kind = _tessellated(raw, name, path), "glb"
    if kind == "obj":
        if _triangles_of_obj(raw) > MAX_TRIANGLES:
            raise _too_large(path, name)
        if re.search(rb"^f(?=\s)[^#\n]*\s0+(?=[/\s]|$)", raw, re.MULTILINE):
            raise _damaged(path, f"{name}: a face uses vertex 0, but vertices are numbered from 1")
        # Without these lines, since trimesh splits the surface by material and by object.
        raw = re.sub(rb"^(usemtl|mtllib|o|g)\s.*", b"", raw, flags=re.MULTILINE)
    try:
        solid = load_mesh(io.BytesIO(raw), file_type=kind, process=False, skip_materials=True)
    except Exception as error:  # the library raises many kinds for damaged files
        raise _damaged(path, f"{name}: {error}") from None
    if not isinstance(solid, Trimesh) or not len(solid.faces):
        raise refused(path, f"{name} has no triangles, or is damaged", EXPORT)
    if len(solid.faces) > MAX_TRIANGLES:
        raise _too_large(path, name)
    if not np.isfinite(solid.vertices).all():
        raise refused(path, f"{name} has coordinates that are not finite numbers", EXPORT)
    size = unit_in_metres * float(np.ptp(solid.vertices, axis=0).max())
    if not SIZES[0] <= size <= SIZES[1]:
        fix = "give the unit of the file's coordinates: " + ", ".join(UNITS)
        raise refused(
            path if unit is None else "part.unit",
            f"the part is {size:.3g} m long",
            f"Parts are {SIZES[0]:g} to {SIZES[1]:g} m long; "
            + (fix if unit else "export it in its true unit"),
        )
    solid.merge_vertices(merge_tex=True, merge_norm=True)
    corners = solid.faces
    # Leave out triangles with two corners at one point.
    solid.update_faces((corners != np.roll(corners, 1, axis=1)).all(axis=1))
    solid.apply_scale(unit_in_metres)  # type: ignore[no-untyped-call]
    return solid


def _faults(solid: "Trimesh", name: str, path: str) -> Iterable[Problem]:
    repair = f"{EXPORT}, or fix it with a repair tool such as MeshLab"
    if not solid.is_watertight:
        yield Problem(
            path, f"the surface of {name} is not closed, or three triangles share an edge", repair
        )
    if not solid.is_winding_consistent:
        yield Problem(path, f"some triangles of {name} face outwards, others inwards", repair)
    bodies = _bodies(solid)
    if bodies > 1:
        yield Problem(path, f"{name} has {bodies:,} bodies", "Export a single part")
    if solid.is_watertight and abs(solid.volume) < FLAT * solid.scale**3:
        yield Problem(path, f"{name} encloses no volume", EXPORT)
    elif solid.is_watertight and solid.volume < 0:
        yield Problem(path, f"{name} is inside out: its triangles face inwards", repair)


def _bodies(solid: "Trimesh") -> int:
    from trimesh.graph import connected_component_labels  # as above

    faces = len(solid.faces)
    labels = connected_component_labels(solid.face_adjacency, node_count=faces)  # type: ignore[no-untyped-call]
    a, b, c = np.moveaxis(solid.triangles - solid.bounds[0], 1, 0)
    volumes = np.bincount(labels, np.einsum("ij,ij->i", a, np.cross(b, c)))
    outer_triangles = solid.triangles[labels == volumes.argmax()]
    is_enclosing = np.array_equal(
        [outer_triangles.min((0, 1)), outer_triangles.max((0, 1))], solid.bounds
    )
    # Six times each body's signed volume: negative for a void, whose triangles face inwards.
    return 1 if is_enclosing and (volumes > 0).sum() == 1 else len(volumes)


def _absent(stranger: Stranger) -> Problem:
    return Problem(
        stranger.place,
        "a study of this kind cannot use a part from a file",
        'Write kind = "sweep", "optimise" or "sensitivity"',
    )


PART: Final = Section(
    beside=file_beside,
    resolve=with_part,
    unknown=lambda stranger: no_field(stranger, PartFile),
    absent=_absent,
)
"""The section `part`."""
