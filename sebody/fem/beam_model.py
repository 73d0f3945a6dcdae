"""FE models of beam elements: matrices, mass field and geometric stiffness."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.vectors import skew
from sebody.fem import beam_element
from sebody.fem.beam_stress import BeamStress
from sebody.fem.layout import PLANAR, SPATIAL
from sebody.fem.mass_field import MassField
from sebody.fem.materials import Material
from sebody.fem.matrices import assemble
from sebody.fem.model import FEModel
from sebody.fem.section import StiffnessSection

_IN_PLANE = np.array([0, 1, 5, 6, 7, 11])  # DOFs of an element in the xy plane


def beam_model(nodes: NDArray, pairs: NDArray, lengths: NDArray, axes: NDArray,
               sections: Sequence[StiffnessSection]) -> FEModel:
    """Assemble one element for each pair of nodes.

    Parameters
    ----------
    nodes : (n_nodes, 3), planar (n_nodes, 2)
    pairs : (n, 2)
        Nodes at the ends of each element.
    lengths : (n,)
    axes : (n, 3, 3)
        Rows: the element's axis x and its section's axes y and z.
    sections : sequence of n StiffnessSection
    """
    planar = nodes.shape[1] == 2
    node_dofs = PLANAR if planar else SPATIAL
    elements = _elements(pairs, lengths, axes, sections, planar)
    size = len(nodes) * len(node_dofs)
    matrices = []
    for local in (elements.stiffness, elements.mass):
        matrix = elements.turns.transpose(0, 2, 1) @ local @ elements.turns
        matrix = (matrix + matrix.transpose(0, 2, 1)) / 2
        matrices.append(assemble(elements.dofs, matrix, size))
    return FEModel(*matrices, nodes, node_dofs, materials=_materials(sections),
                   mass_field=_mass_field(elements, nodes, pairs, size),
                   geometric_stiffness=BeamPrestress(elements, size), cells=[("line", pairs)],
                   stress=_stresses(elements, pairs, sections), outlines=_outlines(sections, axes))


def _materials(sections: Sequence[StiffnessSection]) -> list[Material]:
    """What the sections are made of: EA over the mass a length is E over the density."""
    speeds = {np.sqrt(section.axial / section.mass): None for section in dict.fromkeys(sections)}
    return [Material("of a section", float(speed)) for speed in speeds]


def _outlines(sections: Sequence[StiffnessSection], axes: NDArray) -> NDArray:
    """Edges of the elements' sections, (n, corners, 3), about the axis in axes of the model.

    Of sections with fewer corners than others the last one is repeated.
    """
    edges = [np.array(section.outline or _equivalent(section)) for section in sections]
    most = max(map(len, edges))
    corners = np.array([np.pad(edge, ((0, most - len(edge)), (0, 0)), "edge") for edge in edges])
    return corners @ axes[:, 1:]


def _equivalent(section: StiffnessSection) -> list[tuple[float, float]]:
    """Rectangle with the radii of gyration of a section."""
    y, z = (np.sqrt(3 * bending / section.axial)
            for bending in (section.bending_z, section.bending_y))
    return [(-y, -z), (y, -z), (y, z), (-y, z)]


@dataclass(frozen=True, eq=False)
class _Elements:
    """All elements; k of the 12 DOFs of each are DOFs of the model, in its axes.

    Parameters
    ----------
    dofs : (n, k)
    turns : (n, 12, k)
        From DOFs of the model to those of the element, in the axes of its section.
    lengths : (n,)
    stiffness, mass : (n, 12, 12)
    values, slopes : (n, g, 6, 12)
        Interpolation at g points along each.
    inertia : (n, 6)
        Mass and rotary inertia a length.
    """

    dofs: NDArray
    turns: NDArray
    lengths: NDArray
    stiffness: NDArray
    mass: NDArray
    values: NDArray
    slopes: NDArray
    inertia: NDArray


def _elements(pairs: NDArray, lengths: NDArray, axes: NDArray,
              sections: Sequence[StiffnessSection], planar: bool) -> _Elements:
    known = {}      # elements of equal section and length share their matrices
    for key in zip(sections, lengths, strict=True):
        if key not in known:
            known[key] = (beam_element.stiffness(*key), beam_element.mass(*key),
                          *beam_element.interpolation(*key, beam_element.PLACES),
                          beam_element.point_inertia(key[0]))
    arrays = [np.array(a) for a in zip(*(known[key] for key in zip(sections, lengths,
                                                                   strict=True)), strict=True)]
    kept = _IN_PLANE if planar else np.arange(12)
    turns = np.zeros((len(pairs), 12, 12))
    for first in range(0, 12, 3):
        turns[:, first:first + 3, first:first + 3] = axes
    width = len(kept) // 2
    dofs = (width * pairs[:, :, None] + np.arange(width)).reshape(len(pairs), -1)
    return _Elements(dofs, turns[:, :, kept], lengths, *arrays)


def _stresses(elements: _Elements, pairs: NDArray, sections: Sequence[StiffnessSection]
              ) -> tuple[BeamStress, ...]:
    """One operator for the elements with equally many fibres."""
    forces = (elements.stiffness @ elements.turns).reshape(len(pairs), 2, 6, -1)
    forces[:, 0] *= -1      # of the part that lies before the first end on the element
    counts, operators = np.array([len(one.fibres) for one in sections]), []
    for count in np.unique(counts):
        these = np.flatnonzero(counts == count)
        fibres = [[fibre.stress for fibre in sections[k].fibres] for k in these]
        offsets = [[(fibre.y, fibre.z) for fibre in sections[k].fibres] for k in these]
        operators.append(BeamStress(pairs[these], forces[these],
                                    np.array(fibres, dtype=float).reshape(len(these), count, 3, 6),
                                    np.array(offsets, dtype=float).reshape(len(these), count, 2)))
    return tuple(operators)


def _mass_field(elements: _Elements, nodes: NDArray, pairs: NDArray, size: int) -> MassField:
    """The points of the elements' integration, with displacement and rotation in model axes."""
    dimension = nodes.shape[1]
    count, per_element = elements.values.shape[:2]
    places = beam_element.PLACES[:, None]
    points = nodes[pairs[:, 0], None] * (1 - places) + nodes[pairs[:, 1], None] * places
    axes = np.zeros((count, 3, 3))
    axes[:, :, :dimension] = elements.turns[:, :3, :dimension]
    weights = elements.lengths[:, None] * beam_element.WEIGHTS
    fields = elements.values @ elements.turns[:, None]      # in section axes
    along = np.einsum("eji,egja->egia", axes, fields[:, :, :3])[:, :, :dimension]
    inertia = elements.inertia[:, None, 3:] * weights[:, :, None]
    if dimension == 2:
        about, inertia = fields[:, :, 5:], inertia[:, :, 2:, None]
    else:
        about = np.einsum("eji,egja->egia", axes, fields[:, :, 3:])
        inertia = np.einsum("eji,egj,ejk->egik", axes, inertia, axes)
    masses = (elements.inertia[:, [0]] * weights).ravel()
    return MassField(
        points.reshape(-1, dimension), _rows(along, elements.dofs, size),
        sparse.csr_array(sparse.diags_array(masses)), _rows(about, elements.dofs, size),
        inertia.reshape(count * per_element, *inertia.shape[2:]))


def _rows(fields: NDArray, dofs: NDArray, size: int) -> sparse.csr_array:
    """Rows (n, g, c, k) of the elements' DOFs as rows of all DOFs, (n g c, size)."""
    rows = fields[0, :, :, 0].size * len(fields)
    columns = np.broadcast_to(dofs[:, None, None, :], fields.shape)
    pointers = np.arange(rows + 1) * fields.shape[-1]
    return sparse.csr_array((fields.ravel(), columns.ravel(), pointers), shape=(rows, size))


class BeamPrestress:
    """Geometric stiffness of beam elements under the resultants of a displacement.

    With the strains of Simo and Reissner (J.C. Simo, Comput. Methods Appl. Mech. Engrg 49, 1985),
    ``Gamma = exp(-psi) (e1 + u') - e1`` and ``kappa = T(psi) psi'``, to second order in
    displacement u and rotation vector psi, forces F and moments M of the prestress have the energy

        V3 = integral F . (psi x (psi x e1) / 2 - psi x u') - M . (psi x psi') / 2,

    all in the axes of the section. Its second derivative, with the interpolation of the elements,
    is exact: displacements of second order between the nodes do no work to third order.
    """

    def __init__(self, elements: _Elements, size: int):
        self._dofs, self._size = elements.dofs, size
        values, slopes = elements.values, elements.slopes
        local = np.concatenate([values[:, :, 3:], slopes], axis=2)  # psi, u', psi'
        self._fields = local @ elements.turns[:, None]
        self._weights = elements.lengths[:, None] * beam_element.WEIGHTS
        self._levers = elements.lengths[:, None] * (1 - beam_element.PLACES)
        self._end_forces = (elements.stiffness @ elements.turns)[:, 6:]

    def __call__(self, displacement: NDArray) -> sparse.csc_array:
        """Geometric stiffness (n_dofs, n_dofs) of the displacement (n_dofs,) of a prestress."""
        end = np.einsum("eij,ej->ei", self._end_forces, displacement[self._dofs])
        force = np.broadcast_to(end[:, None, :3], (*self._weights.shape, 3))
        moment = end[:, None, 3:] + self._levers[:, :, None] * np.cross([1.0, 0, 0], force)
        energy = self._weights[:, :, None, None] * _second_derivative(force, moment)
        flat = (len(energy), -1, self._fields.shape[-1])
        weighed = (energy @ self._fields).reshape(flat)
        matrices = self._fields.reshape(flat).transpose(0, 2, 1) @ weighed
        return assemble(self._dofs, (matrices + matrices.transpose(0, 2, 1)) / 2, self._size)


def _second_derivative(force: NDArray, moment: NDArray) -> NDArray:
    """Second derivative (..., 9, 9) of the density of V3 with respect to (psi, u', psi')."""
    result = np.zeros((*force.shape[:-1], 9, 9))
    psi, stretch, bend = slice(0, 3), slice(3, 6), slice(6, 9)
    first = np.eye(3)[0]
    mixed = force[..., :, None] * first
    result[..., psi, psi] = ((mixed + np.swapaxes(mixed, -1, -2)) / 2
                             - force[..., :1, None] * np.eye(3))
    for columns, cross in ((stretch, skew(force)), (bend, skew(moment) / 2)):
        result[..., psi, columns] = cross
        result[..., columns, psi] = np.swapaxes(cross, -1, -2)
    return result
