"""Shapes of small motion by the names of nodes and bodies, in global axes."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.results.naming import component_of
from sebody.results.result import Result
from sebody.runs.rotating_frame import motion
from sebody.runs.simulation import Simulation


class Shapes:
    """Motion of nodes by that of the unknowns, in the state of a run when it is made."""

    def __init__(self, run: Simulation | Result):
        self._model, self._numbering = run.model, run.numbering
        self._motion = motion(run)
        self._R = run.state.R.copy()

    def of(self, name: str, shapes: NDArray) -> NDArray:
        """Part of some shapes, (size, m): displacements, small rotations or amplitudes of modes.

        Parameters
        ----------
        name : str
            ``<node>.position``, ``<node>.rotation`` (a vector about global axes) or
            ``<superelement>.modes``, and components of them, ``tip.position.y``.
        shapes : (unknowns, m)

        Raises
        ------
        InputError
            A name that nothing has.
        """
        rows = self._whole(str(name), shapes)
        whole, _, component = str(name).rpartition(".")
        if rows is None and (rows := self._whole(whole, shapes)) is not None:
            return component_of(whole, rows.T, component)
        if rows is None:
            raise InputError(f"{name!r} has no shape: there are <node>.position and "
                             f"<node>.rotation of {', '.join(self._model.nodes)}, and "
                             "<superelement>.modes")
        return rows

    def _whole(self, name: str, shapes: NDArray) -> NDArray | None:
        """Part of some shapes, without components; None of an unknown name."""
        owner, _, quantity = name.rpartition(".")
        model, numbering = self._model, self._numbering
        if quantity == "modes" and owner in model.bodies:
            first = numbering.modes[owner]
            return shapes[first:first + model.bodies[owner].reduced.modes]
        dof_block = (getattr(model.nodes.get(owner), quantity, None)
                   if quantity in ("position", "rotation") else None)
        if dof_block is None or dof_block not in numbering.dof_blocks:
            return None
        first = numbering.dof_blocks[dof_block]
        rows = self._motion[first:first + dof_block.start.size] @ shapes
        if dof_block.rotational and not model.planar:
            k = numbering.rotations[dof_block]
            rows = self._R[9 * k:9 * k + 9].reshape(3, 3) @ rows
        return np.asarray(rows)
