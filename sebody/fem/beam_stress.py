"""Section forces of beam elements, and the stresses they cause in fibres of the sections."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError


@dataclass(frozen=True, eq=False)
class BeamStress:
    """Forces on the sections at both ends of beam elements, and stresses there.

    A force and a moment (N, Qy, Qz, Mx, My, Mz) act on the section whose normal is the beam's axis
    x; tension is positive. They are in balance with the nodal forces: inside an element that bears
    loads of its own the moment differs by a term of second order in its length.

    Parameters
    ----------
    nodes : (n, 2) of int
        Nodes at the ends of the elements.
    forces : (n, 2, 6, 2 k)
        Section forces at the ends of unit displacements of the k DOFs of both nodes.
    fibres : (n, 2, p, 3, 6)
        Stresses (xx, xy, zx) in p fibres of the sections at both ends of unit section forces.
    offsets : (n, 2, p, 2)
        Place y, z of the fibres in the sections [length].
    flexibility : (n, 2, 6, 6), optional
        Strains of the sections at both ends of unit section forces: extension, shear along y and
        z, rates of twist and of bending about y and z.
    """

    nodes: NDArray
    forces: NDArray
    fibres: NDArray
    offsets: NDArray
    flexibility: NDArray | None = None

    def section_forces(self, moved: NDArray, elements: NDArray | slice = slice(None)) -> NDArray:
        """Section forces of some elements.

        Parameters
        ----------
        moved : (n_nodes, k, s)
            DOFs of all nodes in s states.

        Returns
        -------
        (elements, 2, 6, s)
        """
        own = moved[self.nodes[elements]]
        n, _, _, s = own.shape
        return self.forces[elements] @ own.reshape(n, 1, -1, s)

    def section_strains(self, moved: NDArray, elements: NDArray | slice = slice(None)) -> NDArray:
        """Strains of the sections at both ends, (elements, 2, 6, s).

        Raises
        ------
        InputError
            Elements of an older body file, which does not say how flexible the sections are.
        """
        if self.flexibility is None:
            raise InputError("section strains are unknown: the body file was written before they "
                             "were kept, make it again")
        return self.flexibility[elements] @ self.section_forces(moved, elements)

    def stress(self, moved: NDArray, elements: NDArray | slice = slice(None)) -> NDArray:
        """Stresses in the fibres of both ends, in axes of the section, (elements, 2, p, 6, s)."""
        forces = self.section_forces(moved, elements)
        stresses = np.einsum("eapcf,eafs->eapcs", self.fibres[elements], forces)
        whole = np.zeros((*stresses.shape[:3], 6, stresses.shape[4]))
        whole[:, :, :, [0, 5, 4]] = stresses
        return whole

    def restricted(self, place: NDArray, coordinates: NDArray) -> "BeamStress":
        """Restrict to elements whose nodes are kept: `place` has new numbers, -1 for others."""
        inside = np.all(place[self.nodes] >= 0, axis=1)
        return replace(self, nodes=place[self.nodes[inside]], forces=self.forces[inside],
                       fibres=self.fibres[inside], offsets=self.offsets[inside],
                       flexibility=None if self.flexibility is None else
                       self.flexibility[inside])
