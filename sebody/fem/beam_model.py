"""FE models of beam elements: matrices, mass field, geometric stiffness, damping and stresses."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.vectors import skew
from sebody.fem.beam_elements import BeamElements
from sebody.fem.beam_stress import BeamStress
from sebody.fem.general_section import GeneralSection
from sebody.fem.layout import PLANAR, SPATIAL
from sebody.fem.mass_field import MassField
from sebody.fem.materials import Material
from sebody.fem.matrices import assemble
from sebody.fem.model import FEModel
from sebody.fem.section import StiffnessSection

AnyStiffness = StiffnessSection | GeneralSection


def beam_model(nodes: NDArray, groups: Sequence[BeamElements], pairs: NDArray, axes: NDArray,
               sections: Sequence[AnyStiffness]) -> FEModel:
    """Assemble groups of elements.

    Parameters
    ----------
    nodes : (n_nodes, 3), planar (n_nodes, 2)
    groups : sequence of BeamElements
    pairs : (n, 2)
        Nodes at the ends of all elements, in the order of the cells.
    axes : (n, 3, 3)
        Rows: the axis of each in its middle and the section's axes y and z there.
    sections : sequence of n StiffnessSection or GeneralSection
        In the middle of each.
    """
    node_dofs = PLANAR if nodes.shape[1] == 2 else SPATIAL
    size = len(nodes) * len(node_dofs)
    stiffness, mass, damping = (
        sum(assemble(group.dofs, getattr(group, name), size) for group in groups)
        for name in ("stiffness", "mass", "damping"))
    if not any(group.damping.any() for group in groups):
        damping = None
    return FEModel(stiffness, mass, nodes, node_dofs, materials=_materials(sections),
                   mass_field=_mass_field(groups, size), damping=damping,
                   geometric_stiffness=BeamPrestress(groups, size), cells=[("line", pairs)],
                   stress=_stresses(groups), outlines=_outlines(sections, axes))


def _materials(sections: Sequence[AnyStiffness]) -> list[Material]:
    """Materials of the sections: EA over the mass a length is E over the density."""
    speeds = {section.wave_speed: None for section in dict.fromkeys(sections)}
    return [Material("of a section", speed) for speed in speeds]


def _outlines(sections: Sequence[AnyStiffness], axes: NDArray) -> NDArray:
    """Edges of the elements' sections, (n, corners, 3), about the axis in axes of the model.

    Of sections with fewer corners than others the last one is repeated.
    """
    edges = [np.array(section.outline or _equivalent(section)) for section in sections]
    most = max(map(len, edges))
    corners = np.array([np.pad(edge, ((0, most - len(edge)), (0, 0)), "edge") for edge in edges])
    return corners @ axes[:, 1:]


def _equivalent(section: AnyStiffness) -> list[tuple[float, float]]:
    """Rectangle with the radii of gyration of a section."""
    y, z = (float(np.sqrt(3)) * radius for radius in section.gyration)
    return [(-y, -z), (y, -z), (y, z), (-y, z)]


def _stresses(groups: Sequence[BeamElements]) -> tuple[BeamStress, ...]:
    """One operator for the elements of a group with equally many fibres."""
    operators = []
    for group in groups:
        # where both ends have other numbers of fibres there are no stresses
        fibres = [[one.fibres if len(ends[0].fibres) == len(ends[1].fibres) else () for one in ends]
                  for ends in group.sections]
        counts = np.array([len(first) for first, _ in fibres])
        for count in np.unique(counts):
            these = np.flatnonzero(counts == count)
            stress = [[[fibre.stress for fibre in end] for end in fibres[k]] for k in these]
            offsets = [[[(fibre.y, fibre.z) for fibre in end] for end in fibres[k]] for k in these]
            flexible = [[end.flexibility for end in group.sections[k]] for k in these]
            shape = len(these), 2, count
            operators.append(BeamStress(
                group.pairs[these], group.end_forces[these],
                np.array(stress, dtype=float).reshape(*shape, 3, 6),
                np.array(offsets, dtype=float).reshape(*shape, 2), np.array(flexible)))
    return tuple(operators)


def _mass_field(groups: Sequence[BeamElements], size: int) -> MassField:
    """The points of the elements' integration, with displacement and rotation in model axes."""
    def joined(name: str) -> NDArray:
        parts = [getattr(group, name) for group in groups]
        return np.concatenate([one.reshape(-1, *one.shape[2:]) for one in parts])

    def rows(name: str) -> sparse.csr_array:
        return sparse.csr_array(sparse.vstack([_rows(getattr(group, name), group.dofs, size)
                                               for group in groups]))
    return MassField(joined("points"), rows("translation"),
                     sparse.csr_array(sparse.diags_array(joined("masses"))), rows("rotation"),
                     joined("inertia"))


def _rows(fields: NDArray, dofs: NDArray, size: int) -> sparse.csr_array:
    """Rows (n, g, c, k) of the elements' DOFs as rows of all DOFs, (n g c, size)."""
    rows = fields[0, :, :, 0].size * len(fields)
    columns = np.broadcast_to(dofs[:, None, None, :], fields.shape)
    pointers = np.arange(rows + 1) * fields.shape[-1]
    return sparse.csr_array((fields.ravel(), columns.ravel(), pointers), shape=(rows, size))


class BeamPrestress:
    """Geometric stiffness of beam elements under the resultants of a displacement.

    With the strains of Simo and Reissner (J.C. Simo, Comput. Methods Appl. Mech. Engrg 49, 1985),
    ``Gamma = exp(-psi) (t + u') - t`` and ``kappa = T(psi) psi'``, to second order in
    displacement u and rotation vector psi, forces F and moments M of the prestress have the energy

        (7) V3 = integral F . (psi x (psi x t) / 2 - psi x u') - M . (psi x psi') / 2,

    in any axes that do not turn along the element, with the tangent t. That the beam is curved or
    twisted from the beginning changes nothing: of ``R = E R_0``, R_0 the axes at the start, it is
    ``R^T R' - R_0^T R_0' = R_0^T (E^T E') R_0``. Its second derivative, with the interpolation of
    the elements, is exact: displacements of second order between the nodes do no work to third
    order.
    """

    def __init__(self, groups: Sequence[BeamElements], size: int):
        self._groups, self._size = groups, size

    def __call__(self, displacement: NDArray) -> sparse.csc_array:
        """Geometric stiffness (n_dofs, n_dofs) of the displacement (n_dofs,) of a prestress."""
        return sum(self._of_group(group, displacement) for group in self._groups)

    def _of_group(self, group: BeamElements, displacement: NDArray) -> sparse.csc_array:
        dofs = group.dofs
        forces = np.einsum("egij,ej->egi", group.forces, displacement[dofs])
        energy = group.weights[:, :, None, None] * _second_derivative(
            forces[..., :3], forces[..., 3:], group.tangents)
        flat = (len(energy), -1, group.fields.shape[-1])
        weighed = (energy @ group.fields).reshape(flat)
        matrices = group.fields.reshape(flat).transpose(0, 2, 1) @ weighed
        return assemble(dofs, (matrices + matrices.transpose(0, 2, 1)) / 2, self._size)


def _second_derivative(force: NDArray, moment: NDArray, tangent: NDArray) -> NDArray:
    """Second derivative (..., 9, 9) of the density of V3 with respect to (psi, u', psi')."""
    result = np.zeros((*force.shape[:-1], 9, 9))
    psi, stretch, bend = slice(0, 3), slice(3, 6), slice(6, 9)
    mixed = force[..., :, None] * tangent[..., None, :]
    axial = np.einsum("...i,...i->...", force, tangent)[..., None, None]
    result[..., psi, psi] = (mixed + np.swapaxes(mixed, -1, -2)) / 2 - axial * np.eye(3)
    for columns, cross in ((stretch, skew(force)), (bend, skew(moment) / 2)):
        result[..., psi, columns] = cross
        result[..., columns, psi] = np.swapaxes(cross, -1, -2)
    return result
