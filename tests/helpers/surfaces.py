"""Surfaces of parts as texts, as studies from the network have them."""

from __future__ import annotations

import trimesh


def as_data(mesh: trimesh.Trimesh) -> dict[str, str]:
    """Return the section `part` of a study that has a surface, in mm, as an ASCII STL."""
    return {"data": mesh.export(file_type="stl_ascii"), "unit": "mm"}


def box(*sizes: float) -> dict[str, str]:
    """Return the section `part` with a box of such sizes [mm]."""
    return as_data(trimesh.creation.box(sizes))
