"""Loads on FE nodes: reduced with the body, and residual modes that carry what they lack."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.linalg import eigh

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.reduction.clamped import ClampedInterior, canonical_turn
from sebody.reduction.component import ComponentModes

_KNOWN = 1e-12      # strain energy left of a load's answer, relative to all of it, that is rounding


def fe_loads(loads: Mapping[str, ArrayLike] | None, size: int) -> tuple[list[str], NDArray]:
    """Names of loads on an FE model, and their vectors as columns (n_dofs, k).

    Raises
    ------
    InputError
        Names that are no texts, or vectors of another length or with entries that are not finite.
    """
    checked = named_vectors({} if loads is None else loads, size, "FE DOFs")
    return list(checked), np.column_stack([*checked.values(), np.zeros((size, 0))])


def named_vectors(loads: Mapping[str, ArrayLike], size: int, entries: str) -> dict[str, NDArray]:
    """Loads by name, as new arrays.

    Raises
    ------
    InputError
        The same as of `fe_loads`.
    """
    inputs.instance(loads, "loads", Mapping, "give a dict of vectors by name")
    vectors = {}
    for name, value in loads.items():
        inputs.name(name, "name of a load")
        vector = inputs.reals(value, f"load {name!r}", f"give {size} numbers")
        if vector.shape != (size,):
            raise InputError(f"load {name!r} has shape {vector.shape}; the {entries} need "
                             f"({size},)")
        if not np.isfinite(vector).all():
            row = int(np.argmin(np.isfinite(vector)))
            raise InputError(f"load {name!r}[{row}] is {vector[row]}: give finite numbers")
        vectors[name] = np.array(vector)
    return vectors


def named_outputs(outputs: Mapping[str, ArrayLike], size: int) -> dict[str, NDArray]:
    """Output matrices (m, size) by name, as new arrays.

    Raises
    ------
    InputError
        Names that are no texts, or matrices with another number of columns or with entries that
        are not finite.
    """
    inputs.instance(outputs, "outputs", Mapping, "give a dict of matrices by name")
    return {inputs.name(name, "name of an output"): np.array(inputs.array(
        matrix, f"output {name!r}", (None, size))) for name, matrix in outputs.items()}


def with_residual_modes(component: ComponentModes, interior: ClampedInterior,
                        mass: sparse.csc_array, forces: NDArray) -> ComponentModes:
    """The modes with those that make the static responses to forces (n, k) exact.

    A residual mode is the answer of the clamped body without its part in the vibration modes: what
    is left is orthogonal to these in mass and stiffness (R.R. Craig, Structural Dynamics, 1981).
    Answers that the modes or other loads have already add none.

    Raises
    ------
    InputError
        A static response without mass.
    """
    shapes, squares = component.fixed_interface, component.omega_squared
    answers = interior.displacement(forces)
    left = answers - shapes @ ((shapes.T @ forces) / squares[:, None])
    energy, whole = left.T @ forces, np.einsum("ij,ij->j", answers, forces)
    new = np.diag(energy) > _KNOWN * whole
    if not new.any():
        return component
    unit = left[:, new] / np.sqrt(np.diag(energy)[new])
    gram = energy[np.ix_(new, new)] / np.sqrt(np.outer(np.diag(energy)[new], np.diag(energy)[new]))
    sizes, turn = np.linalg.eigh((gram + gram.T) / 2)
    kept = sizes > np.sqrt(_KNOWN) * sizes[-1]
    unit = unit @ (turn[:, kept] / np.sqrt(sizes[kept]))        # unit strain energy each
    inverse, turn = eigh(unit.T @ (mass @ unit))
    if inverse[0] <= 0:
        raise InputError("residual modes: the static response to a load has no mass, so it "
                         "has no frequency; give the DOFs under the load mass, or leave "
                         "residual_modes out")
    residual = (unit @ (turn / np.sqrt(inverse)))[:, ::-1]
    omega_squared = 1.0 / inverse[::-1]
    residual = residual @ canonical_turn(omega_squared, residual)
    # what vibration modes are off by is multiplied by the ratio of the squares of frequencies
    residual -= shapes @ (shapes.T @ (mass @ residual))
    return replace(component, fixed_interface=np.hstack([shapes, residual]),
                   omega_squared=np.concatenate([squares, omega_squared]))
