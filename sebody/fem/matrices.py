"""Matrices of FE models: assembled from elements, and checks of what is given."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError

SYMMETRY_LIMIT = 1e-8   # difference of entries across the diagonal, relative to its own entries


def fe_matrix(value: object, name: str) -> sparse.csc_array:
    """A matrix of an FE model as CSC.

    Parameters
    ----------
    value : (n, n), dense or sparse
    name : str
        Of the matrix, for the message.

    Raises
    ------
    InputError
        Entries that are no finite real numbers, or a matrix that is not symmetric.
    """
    remedy = "give a square matrix of real numbers, dense or of scipy.sparse"
    if sparse.issparse(value):
        if value.dtype.kind not in "iuf" or value.ndim != 2:
            raise InputError(f"{name} has numbers of type {value.dtype} and the shape "
                             f"{value.shape}: {remedy}")
        matrix = sparse.csc_array(value, dtype=float, copy=True)
    else:
        dense = inputs.reals(value, name, remedy)
        if dense.ndim != 2:
            raise InputError(f"{name} has shape {dense.shape}: {remedy}")
        matrix = sparse.csc_array(dense)
    matrix.sum_duplicates()     # and sorts, which solvers would do to the data alone
    if not np.isfinite(matrix.data).all():
        entries = matrix.tocoo()
        k = int(np.argmin(np.isfinite(entries.data)))
        raise InputError(f"{name}[{entries.row[k]}, {entries.col[k]}] is {entries.data[k]}: the "
                         "matrix must be finite, export it again")
    if matrix.shape[0] == matrix.shape[1]:
        _check_symmetry(matrix, name)
    return matrix


def _check_symmetry(matrix: sparse.csc_array, name: str) -> None:
    """Refuse entries that differ across the diagonal."""
    unlike = unsymmetric_entry(matrix)
    if unlike is not None:
        i, j = unlike
        raise InputError(f"{name} is not symmetric: {name}[{i}, {j}] = {matrix[i, j]:.6g} but "
                         f"{name}[{j}, {i}] = {matrix[j, i]:.6g}: export both triangles or mirror "
                         "one")


def unsymmetric_entry(matrix: sparse.csc_array) -> tuple[int, int] | None:
    """Row and column of the entry that differs most from that across the diagonal.

    Differences are relative to the diagonal entries of both rows; None where all are rounding.
    """
    defect = sparse.coo_array(matrix - matrix.T)
    if not defect.nnz:
        return None
    diagonal = np.sqrt(np.abs(matrix.diagonal()))
    allowed = SYMMETRY_LIMIT * diagonal[defect.row] * diagonal[defect.col]
    k = int(np.argmax(np.abs(defect.data) - allowed))
    over = abs(defect.data[k]) > allowed[k]
    return (int(defect.row[k]), int(defect.col[k])) if over else None


def assemble(element_dofs: NDArray, element_matrices: NDArray, size: int) -> sparse.csc_array:
    """Sum element matrices (n_elements, k, k) at rows `element_dofs` (n_elements, k)."""
    width = element_dofs.shape[1]
    rows = np.repeat(element_dofs, width, axis=1).ravel()
    columns = np.tile(element_dofs, (1, width)).ravel()
    entries = (element_matrices.ravel(), (rows, columns))
    return sparse.csc_array(sparse.coo_array(entries, shape=(size, size)))
