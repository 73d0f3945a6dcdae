"""Fields inside a superelement: what its FE nodes do in the recorded states."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.stress import principal, von_mises
from sebody.results.envelopes import Envelope, envelope
from sebody.results.field_point import FieldPoint
from sebody.results.field_states import FieldStates


class Field(FieldStates):
    """Displacements, velocities, accelerations and stresses of the FE nodes of a superelement.

    A field is computed for the state asked for, a history for the node asked for: see `at`.
    States are chosen by their number among the recorded ones (negative: from the end) or by `t`,
    which takes the nearest recorded state; the last one by default.

    Vectors are those in space, by components along the global axes or, with ``axes="body"``,
    along the axes of the body's floating frame, displacements along those of the undeformed body
    that they are measured from, see `displacement`. Stresses are (xx, yy, zz, yz, zx, xy), those of
    solids along the axes of the FE model, those of beams along the axes of the section, of its
    most stressed fibre. They contain the static response of the omitted modes to the inertia of the
    body; without it, ``static=False``, stresses near the boundary converge slowly with the modes.

    Parameters
    ----------
    recording : Recording
        A Result, as a rule.
    name : str
        Of the superelement.

    Raises
    ------
    InputError
        No such superelement, or one without the shapes of an FE model.
    """

    def __repr__(self) -> str:
        return f"<Field of {self.name!r}: {self.count} FE nodes, {len(self.t)} states>"

    def position(self, step: int | None = None, t: float | None = None,
                 axes: str = "global") -> NDArray:
        """Places of all FE nodes, (nodes, D); in body axes from the origin of the frame."""
        return self.places(self._state(step, t), None, axes)[0]

    def displacement(self, step: int | None = None, t: float | None = None,
                     axes: str = "global", reference: str | None = None) -> NDArray:
        """Displacements of all FE nodes from the undeformed body.

        The undeformed body moves with the `reference`: a node of this body or of one that is
        welded to it, by its name, or ``"frame"``, the floating frame. By default it is the first
        node that is fixed with its rotation, else the chord between two whose positions are
        supported, else the first one that is fixed, or has a joint, else the floating frame.

        Raises
        ------
        InputError
            A node of another body.
        """
        return self.displacements(self._state(step, t), None, axes, reference)[0]

    def velocity(self, step: int | None = None, t: float | None = None,
                 axes: str = "global") -> NDArray:
        """Velocities of all FE nodes, (nodes, D)."""
        return self.velocities(self._state(step, t), None, axes)[0]

    def acceleration(self, step: int | None = None, t: float | None = None,
                     axes: str = "global") -> NDArray:
        """Accelerations of all FE nodes, (nodes, D)."""
        return self.accelerations(self._state(step, t), None, axes)[0]

    def at(self, node: int, axes: str = "global", static: bool = True,
           reference: str | None = None) -> FieldPoint:
        """Histories of one FE node, by its number in the FE model; see `label`.

        Its displacement is measured from the `reference`, see `displacement`.

        Raises
        ------
        InputError
            No such node.
        """
        return FieldPoint(self, self.node(node), axes, static, reference)

    def stress(self, step: int | None = None, t: float | None = None, at: str = "nodes",
               static: bool = True) -> NDArray:
        """Stresses (nodes, 6): means of the elements around; NaN where no element is known.

        With ``at="points"`` those at the points of integration, of beams in all fibres of the
        sections at their ends, in the order of `stress_points`.

        Raises
        ------
        InputError
            A body whose FE model has no stress operator.
        """
        return self._stressed(step, t, at, static, "stress")

    def strain(self, step: int | None = None, t: float | None = None, at: str = "nodes",
               static: bool = True) -> NDArray:
        """Strains of solids likewise; shears are those of engineering, twice the tensor's."""
        return self._stressed(step, t, at, static, "strain")

    def von_mises(self, step: int | None = None, t: float | None = None, at: str = "nodes",
                  static: bool = True) -> NDArray:
        """Von Mises's stresses (nodes,)."""
        return von_mises(self._stressed(step, t, at, static, "stress"))

    def principal(self, step: int | None = None, t: float | None = None, at: str = "nodes",
                  static: bool = True) -> NDArray:
        """Principal stresses, ascending, (nodes, 3)."""
        return principal(self._stressed(step, t, at, static, "stress"))

    def section_forces(self, step: int | None = None, t: float | None = None,
                       static: bool = True) -> NDArray:
        """Section forces of beams at both ends of the elements, (elements, 2, 6).

        (N, Qy, Qz, Mx, My, Mz) in axes of the section, on the part whose outward normal is the
        beam's axis x: tension is positive.
        """
        return self.stresses(static).of_sections(self._state(step, t))[0]

    def section_strains(self, step: int | None = None, t: float | None = None,
                        static: bool = True) -> NDArray:
        """Strains of the sections of beams at both ends of the elements, (elements, 2, 6).

        Extension, shear along y and z, rates of twist and of bending about y and z [1, 1/length].
        """
        return self.stresses(static).of_sections(self._state(step, t), "section_strains")[0]

    def envelope(self, quantity: str = "von_mises", static: bool = True,
                 reference: str | None = None) -> Envelope:
        """Largest values over time at every node, with their states.

        Parameters
        ----------
        quantity : str
            von_mises, largest_principal or smallest_principal; displacement, velocity or
            acceleration, of which it is the length.
        reference : str, optional
            Where displacements are measured from, see `displacement`.

        Raises
        ------
        InputError
            Another quantity, or a body whose FE model has no stress operator.
        """
        return envelope(self, quantity, static, reference)

    @property
    def fe_places(self) -> NDArray:
        """Undeformed FE nodes in axes of the FE model, (nodes, D)."""
        return self._recovery.coordinates

    def called(self, place: int) -> int:
        """The label of a node in the FE program, else its number in the FE model."""
        return self._recovery.called(place)

    @property
    def stress_points(self) -> NDArray:
        """Places of stresses in the undeformed body, in axes of the frame, (points, D)."""
        places, axes = self.stresses().places(), self._recovery.axes
        places = places if axes is None else places @ axes.T
        return places + (self.points[0] - self._recovery.points[0])

    def state(self, step: int | None = None, t: float | None = None) -> int:
        """Number of a recorded state, from 0.

        Raises
        ------
        InputError
            No such state, or both `step` and `t`.
        """
        times, last = self.t, len(self.t) - 1
        if step is not None and t is not None:
            raise InputError("step and t both choose a state: give one of them")
        if t is not None:
            t = inputs.number(t, "t", least=times[0], most=times[-1])
            return int(np.argmin(np.abs(times - t)))
        if step is None:
            return last
        step = inputs.integer(step, "step", least=-last - 1, most=last,
                              remedy=f"the recorded states are 0 to {last}")
        return step % (last + 1)

    def node(self, node: int) -> int:
        """Place of an FE node in fields, by its number in the FE model, from 0.

        Raises
        ------
        InputError
            No such node, or one that is not among those whose data was kept.
        """
        nodes = self._recovery.nodes
        if nodes is None:
            return inputs.integer(node, f"node of body {self.name!r}", least=0,
                                  most=self.count - 1,
                                  remedy=f"its FE model has nodes 0 to {self.count - 1}" + (
                                      "" if self._recovery.labels is None else
                                      "; field.label(label) is the number of a label"))
        node = inputs.integer(node, f"node of body {self.name!r}", least=0)
        place = int(np.searchsorted(nodes, node))
        if place == len(nodes) or nodes[place] != node:
            raise InputError(f"node {node} of body {self.name!r} is not among the {len(nodes)} "
                             "nodes whose recovery data was kept: reduce the FE model with "
                             "recover= that names it")
        return place

    def label(self, label: int) -> int:
        """Number in the FE model of the node with a label of the FE program.

        Raises
        ------
        InputError
            No labels, or no such label.
        """
        labels = self._recovery.labels
        if labels is None:
            raise InputError(f"the nodes of body {self.name!r} have no labels: give their numbers")
        label = inputs.integer(label, "label of a node")
        numbers = np.flatnonzero(labels == label)
        if not len(numbers):
            raise InputError(f"body {self.name!r} has no node with the label {label}: there are "
                             f"{labels.min()} to {labels.max()}")
        return self.number(int(numbers[0]))

    def _state(self, step: int | None, t: float | None) -> NDArray:
        return np.array([self.state(step, t)])

    def _stressed(self, step: int | None, t: float | None, at: str, static: bool,
                  what: str) -> NDArray:
        stresses, state = self.stresses(static), self._state(step, t)
        if inputs.choice(at, "at", ("nodes", "points")) == "points":
            return stresses.at_points(state, what)[0]
        return stresses.at_nodes(state, what)[0]
