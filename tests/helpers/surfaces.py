"""Surfaces of parts as texts, as studies from the network have them."""

from __future__ import annotations

from collections.abc import Iterable

import trimesh


def as_data(mesh: trimesh.Trimesh) -> dict[str, str]:
    """Return the section `part` of a study that has a surface, in mm, as an ASCII STL."""
    return {"data": mesh.export(file_type="stl_ascii"), "unit": "mm"}


def box(*sizes: float) -> dict[str, str]:
    """Return the section `part` with a box of such sizes [mm]."""
    return as_data(trimesh.creation.box(sizes))


HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
)
HEADER += "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
PRODUCT = """APPLICATION_CONTEXT('automotive design')
PRODUCT_CONTEXT('',#1,'mechanical')
PRODUCT('part','part','',(#2))
PRODUCT_DEFINITION_FORMATION('','',#3)
PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design')
PRODUCT_DEFINITION('design','',#4,#5)
PRODUCT_DEFINITION_SHAPE('','',#6)
(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))
(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))
(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())
(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#8,#9,#10))REPRESENTATION_CONTEXT('',''))
CARTESIAN_POINT('',(0.,0.,0.))
DIRECTION('',(0.,0.,1.))
DIRECTION('',(1.,0.,0.))
AXIS2_PLACEMENT_3D('',#12,#13,#14)"""


def as_step(mesh: trimesh.Trimesh) -> str:
    """Return a surface, in mm, as the text of a STEP file (ISO 10303-21, AP214): plane faces."""
    lines = PRODUCT.splitlines()

    def entity(text: str) -> str:
        lines.append(text)
        return f"#{len(lines)}"

    def triple(kind: str, values: Iterable[float]) -> str:
        return entity(f"{kind}('',({','.join(f'{value:.9f}' for value in values)}))")

    points = [triple("CARTESIAN_POINT", corner) for corner in mesh.vertices]
    faces = []
    for face, normal in zip(mesh.faces, mesh.face_normals, strict=True):
        along = triple("DIRECTION", mesh.vertices[face[1]] - mesh.vertices[face[0]])
        axes = f"{points[face[0]]},{triple('DIRECTION', normal)},{along}"
        placement = entity(f"AXIS2_PLACEMENT_3D('',{axes})")
        plane = entity(f"PLANE('',{placement})")
        loop = entity(f"POLY_LOOP('',({','.join(points[k] for k in face)}))")
        bound = entity(f"FACE_OUTER_BOUND('',{loop},.T.)")
        faces.append(entity(f"FACE_SURFACE('',({bound}),{plane},.T.)"))
    shell = entity(f"CLOSED_SHELL('',({','.join(faces)}))")
    solid = entity(f"FACETED_BREP('',{shell})")
    shape = entity(f"FACETED_BREP_SHAPE_REPRESENTATION('',(#15,{solid}),#11)")
    entity(f"SHAPE_DEFINITION_REPRESENTATION(#7,{shape})")
    numbered = "\n".join(f"#{k}={line};" for k, line in enumerate(lines, 1))
    return f"{HEADER}{numbered}\nENDSEC;\nEND-ISO-10303-21;\n"
