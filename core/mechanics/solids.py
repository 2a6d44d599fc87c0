"""A solid with a closed surface of triangles: its mass, its hull, and the ways in which it lies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

Floats = NDArray[np.float64]

SAME = 1e-9
"""Facets of the hull are one face up to this difference of their normals, and of their distances
from the centre relative to the size."""


@dataclass(frozen=True)
class Solid:
    """A solid of density 1: its volume [m3], centre [m], and moments of inertia about it [m5].

    `inertia` has the shape (3, 3), `points` (n, 3) are the corners of its surface.
    """

    points: Floats
    volume: float
    centre: Floats
    inertia: Floats


def solid_of(points: Floats, triangles: NDArray[np.int64]) -> Solid:
    """Return the solid inside a closed surface, whose triangles (m, 3) number points (n, 3) [m].

    Seen from outside their corners go round counter-clockwise. Each triangle and the origin span a
    tetrahedron; volume, first and second moments are sums over them (theory 16.5). The origin is
    moved into the middle before, which leaves no digits behind.
    """
    middle = (points.min(0) + points.max(0)) / 2
    corners = (points - middle)[triangles]
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    volume = volumes.sum()
    sums = corners.sum(1)
    centre = volumes @ sums / (4 * volume)
    # The covariance of a tetrahedron with a corner at the origin.
    second = np.einsum("i,ij,ik->jk", volumes, sums, sums)
    second += np.einsum("i,iaj,iak->jk", volumes, corners, corners)
    covariance = second / 20 - volume * np.outer(centre, centre)
    inertia = np.trace(covariance) * np.eye(3) - covariance
    return Solid(points, float(volume), centre + middle, inertia)


@dataclass(frozen=True)
class Aspect:
    """A way in which a solid lies on a face of its hull.

    Attributes
    ----------
    down : ndarray, shape (3,)
        The outward normal of the face, in the solid's own axes.
    outline : ndarray, shape (k, 2)
        Corners of the face around the foot of the centre of mass [m].
    silhouette : ndarray, shape (n, 2)
        The hull from above, in the same axes [m].
    let_down_share, thrown_share : float
        The shares of parts that come to rest on it [1]: the ends of the bracket.
    centre_height, height : float
        The height of the centre of mass, and of the solid [m].
    """

    down: Floats
    outline: Floats
    silhouette: Floats
    let_down_share: float
    thrown_share: float
    centre_height: float
    height: float


def aspects_of(solid: Solid) -> tuple[Aspect, ...]:
    """Return the ways in which a solid lies, the centre of mass of the first being the lowest.

    A let-down solid ends on the face through which its weight acts: the share of a face is the
    solid angle under which the centre sees it, over 4 pi. A face beside which the foot of the centre
    lies is unstable: its share goes on over the edge that the foot has passed, the highest first.
    Shares of thrown solids are as those times (R - h)^2 (theory 16.1).
    """
    points = solid.points - solid.centre
    hull = ConvexHull(points)
    points = points[hull.vertices]
    size = np.linalg.norm(points, axis=1).max()
    renumbered = np.full(len(solid.points), -1)
    renumbered[hull.vertices] = np.arange(len(hull.vertices))
    facets = renumbered[hull.simplices]
    normals, heights = hull.equations[:, :3], -hull.equations[:, 3]
    faces = _faces(hull, normals, heights / size)
    count = faces.max() + 1
    angles = np.bincount(faces, _solid_angles(points[facets]), count)
    # One facet speaks for each face: its largest, whose normal is the surest.
    areas = np.linalg.norm(np.cross(points[facets[:, 1]] - points[facets[:, 0]],
                                    points[facets[:, 2]] - points[facets[:, 0]]), axis=1)  # fmt: skip
    order = np.lexsort((-areas, faces))
    largest = order[np.searchsorted(faces[order], np.arange(count))]
    normal, height = normals[largest], heights[largest]
    passed, over = _crossed_edges(hull, facets, faces, points, normal, height)
    shares = angles / (4 * np.pi)
    for face in np.argsort(-height):
        if passed[face] > SAME * size:
            shares[over[face]] += shares[face]
            shares[face] = 0
    stable = np.flatnonzero(passed <= SAME * size)
    stable = stable[np.lexsort((-shares[stable], height[stable].round(12 - int(np.floor(np.log10(size))))))]
    weights = shares[stable] * (1 - height[stable] / size) ** 2
    thrown = weights / weights.sum()
    found = []
    for face, share in zip(stable, thrown, strict=True):
        axes = _axes(normal[face])
        flat = points @ axes.T
        corners = np.unique(facets[faces == face])
        outline = flat[corners]
        outline = outline[np.argsort(np.arctan2(*(outline - outline.mean(0)).T[::-1]))]
        found.append(
            Aspect(
                normal[face],
                outline,
                flat[ConvexHull(flat).vertices],
                float(shares[face]),
                float(share),
                float(height[face]),
                float(height[face] + (points @ -normal[face]).max()),
            )
        )
    return tuple(found)


def _faces(hull: ConvexHull, normals: Floats, heights: Floats) -> NDArray[np.int64]:
    facets = np.repeat(np.arange(len(normals)), 3)
    beside = hull.neighbors.ravel()
    same = np.abs(normals[facets] - normals[beside]).max(1) < SAME
    same &= np.abs(heights[facets] - heights[beside]) < SAME
    graph = coo_array((same[same], (facets[same], beside[same])), shape=(len(normals),) * 2)
    return connected_components(graph, directed=False)[1].astype(np.int64)


def _solid_angles(corners: Floats) -> Floats:
    # Van Oosterom and Strackee (1983).
    a, b, c = np.moveaxis(corners, 1, 0)
    lengths = np.linalg.norm(corners, axis=2).T
    dot = np.einsum
    volume = np.abs(dot("ij,ij->i", a, np.cross(b, c)))
    below = lengths.prod(0) + dot("ij,ij->i", a, b) * lengths[2]
    below += dot("ij,ij->i", b, c) * lengths[0] + dot("ij,ij->i", c, a) * lengths[1]
    return 2 * np.arctan2(volume, below)


def _crossed_edges(
    hull: ConvexHull, facets: NDArray[np.int64], faces: NDArray[np.int64],
    points: Floats, normal: Floats, height: Floats,
) -> tuple[Floats, NDArray[np.int64]]:  # fmt: skip
    """How far the foot of the centre lies beyond each face's edge, and the face behind that edge."""
    # The neighbour k of a facet lies opposite to its corner k.
    own = np.repeat(faces, 3)
    other = faces[hull.neighbors.ravel()]
    starts = facets[:, [1, 2, 0]].ravel()
    ends = facets[:, [2, 0, 1]].ravel()
    inner = facets.ravel()
    outer = own != other
    own, other, starts, ends, inner = (each[outer] for each in (own, other, starts, ends, inner))
    along = points[ends] - points[starts]
    outward = np.cross(along, normal[own])
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    outward *= -np.sign(np.einsum("ij,ij->i", outward, points[inner] - points[starts]))[:, None]
    foot = normal[own] * height[own, None]
    beyond = np.einsum("ij,ij->i", outward, foot - points[starts])
    order = np.lexsort((-beyond, own))
    first = order[np.searchsorted(own[order], np.arange(len(normal)))]
    return beyond[first], other[first]


def _axes(down: Floats) -> Floats:
    """Two axes of the floor, (2, 3)."""
    first = np.cross(down, np.eye(3)[np.abs(down).argmin()])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(down, first)])
