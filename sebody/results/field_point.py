"""Histories of one FE node of a superelement."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.fem.stress import principal, von_mises
from sebody.results.field_states import AXES, FieldStates
from sebody.results.stresses import Stresses


class FieldPoint:
    """Histories of one FE node of a superelement, (n, D): a row of the field for each state."""

    def __init__(self, field: FieldStates, node: int, axes: str, static: bool,
                 reference: str | None = None):
        self._field, self._nodes = field, np.array([node])
        self._static = inputs.flag(static, "static")
        self._reference = reference
        self._axes = inputs.choice(axes, "axes", AXES)
        self._states = np.arange(len(field.t))

    def __repr__(self) -> str:
        number = self._field.number(int(self._nodes[0]))
        return f"<FE node {number} of {self._field.name!r}: {len(self._states)} states>"

    @property
    def position(self) -> NDArray:
        """Place; in body axes from the origin of the frame."""
        return self._field.places(self._states, self._nodes, self._axes)[:, 0]

    @property
    def displacement(self) -> NDArray:
        """Displacement from the undeformed body, which moves with the reference."""
        return self._field.displacements(self._states, self._nodes, self._axes,
                                         self._reference)[:, 0]

    @property
    def rotation(self) -> NDArray:
        """Rotation vector in the frame, (n, 3), in a plane (n, 1); (n, 0) if nodes have none."""
        return self._field.rotations(self._states, self._nodes)[:, 0]

    @property
    def velocity(self) -> NDArray:
        """Velocity."""
        return self._field.velocities(self._states, self._nodes, self._axes)[:, 0]

    @property
    def acceleration(self) -> NDArray:
        """Acceleration."""
        return self._field.accelerations(self._states, self._nodes, self._axes)[:, 0]

    @property
    def stress(self) -> NDArray:
        """Stress (n, 6); see `Field`."""
        return self._stresses.of_node(self._nodes[0])

    @property
    def strain(self) -> NDArray:
        """Strain (n, 6) of solids."""
        return self._stresses.of_node(self._nodes[0], "strain")

    @property
    def von_mises(self) -> NDArray:
        """Von Mises's stress (n,)."""
        return von_mises(self.stress)

    @property
    def principal(self) -> NDArray:
        """Principal stresses, ascending, (n, 3)."""
        return principal(self.stress)

    @property
    def fibre_stress(self) -> NDArray:
        """Stresses in all fibres of the beam sections at the node, (n, fibres, 6)."""
        return self._stresses.fibres_of_node(self._nodes[0])

    @property
    def fibres_by_section_forces(self) -> NDArray | None:
        """`fibre_stress` of unit `section_forces`, (fibres, 6, ends * 6); None of solids."""
        return self._stresses.fibres_by_section_forces(self._nodes[0])

    @property
    def section_forces(self) -> NDArray:
        """Section forces of the ends of beam elements at the node, (n, ends, 6)."""
        return self._stresses.sections_of_node(self._nodes[0])

    @property
    def section_strains(self) -> NDArray:
        """Strains of the sections at the ends of beam elements at the node, (n, ends, 6)."""
        return self._stresses.sections_of_node(self._nodes[0], "section_strains")

    @property
    def _stresses(self) -> Stresses:
        return self._field.stresses(self._static)
