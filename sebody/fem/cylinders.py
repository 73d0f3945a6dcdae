"""Cylinders among the outer faces of a mesh, and the middles of sets of faces.

The corners of faces lie on the surface that was meshed, whatever the faces themselves do: nodes in
the middles of straight edges and facets lie within it.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.face_functions import face_rule
from sebody.fem.faces import faces_within, normals
from sebody.fem.model import FEModel

ROUND = 2e-3        # of the radius, by which corners may be off a cylinder
_OFF = 0.02         # the same of the size of a face, where a cylinder is typed
_ARC = 0.05         # mean square of the normals' second direction, of an arc of some 45 degrees
_RADIAL = 0.8       # least cosine between the normal of a facet and the arm of its middle
_CORNERS = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4, "line": 2, "line3": 2}


class Cylinder(NamedTuple):
    """A cylinder, in a plane a circle, whose axis is empty."""

    point: NDArray      # on the axis [length]
    axis: NDArray       # unit vector
    radius: float

    def off(self, points: NDArray) -> NDArray:
        """Distances of points (n, D) from the surface, outside positive."""
        return np.linalg.norm(self.arms(points), axis=1) - self.radius

    def arms(self, points: NDArray) -> NDArray:
        """From the axis to points, across it."""
        away = points - self.point
        return away - np.outer(away @ self.axis, self.axis) if len(self.axis) else away

    def foot(self, point: NDArray) -> NDArray:
        """The point of the axis next to another point."""
        return self.point + (point - self.point) @ self.axis * self.axis if len(self.axis) else (
            self.point)


class Middle(NamedTuple):
    """The middle of some faces; of a cylinder that they lie on, on its axis."""

    point: NDArray
    cylinder: Cylinder | None


class _Facets(NamedTuple):
    """Faces of all kinds: their corners, middles, unit normals and areas."""

    corners: NDArray        # (c,) of int, of all faces, each once
    places: list[NDArray]   # of the corners of each face
    nodes: list[NDArray]    # of each face
    middles: NDArray        # (m, D)
    normals: NDArray        # (m, D)
    areas: NDArray          # (m,)


def middle_of(model: FEModel, nodes: Iterable[int]) -> Middle | None:
    """The centroid of the outer faces within some nodes, or the middle of the cylinder they are on.

    It does not depend on how fine the mesh is where; None where no face lies within the nodes.
    """
    facets = _facets(model, nodes)
    if facets is None:
        return None
    centroid = facets.areas @ facets.middles / facets.areas.sum()
    cylinder = _fitted(model, facets)
    return Middle(centroid if cylinder is None else cylinder.foot(centroid), cylinder)


def nodes_on_cylinder_faces(model: FEModel, point: ArrayLike, axis: ArrayLike, radius: float,
                            length: float | None = None) -> tuple[int, ...]:
    """Nodes of the outer faces on a cylinder, such as the wall of a hole.

    Parameters
    ----------
    point, axis : (3,)
        On the axis, the middle of `length` [length].
    radius, length : float
        The cylinder is endless without a length [length].

    Raises
    ------
    InputError
        No such faces; the message names the radii that there are about this axis.
    """
    point, axis = inputs.vector(point, "point of a cylinder", 3), inputs.vector(
        axis, "axis of a cylinder", 3)
    if not np.linalg.norm(axis) > 0:
        raise inputs.refusal("axis of a cylinder", axis, "give a direction")
    wanted = Cylinder(point, axis / np.linalg.norm(axis),
                      inputs.number(radius, "radius of a cylinder", above=0))
    facets = _facets(model, range(len(model.coordinates)))
    if facets is None:
        raise InputError("the FE model has no cells, so it has no faces on a cylinder: name its "
                         "nodes as a set")
    taken = _on(wanted, facets, length)
    if not taken.any():
        raise InputError(f"no outer faces are on the cylinder of radius {radius:g} about the axis "
                         f"{wanted.axis} through {point}: {_radii(wanted, facets, length)}")
    return tuple(np.unique(np.concatenate(
        [own for own, take in zip(facets.nodes, taken, strict=True) if take])).tolist())


def _facets(model: FEModel, nodes: Iterable[int]) -> _Facets | None:
    places, owners, middles, directions, corners = [], [], [], [], []
    for kind, faces in faces_within(model, nodes):
        points = model.coordinates[faces]
        values, slopes, weights = face_rule(kind)
        own = normals(points, slopes) * weights[:, None]
        areas = np.linalg.norm(own, axis=2)
        moments = np.einsum("fg,ga,fad->fd", areas, values, points)
        middles.append(moments / areas.sum(axis=1)[:, None])
        directions.append(own.sum(axis=1))
        corners.append(faces[:, :_CORNERS[kind]].ravel())
        places += list(points[:, :_CORNERS[kind]])
        owners += list(faces)
    if not places:
        return None
    directions = np.concatenate(directions)
    areas = np.linalg.norm(directions, axis=1)
    return _Facets(np.unique(np.concatenate(corners)), places, owners, np.concatenate(middles),
                   directions / areas[:, None], areas)


def _fitted(model: FEModel, facets: _Facets) -> Cylinder | None:
    """The cylinder that all corners lie on, if there is one and they see enough of it."""
    points = model.coordinates[facets.corners]
    squares, turn = np.linalg.eigh(
        np.einsum("f,fi,fj->ij", facets.areas / facets.areas.sum(), facets.normals,
                  facets.normals))
    planar = points.shape[1] == 2
    if len(points) < 5 or squares[0 if planar else 1] < _ARC:
        return None
    cylinder = _circle(points) if planar else _cylinder(points, turn[:, 0])
    off = np.abs(cylinder.off(points)).max()
    arms = cylinder.arms(facets.middles)
    radial = np.abs(np.einsum("fd,fd->f", facets.normals, arms)) / np.maximum(
        np.linalg.norm(arms, axis=1), 1e-300)
    return cylinder if off <= ROUND * cylinder.radius and radial.min() >= _RADIAL else None


def _circle(points: NDArray) -> Cylinder:
    """The circle through points (n, 2) in least squares of ``|x|^2 = 2 c . x + r^2 - |c|^2``."""
    middle = points.mean(axis=0)
    away = points - middle
    size = np.abs(away).max()
    rows = np.column_stack([2 * away / size, np.ones(len(away))])
    c = np.linalg.lstsq(rows, ((away / size)**2).sum(axis=1), rcond=None)[0]
    radius = np.sqrt(max(c[2] + c[:2] @ c[:2], 0.0))
    return Cylinder(middle + size * c[:2], np.zeros(0), float(size * radius))


def _cylinder(points: NDArray, axis: NDArray) -> Cylinder:
    """The cylinder through points (n, 3), from a guess of its axis."""
    middle = points.mean(axis=0)
    size = np.abs(points - middle).max()
    across = np.linalg.svd(axis[None])[2][1:]
    flat = _circle((points - middle) @ across.T)
    start = np.array([0.0, 0.0, *(flat.point / size), flat.radius / size])

    def made(x: NDArray) -> Cylinder:
        tilted = axis + x[:2] @ across
        return Cylinder(middle + size * (x[2:4] @ across), tilted / np.linalg.norm(tilted),
                        float(size * x[4]))
    best = least_squares(lambda x: made(x).off(points) / size, start, xtol=1e-15, ftol=1e-15,
                         gtol=1e-15)
    return made(best.x)


def _on(cylinder: Cylinder, facets: _Facets, length: float | None) -> NDArray:
    """Faces whose corners all lie on a cylinder."""
    # a point that is typed is off the axis by a little, beside the size of the faces
    room = max(ROUND * cylinder.radius, _OFF * float(np.sqrt(np.median(facets.areas))))
    lies_on = np.array([np.abs(cylinder.off(corners)).max() <= room for corners in facets.places])
    if length is not None:
        half = inputs.number(length, "length of a cylinder", above=0) / 2 + room
        lies_on &= np.array([np.abs((corners - cylinder.point) @ cylinder.axis).max() <= half
                             for corners in facets.places])
    return lies_on


def _radii(cylinder: Cylinder, facets: _Facets, length: float | None) -> str:
    """Radii of the outer faces about an axis, in words."""
    radii = []
    for own, normal, middle in zip(facets.places, facets.normals, facets.middles, strict=True):
        arms = np.linalg.norm(cylinder.arms(own), axis=1)
        one = Cylinder(cylinder.point, cylinder.axis, float(arms.mean()))
        arm = one.arms(middle[None])[0]
        if np.ptp(arms) <= ROUND * one.radius and (
                abs(normal @ arm) >= _RADIAL * np.linalg.norm(arm)):
            radii.append(one.radius)
    sizes = sorted({float(f"{radius:.4g}") for radius in radii})
    if not sizes:
        return "no outer faces are about this axis; correct its point and direction"
    within = "" if length is None else ", or give a larger length"
    return f"those about this axis have the radii {', '.join(f'{r:g}' for r in sizes[:8])}{within}"
