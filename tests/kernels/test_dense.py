"""Products with reduced matrices against NumPy's."""

import numpy as np
import pytest

from sebody.kernels.abi import pointer_to
from sebody.kernels.dense import arrow_times
from sebody.kernels.layout import LANES, padded_columns, whole_vectors
from sebody.kernels.pipeline import compiled

EPS = np.finfo(float).eps


@compiled
def product(A, x, out, n, filled):
    arrow_times(pointer_to(A), pointer_to(x), pointer_to(out), n, filled)


@pytest.mark.parametrize("n, filled", [(1, 1), (7, 7), (7, 4), (16, 12), (13, 12), (76, 12),
                                       (77, 12), (112, 48), (30, 0)])
def test_arrow_times_a_vector(n, filled):
    """Full rows and columns first, then a diagonal; sizes that are no whole vectors, too."""
    random = np.random.default_rng(n)
    A = random.normal(size=(n, n))
    A[filled:, filled:] = np.diag(random.normal(size=n - filled))
    x, out = random.normal(size=n), np.full(whole_vectors(n) + LANES, 7.0)
    product(padded_columns(A), x, out, n, filled)
    # sums of up to n products
    assert np.abs(out[:n] - A @ x).max() < n * EPS * (np.abs(A) @ np.abs(x)).max()
    assert np.all(out[whole_vectors(n):] == 7.0)        # nothing is written behind the padding


def test_what_is_not_an_arrow_is_seen():
    """The product of a full matrix as if it were an arrow differs: the test above can fail."""
    A, x, out = np.ones((16, 16)), np.ones(16), np.zeros(16)
    product(padded_columns(A), x, out, 16, 12)
    assert np.all(out[12:] == 13.0)
