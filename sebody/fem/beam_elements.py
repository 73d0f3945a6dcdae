"""Ingredients of matrices, mass field, geometric stiffness and stresses of beam elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.fem.general_section import GeneralSection
from sebody.fem.section import StiffnessSection

AtEnds = tuple[StiffnessSection | GeneralSection, StiffnessSection | GeneralSection]
IN_PLANE = np.array([0, 1, 5, 6, 7, 11])  # DOFs of an element in the xy plane


@dataclass(frozen=True, eq=False)
class BeamElements:
    """Some elements with equally many points of integration, g; k DOFs each, in axes of the model.

    Parameters
    ----------
    pairs : (n, 2)
        Nodes at both ends.
    stiffness, mass, damping : (n, k, k)
    points : (n, g, D)
        Centres of mass of the sections.
    masses : (n, g)
    inertia : (n, g, A, A)
        Rotary inertia about them; one axis, A = 1, in a plane.
    translation, rotation : (n, g, D, k), (n, g, A, k)
        Displacement and rotation of the centres of mass of unit DOFs.
    weights : (n, g)
        Of the integration [length].
    fields : (n, g, 9, k)
        Rotation vector, and derivatives by length of displacement and rotation.
    tangents : (n, g, 3)
        In the axes of the fields.
    forces : (n, g, 6, k)
        Section forces of unit DOFs, in the axes of the fields.
    end_forces : (n, 2, 6, k)
        Section forces of unit DOFs, in the axes of the sections at both ends.
    sections : n pairs
        At both ends.
    """

    pairs: NDArray
    stiffness: NDArray
    mass: NDArray
    damping: NDArray
    points: NDArray
    masses: NDArray
    inertia: NDArray
    translation: NDArray
    rotation: NDArray
    weights: NDArray
    fields: NDArray
    tangents: NDArray
    forces: NDArray
    end_forces: NDArray
    sections: list[AtEnds]

    @property
    def dofs(self) -> NDArray:
        """Rows of the elements' DOFs, (n, k)."""
        width = self.stiffness.shape[1] // 2
        return (width * self.pairs[:, :, None] + np.arange(width)).reshape(len(self.pairs), -1)


def symmetric(matrices: NDArray) -> NDArray:
    """Symmetric part of matrices (..., k, k)."""
    return (matrices + np.swapaxes(matrices, -1, -2)) / 2
