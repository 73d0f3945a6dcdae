"""Participation factors and effective masses of vibrations by direction.

Supports that move by a unit along a direction e carry all coordinates by r. A vibration of shape s
and unit mass has the participation factor ``L = s^T M r`` and the effective mass ``L^2``. Those of
all vibrations sum to the mass, less what the supports carry rigidly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import coordinates
from sebody.basics import tabular
from sebody.model.model import Model
from sebody.results.naming import AXES
from sebody.results.result import Result
from sebody.runs.rotating_frame import motion
from sebody.runs.simulation import Simulation
from sebody.runs.state_derivatives import weighted
from sebody.small_motion.given_state import state_of
from sebody.small_motion.linearization import vibrations


class EffectiveMasses(NamedTuple):
    """Participation of vibrations in motion of the supports; see `effective_masses`."""

    omega: NDArray      # (m,) angular frequencies, ascending [1/time]
    factors: NDArray    # (m, d) participation factors along x, y and z [mass^(1/2)]
    masses: NDArray     # (m, d) effective masses [mass]
    total: NDArray      # (d,) mass of the model, supports included [mass]

    def __repr__(self) -> str:
        return tabular.text(*self._table())

    def _repr_html_(self) -> str:
        """Tables that notebooks show."""
        return tabular.titled(*self._table())

    def _table(self) -> tuple[str, tuple[str, ...], list[tuple[str, ...]]]:
        names = AXES[:self.masses.shape[1]]
        heads = "mode", "frequency [Hz]", *(f"effective mass {name}" for name in names)
        rows = [(str(k + 1), f"{omega / (2 * np.pi):.6g}", *(f"{one:.6g}" for one in masses))
                for k, (omega, masses) in enumerate(zip(self.omega, self.masses, strict=True))]
        share = self.masses.sum(axis=0) / np.maximum(self.total, 1e-300)
        rows.append(("all", "", *(f"{100 * one:.4g} % of the mass" for one in share)))
        return f"{len(self.omega)} vibrations and the mass they move", heads, rows


def effective_masses(run: Simulation | Result | Model, count: int | None = None) -> EffectiveMasses:
    """Participation factors and effective masses of vibrations, along the axes of space.

    Parameters
    ----------
    run : Simulation, Result or Model
        At rest, as for `vibrations`.
    count : int, optional
        Lowest vibrations to tell; all by default.

    Raises
    ------
    InputError
        As `vibrations`.
    """
    run = state_of(run)
    found = vibrations(run, count)
    d, numbering = run.model.dimension, run.numbering
    carried = np.zeros((numbering.total, d))
    nodes = (*run.model.nodes.values(), *run.model.grounds)
    for dof_block in dict.fromkeys(node.position for node in nodes):
        if dof_block is not None and dof_block in numbering.dof_blocks:
            carried[coordinates(numbering, dof_block)] = np.eye(d)
    momentum = weighted(run, 1.0, 0.0, 0.0) @ carried
    factors = found.shapes.T @ (motion(run).T @ momentum)
    return EffectiveMasses(found.omega, factors, factors**2, np.sum(carried * momentum, axis=0))
