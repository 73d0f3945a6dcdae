"""Matrix Market as others write it: layouts, symmetry, remarks, Fortran's exponents."""

import io

import numpy as np
import pytest
from scipy import sparse
from scipy.io import mmwrite

from sebody.io.matrix_market import parsed

A = np.array([[4.0, -1.0, 0.5], [-1.0, 3.0, 0.25], [0.5, 0.25, 2.0]])
B = np.arange(9.0).reshape(3, 3)


@pytest.mark.parametrize("matrix, symmetry", [(A, "symmetric"), (A, "general"), (B, "general")])
@pytest.mark.parametrize("kind", [np.asarray, sparse.coo_matrix])
def test_what_scipy_writes(matrix, symmetry, kind):
    """Full matrices are written by columns, of symmetric ones the lower triangle."""
    stream = io.BytesIO()
    mmwrite(stream, kind(matrix), symmetry=symmetry, comment="a remark", precision=17)
    np.testing.assert_array_equal(parsed(stream.getvalue().decode()).matrix().toarray(), matrix)


def test_other_ways_to_write_numbers():
    text = ("%%MatrixMarket MATRIX Coordinate REAL General\n% remark\n%\n\n  2 3 3\n"
            "1 1 1.5D+01\n2 3 -2.5d-1 1 2 7\n")
    np.testing.assert_array_equal(parsed(text).matrix().toarray(), [[15, 7, 0], [0, 0, -0.25]])
    text = "%%MatrixMarket matrix coordinate integer symmetric\n2 2 2\n2 1 3\n2 2 5\n"
    np.testing.assert_array_equal(parsed(text).matrix().toarray(), [[0, 3], [3, 5]])


def test_both_triangles_of_what_is_called_symmetric():
    """Entries are taken once, and refused where they contradict one another or come twice."""
    head = "%%MatrixMarket matrix coordinate real symmetric\n2 2 4\n"
    text = head + "1 1 4\n2 1 3\n1 2 3\n2 2 5\n"
    np.testing.assert_array_equal(parsed(text).matrix().toarray(), [[4, 3], [3, 5]])
    with pytest.raises(ValueError, match=r"entry 3, \(1, 2\), is [37] here and [37] across the"):
        parsed(text.replace("1 2 3", "1 2 7")).matrix()
    with pytest.raises(ValueError, match=r"entry 3, \(2, 1\), occurs twice"):
        parsed(text.replace("1 2 3", "2 1 3")).matrix()
    with pytest.raises(ValueError, match=r"entry 3, \(2, 1\), occurs twice"):
        parsed(text.replace("1 2 3", "2 1 3").replace("symmetric", "general")).matrix()
