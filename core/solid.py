"""The aspects of a solid: the ways in which it lies on its hull, and how sure it stands.

An aspect is a way of lying: on a face of the hull, the foot of the centre of mass inside that face.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, QhullError
from trimesh import Trimesh

from vibrafeed.core.quantities.orienting import MAX_ASPECTS, PartAspect

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

SAME = 1e-6
"""Facets of the hull are one face up to this difference of their normals, and of their distances
from the centre as a share of the size: files of 32-bit numbers hold no more."""
ALIKE = 1e-5
"""Share of the size up to which a turned hull is the same hull."""
MAX_STABLE = 1_000
"""Stable faces, most of them facets of a rounded side, that are compared with each other."""
RISE, ROUNDED = 5e-3, np.cos(np.radians(12))
"""Facets are one rounded side if their normals differ by up to 12 degrees, and the centre rises by
less than this share of the size from one to the other."""
EQUAL = 1e-6
"""Share of the size, or of its square, up to which lengths and areas of rectangles are equal."""
COMPARED = 64
"""Corners by which a turned hull is compared."""
WORK = 100_000_000
"""Corners times faces that a comparison takes at most; hulls that need more are held to differ."""


class RoundedError(ValueError):
    """A solid that rests on too many faces, as the facets of a sphere."""


class Hull:
    """The convex hull of points about the origin, its facets joined to faces.

    Attributes
    ----------
    points : ndarray, shape (n, 3)
        Its corners.
    facets, faces : ndarray, shapes (m, 3) and (m,)
        The corners of each triangle by number, and the number of the face that it belongs to.
    normals, heights, middles : ndarray, shapes (k, 3), (k,) and (k, 3)
        The outward normal of each face, its distance from the origin, and its centre of area.
    size : float
        The distance of the farthest corner.
    """

    def __init__(self, points: Floats) -> None:
        # Q0: Qhull does not merge facets of one plane, whose time would grow as the square of the
        # corners of a fine round end.
        try:
            hull = ConvexHull(points, qhull_options="Q0")
        except QhullError:
            hull = ConvexHull(points)
        self.points: Floats = points[hull.vertices]
        self.size = float(np.linalg.norm(self.points, axis=1).max())
        renumbered = np.full(len(points), -1)
        renumbered[hull.vertices] = np.arange(len(hull.vertices))
        self.facets: Indices = renumbered[hull.simplices]
        self.beside: Indices = hull.neighbors  # the neighbour k lies opposite to the corner k
        normals, heights = hull.equations[:, :3], -hull.equations[:, 3]
        self.faces = self._joined(normals, heights)
        # A face has normal and height of its largest facet, which are the most accurate.
        a, b, c = np.moveaxis(self.points[self.facets], 1, 0)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
        largest = _first_of_each(self.faces, -areas)
        self.normals, self.heights = normals[largest], heights[largest]
        face_areas = np.bincount(self.faces, areas)
        moments = (np.bincount(self.faces, areas * coordinate) for coordinate in (a + b + c).T / 3)
        self.middles: Floats = np.stack([*moments], axis=1) / face_areas[:, None]

    def _joined(self, normals: Floats, heights: Floats) -> Indices:
        facets, beside = np.repeat(np.arange(len(normals)), 3), self.beside.ravel()
        same = np.abs(normals[facets] - normals[beside]).max(1) < SAME
        same &= np.abs(heights[facets] - heights[beside]) < SAME * self.size
        return _linked(facets[same], beside[same], len(normals))

    def solid_angles(self) -> Floats:
        """Return the share of all directions in which the origin sees each face [1]."""
        # tan(W/2) = |a.(b x c)|/(abc + (a.b)c + (b.c)a + (c.a)b) of a triangle with corners a, b,
        # c (Van Oosterom and Strackee 1983).
        corners = self.points[self.facets]
        a, b, c = np.moveaxis(corners, 1, 0)
        lengths = np.linalg.norm(corners, axis=2).T
        dot = np.einsum
        numerator = np.abs(dot("ij,ij->i", a, np.cross(b, c)))
        denominator = lengths.prod(0) + dot("ij,ij->i", a, b) * lengths[2]
        denominator += dot("ij,ij->i", b, c) * lengths[0] + dot("ij,ij->i", c, a) * lengths[1]
        angles = np.bincount(self.faces, 2 * np.arctan2(numerator, denominator), len(self.heights))
        return angles / (4 * np.pi)

    @cached_property
    def rims(self) -> "Rims":
        """The edges of all faces."""
        face, face_beyond = np.repeat(self.faces, 3), self.faces[self.beside.ravel()]
        is_edge = face != face_beyond
        face, face_beyond = face[is_edge], face_beyond[is_edge]
        starts, ends = (
            self.points[self.facets[:, k].ravel()[is_edge]] for k in ([1, 2, 0], [2, 0, 1])
        )
        to_middle = self.middles[face] - starts
        outward = np.cross(ends - starts, self.normals[face])
        outward /= np.linalg.norm(outward, axis=1)[:, None]
        outward *= -np.sign(np.einsum("ij,ij->i", outward, to_middle))[:, None]
        origin_foot = self.normals[face] * self.heights[face, None] - starts
        beyond = np.einsum("ij,ij->i", outward, origin_foot)
        return Rims(face, face_beyond, beyond, -np.einsum("ij,ij->i", outward, to_middle))

    @cached_property
    def edge_distances(self) -> Floats:
        """The distance of the origin's foot from the nearest edge of each face; below 0 outside."""
        return -self.rims.beyond[_first_of_each(self.rims.own, -self.rims.beyond)]

    @cached_property
    def ends(self) -> Indices:
        """The face on which the solid comes to rest from each face, the same where that is stable.

        From an unstable face it rolls on over the edge that the line from the middle of the face to
        the foot crosses, onto a face that is nearer to the centre.
        """
        rims = self.rims
        next_face = rims.other[_first_of_each(rims.own, -rims.beyond / rims.inside)]
        ends = np.arange(len(self.heights))
        for face in np.argsort(self.heights):
            if self.edge_distances[face] < -SAME * self.size:
                ends[face] = ends[next_face[face]]
        return ends

    def joined_ends(self) -> Indices:
        """Return a number for each face that faces share on whose rounded side the solid rests."""
        rims, ends = self.rims, self.ends
        # The rise from the lower of both ends, as a saddle between two aspects is near the other.
        lower_end = np.minimum(self.heights[ends[rims.own]], self.heights[ends[rims.other]])
        rise = np.hypot(self.heights[rims.own], rims.beyond) - lower_end
        cosine = np.einsum("ij,ij->i", self.normals[rims.own], self.normals[rims.other])
        is_low = (rise < RISE * self.size) & (cosine > ROUNDED)
        return _linked(ends[rims.own[is_low]], ends[rims.other[is_low]], len(self.heights))

    def is_same_turned(self, down: Floats, other: Floats) -> bool:
        """True if a rotation that turns the direction `down` to `other` maps the hull to itself.

        A farthest corner from the axis has to come to another one as far and as high; then no
        corner may lie outside.
        """
        before, after = (self.points @ _frame(direction).T for direction in (down, other))
        reach = np.hypot(*before[:, :2].T)
        tolerance = ALIKE * self.size
        # The highest of the farthest corners, as rounding may leave several on one edge.
        farthest = np.where(reach > reach.max() - tolerance, before[:, 2], -np.inf).argmax()
        candidates = np.abs(np.hypot(*after[:, :2].T) - reach[farthest]) < tolerance
        candidates &= np.abs(after[:, 2] - before[farthest, 2]) < tolerance
        sample = before[:: max(1, len(before) // COMPARED)]
        max_tries = 1 + WORK // (len(sample) * len(self.heights))
        for x, y, _ in after[candidates][:max_tries]:
            turn = np.arctan2(y, x) - np.arctan2(before[farthest, 1], before[farthest, 0])
            cos, sin = np.cos(turn), np.sin(turn)
            turned_sample = (
                sample @ np.array([[cos, sin, 0], [-sin, cos, 0], [0, 0, 1]]) @ _frame(other)
            )
            if (turned_sample @ self.normals.T - self.heights).max() < tolerance:
                return True
        return False


class Rims(NamedTuple):
    """The edges of faces: each has two, one of either face.

    The faces `own`, and `other` behind the edge; the distance `beyond` the edge of the origin's
    foot on `own`, and that of the middle of `own` inside it.
    """

    own: Indices
    other: Indices
    beyond: Floats
    inside: Floats


def _linked(first: Indices, second: Indices, count: int) -> Indices:
    graph = coo_array((np.ones(len(first), bool), (first, second)), shape=(count, count))
    return connected_components(graph, directed=False)[1].astype(np.int64)


def _first_of_each(groups: Indices, order: Floats) -> Indices:
    """Return the place of the least `order` in each of the groups 0, 1, ..."""
    sorted_ = np.lexsort((order, groups))
    return sorted_[np.searchsorted(groups[sorted_], np.arange(groups.max() + 1))]


def _frame(down: Floats) -> Floats:
    """Two axes of the floor, and the one upwards: a right-handed frame, rows (3, 3)."""
    first = np.cross(down, np.eye(3)[np.abs(down).argmin()])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(-down, first), -down])


def aspects_of(solid: Trimesh) -> tuple[PartAspect, ...]:
    """Return the aspects of a solid, the centre of mass of the first being the lowest.

    A let-down solid ends on the face through which its weight acts: the share of a face is the
    solid angle under which the centre sees it, over 4 pi. If the foot of the centre lies beside it,
    the face is unstable, and its share goes on over the edge that the foot has passed. Shares of
    thrown solids are as those times (R - h)^2 (theory 16.1). Facets of one rounded side, and faces
    that a rotation of the hull turns to each other, are one aspect.

    Raises
    ------
    RoundedError
        If there are more than `MAX_ASPECTS`.
    """
    hull = Hull(solid.vertices - solid.center_mass)
    gyration = solid.moment_inertia / solid.volume
    sides = hull.joined_ends()
    angles = np.bincount(sides[hull.ends], hull.solid_angles(), len(sides))
    shares = angles.astype(np.float64)[sides]
    faces = np.unique(hull.ends)
    # By height, where heights within rounding are equal, then the larger share first.
    faces = faces[np.lexsort((-shares[faces], (hull.heights[faces] / hull.size / ALIKE).round()))]
    faces = faces[np.sort(np.unique(sides[faces], return_index=True)[1])]
    groups = _groups_of_turned_faces(hull, faces, shares)
    let_down_shares = np.array([shares[group].sum() for group in groups])
    thrown_weights = let_down_shares * [
        (1 - hull.heights[group[0]] / hull.size) ** 2 for group in groups
    ]
    return tuple(
        _aspect(hull, gyration, group[0], float(let_down_share), float(thrown_share))
        for group, let_down_share, thrown_share in zip(
            groups, let_down_shares, thrown_weights / thrown_weights.sum(), strict=True
        )
    )


def _groups_of_turned_faces(hull: Hull, faces: Indices, shares: Floats) -> list[list[int]]:
    # Stable faces that a rotation of the hull turns into each other are one group.
    groups: list[list[int]] = []
    for face in faces[: MAX_STABLE + 1]:
        for group in groups:
            first_face = group[0]
            is_equal = abs(hull.heights[face] - hull.heights[first_face]) < ALIKE * hull.size
            is_equal &= abs(shares[face] - shares[first_face]) < ALIKE
            if is_equal and hull.is_same_turned(hull.normals[face], hull.normals[first_face]):
                group.append(int(face))
                break
        else:
            groups.append([int(face)])
        if len(groups) > MAX_ASPECTS or len(faces) > MAX_STABLE:
            raise RoundedError(f"the part rests on {len(faces):,} faces of its hull")
    return groups


def _aspect(hull: Hull, gyration: Floats, face: int, let_down: float, thrown: float) -> PartAspect:
    down, height = hull.normals[face], hull.heights[face]
    axes = _frame(down)
    in_plane = hull.points @ axes[:2].T
    base = in_plane[np.unique(hull.facets[hull.faces == face])]
    length, width, along = _least_rectangle(in_plane, base, hull.size)
    across = np.array([-along[1], along[0]])
    rolling_axis = across @ axes[:2]
    return PartAspect(
        let_down_share=let_down,
        thrown_share=thrown,
        height=float(height + (hull.points @ -down).max()),
        centre_height=float(height),
        length=length,
        width=width,
        base_along=_reach(base, along),
        base_across=_reach(base, across),
        base_least=max(0.0, float(hull.edge_distances[face])),
        gyration=float(np.sqrt(rolling_axis @ gyration @ rolling_axis)),
        down=(float(down[0]), float(down[1]), float(down[2])),
        along=tuple(map(float, along @ axes[:2])),  # type: ignore[arg-type] # three of them
    )


def _reach(base: Floats, direction: Floats) -> float:
    """The shorter distance from the foot of the centre to both ends of the base."""
    positions = base @ direction
    return float(min(positions.max(), -positions.min()))


def _least_rectangle(points: Floats, base: Floats, size: float) -> tuple[float, float, Floats]:
    """The least rectangle about points in a plane: length, width, direction of its length.

    It has a side on their hull. Of equal ones it is that of the shorter base, which topples first.
    """
    corners = points[ConvexHull(points).vertices]
    sides = np.roll(corners, -1, axis=0) - corners
    sides /= np.hypot(*sides.T)[:, None]
    normals = np.stack([-sides[:, 1], sides[:, 0]], axis=1)
    lengths, widths = (
        _farthest(corners, directions) + _farthest(corners, -directions)
        for directions in (sides, normals)
    )
    along = np.where((lengths >= widths)[:, None], sides, normals)
    from_middle = base - base.mean(axis=0)
    ring = base[np.argsort(np.arctan2(from_middle[:, 1], from_middle[:, 0]))]
    half_base = np.minimum(_farthest(ring, along), _farthest(ring, -along))
    areas = lengths * widths
    half_base = np.where(areas < areas.min() + EQUAL * size**2, half_base, np.inf)
    best = np.flatnonzero(half_base < half_base.min() + EQUAL * size)[0]
    width, length = sorted((float(lengths[best]), float(widths[best])))
    return length, width, along[best]


def _farthest(corners: Floats, directions: Floats) -> Floats:
    sides = np.roll(corners, -1, axis=0) - corners
    side_angles = np.unwrap(np.arctan2(sides[:, 1], sides[:, 0]))
    # A side at a right angle to the direction ends in the farthest corner.
    right_angle = np.arctan2(directions[:, 0], -directions[:, 1])
    side_number = np.searchsorted(
        side_angles, side_angles[0] + (right_angle - side_angles[0]) % (2 * np.pi)
    )
    return np.asarray(np.einsum("ij,ij->i", corners[side_number % len(corners)], directions))
